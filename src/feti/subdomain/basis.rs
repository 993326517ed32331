//! A change of basis on Γ that makes functionals of the dual dofs coordinates.
//!
//! A functional c is orthogonalised against earlier ones and normalised. It is then the image of a unit vector e_p
//! under a Householder reflection, up to sign. The product H = H_1 H_2 … of the reflections is orthogonal. Entry p_k of
//! û = Hᵀ u is functional k of u; the other entries are coordinates of the orthogonal complement. In Hᵀ S H the
//! functionals are rows and columns that can be made primal like vertices. T and Ψ go back to the nodal dofs by the
//! same H. For the average over n dofs, H e_1 = 1/√n · (1, …, 1).

use std::collections::HashMap;

use base::linalg::dense::Dense;

/// A functional is dependent on earlier ones if less than this part of it is left after orthogonalisation. That part is
/// rounding.
const DEPENDENT: f64 = 1e-12;

/// A reflection I − β v vᵀ on some positions, and the functional that it makes a coordinate.
#[derive(Debug, Clone, PartialEq)]
struct Reflection {
    /// Positions in Γ.
    at: Vec<usize>,
    v: Vec<f64>,
    beta: f64,
    /// The position that becomes the functional.
    pivot: usize,
    /// The coordinate divided by the value of the functional. Averages and weighted averages have values of the size of
    /// u.
    factor: f64,
}

impl Reflection {
    fn apply(&self, u: &mut [f64]) {
        let terms = self.at.iter().zip(&self.v);
        let along = self.beta * terms.clone().map(|(&i, v)| v * u[i]).sum::<f64>();
        terms.for_each(|(&i, v)| u[i] -= along * v);
    }

    /// A ← A (I − β v vᵀ); `along` has the length of A's columns.
    fn apply_right(&self, a: &mut Dense, along: &mut [f64]) {
        along.fill(0.0);
        for (&i, v) in self.at.iter().zip(&self.v) {
            let terms = along.iter_mut().zip(a.col(i));
            terms.for_each(|(w, x)| *w += self.beta * v * x);
        }
        for (&i, v) in self.at.iter().zip(&self.v) {
            let terms = a.col_mut(i).iter_mut().zip(&*along);
            terms.for_each(|(x, w)| *x -= v * w);
        }
    }
}

/// The primal functionals of one subdomain.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Basis {
    reflections: Vec<Reflection>,
}

impl Basis {
    /// Adds the average over the dofs at these positions. No other functional may contain any of them.
    pub fn push_mean(&mut self, at: Vec<usize>) {
        let root = (at.len() as f64).sqrt();
        let mut v = vec![-1.0 / root; at.len()];
        v[0] += 1.0;
        self.reflections.push(Reflection {
            beta: if at.len() == 1 { 0.0 } else { 1.0 / v[0] },
            pivot: at[0],
            factor: root,
            v,
            at,
        });
    }

    /// Adds Σ weights · u over the dofs at these positions. An earlier functional must have all of its dofs among them,
    /// or none. Returns `false` if the new functional depends on earlier ones.
    pub fn push(&mut self, at: Vec<usize>, weights: &[f64]) -> bool {
        let norm = |c: &[f64]| c.iter().map(|v| v * v).sum::<f64>().sqrt();
        let place: HashMap<usize, usize> = at.iter().copied().zip(0..).collect();
        let mut c = weights.to_vec();
        let mut used = vec![false; at.len()];
        for r in self
            .reflections
            .iter()
            .filter(|r| place.contains_key(&r.pivot))
        {
            let terms = r.at.iter().zip(&r.v).map(|(i, v)| (place[i], v));
            let along = r.beta * terms.clone().map(|(i, v)| v * c[i]).sum::<f64>();
            terms.for_each(|(i, v)| c[i] -= along * v);
            used[place[&r.pivot]] = true;
        }
        let all = norm(&c);
        used.iter()
            .zip(&mut c)
            .filter(|(u, _)| **u)
            .for_each(|(_, c)| *c = 0.0);
        let left = norm(&c);
        if left <= DEPENDENT * all || left.is_nan() {
            return false;
        }
        c.iter_mut().for_each(|c| *c /= left);
        // The largest entry is the pivot: where stiff and soft dofs meet, the soft ones keep their own small rows in Hᵀ
        // S H.
        let free = (0..c.len()).filter(|&i| !used[i]);
        let Some(p) = free.max_by(|&a, &b| c[a].abs().total_cmp(&c[b].abs()).then(b.cmp(&a)))
        else {
            return false;
        };
        let sign = if c[p] < 0.0 { -1.0 } else { 1.0 };
        let factor = -sign * c.iter().map(|c| c.abs()).sum::<f64>();
        let beta = 1.0 / (1.0 + c[p].abs());
        c[p] += sign;
        self.reflections.push(Reflection {
            pivot: at[p],
            at,
            v: c,
            beta,
            factor,
        });
        true
    }

    /// Number of functionals.
    pub fn len(&self) -> usize {
        self.reflections.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.reflections.is_empty()
    }

    /// Positions that hold the functionals after the change of basis.
    pub fn pivots(&self) -> Vec<usize> {
        self.reflections.iter().map(|r| r.pivot).collect()
    }

    /// The positions that each functional contains.
    pub fn supports(&self) -> impl Iterator<Item = &[usize]> {
        self.reflections.iter().map(|r| &r.at[..])
    }

    /// Coordinate of functional `k` divided by its value.
    pub fn factor(&self, k: usize) -> f64 {
        self.reflections[k].factor
    }

    /// u ← Hᵀ u: from nodal values to coordinates.
    pub fn to_coordinates(&self, u: &mut [f64]) {
        self.reflections.iter().for_each(|r| r.apply(u));
    }

    /// u ← H u: from coordinates to nodal values.
    pub fn to_nodes(&self, u: &mut [f64]) {
        self.reflections.iter().rev().for_each(|r| r.apply(u));
    }

    /// A ← H A.
    pub fn columns_to_nodes(&self, a: &mut Dense) {
        if !self.is_empty() {
            (0..a.cols).for_each(|j| self.to_nodes(a.col_mut(j)));
        }
    }

    /// A ← Hᵀ A H.
    pub fn congruence_to_coordinates(&self, a: &mut Dense) {
        if self.is_empty() {
            return;
        }
        (0..a.cols).for_each(|j| self.to_coordinates(a.col_mut(j)));
        let mut along = vec![0.0; a.rows];
        let forward = self.reflections.iter();
        forward.for_each(|r| r.apply_right(a, &mut along));
    }

    /// A ← H A Hᵀ.
    pub fn congruence_to_nodes(&self, a: &mut Dense) {
        self.columns_to_nodes(a);
        let mut along = vec![0.0; a.rows];
        let backward = self.reflections.iter().rev();
        backward.for_each(|r| r.apply_right(a, &mut along));
    }

    /// The values of the functionals of u.
    pub fn values(&self, u: &[f64]) -> Vec<f64> {
        if self.is_empty() {
            return Vec::new();
        }
        let mut changed = u.to_vec();
        self.to_coordinates(&mut changed);
        let of = |r: &Reflection| changed[r.pivot] / r.factor;
        self.reflections.iter().map(of).collect()
    }

    /// The smallest change of u that gives the functionals these values.
    pub fn set_values(&self, values: &[f64], u: &mut [f64]) {
        if self.is_empty() {
            return;
        }
        self.to_coordinates(u);
        for (r, value) in self.reflections.iter().zip(values) {
            u[r.pivot] = r.factor * value;
        }
        self.to_nodes(u);
    }

    /// Removes from u the part that the functionals see.
    pub fn remove(&self, u: &mut [f64]) {
        self.set_values(&vec![0.0; self.len()], u);
    }

    /// The unit vectors q_k = H e_p behind the functionals on `n` positions: the coordinate is q_kᵀ u.
    pub fn vectors(&self, n: usize) -> Vec<Vec<f64>> {
        let of = |r: &Reflection| {
            let mut q = vec![0.0; n];
            q[r.pivot] = 1.0;
            self.to_nodes(&mut q);
            q
        };
        self.reflections.iter().map(of).collect()
    }
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/subdomain/basis.rs"]
mod tests;
