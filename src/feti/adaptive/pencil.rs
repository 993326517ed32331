//! The eigenproblem behind adaptive primal constraints, on the dofs that the same q subdomains share (docs/theory.md,
//! section 11).
//!
//! The jumps of these dofs are d = (w_a − w_q)_{a<q}. A is the energy of B_Dᵀ applied to them. M is the least energy of
//! functions with these jumps that are continuous in the common primal dofs of the q subdomains:
//! ```text
//!     dᵀ A d = Σ_c |Q_c d|²_{S_c},     Q_c d = w_c − Σ_k D_k w_k,     M⁻¹ = B T Bᵀ + B Ψ Σ⁺ Ψᵀ Bᵀ
//! ```
//!
//! A v = μ M v is solved for μ > τ as A M⁻¹ c = μ c, which gives the functionals c = A v to be made primal. M⁻¹ is the
//! F of the q subdomains alone, a sum of semidefinite terms. The soft motions are the ones that matter, and they are
//! the large part of M⁻¹: nothing cancels, however large the jumps in the coefficients are. A motion without energy has
//! a very large μ.

use std::collections::HashMap;

use crate::feti::subdomain::basis::Basis;
use base::linalg::dense::{self, Dense, Scratch};

/// Energies below this part of a primal dof's stiffness are rounding. They are replaced by this part.
const FREE: f64 = 1e-12;

/// This shift is added to A, scaled to unit diagonal, before the factorisation.
const ROUNDING: f64 = 1e-13;

/// A functional is dependent on the others if less than this part of it is left after orthogonalisation. Its entries
/// are weighed by the stiffness of their dofs.
const SAME: f64 = 1e-6;

/// The contribution of one of the subdomains.
#[derive(Debug, Clone, Default)]
pub struct PencilTerm {
    /// Q_cᵀ S_c Q_c, N × N with N = (q − 1) n.
    pub a: Dense,
    /// T on the n dofs, n × n.
    pub t: Dense,
    /// Ψ on the n dofs, n × n_Π.
    pub psi: Dense,
    /// Σ, n_Π × n_Π.
    pub sigma: Dense,
    /// A stiffness of each primal dof that does not vanish with Σ.
    pub stiff: Vec<f64>,
    /// Names of the primal dofs. Subdomains that share a primal dof have the same name for it.
    pub names: Vec<[u64; 2]>,
}

/// The functionals of n dofs to be made primal, so that A ≤ τ M where they and those that are primal already
/// (`averages`, of the same dofs) vanish.
pub fn functionals(parts: &[PencilTerm], averages: &[Vec<f64>], tau: f64) -> Vec<Vec<f64>> {
    let n = parts[0].t.rows;
    let order = parts[0].a.rows;
    let mut a = Dense::zeros(order, order);
    for part in parts {
        let terms = a.data.iter_mut().zip(&part.a.data);
        terms.for_each(|(a, b)| *a += b);
    }
    // A scaled to unit diagonal.
    let scale: Vec<f64> = (0..order).map(|i| a.get(i, i).max(0.0).sqrt()).collect();
    if scale.iter().all(|s| *s == 0.0) {
        return Vec::new();
    }
    let l = factor(&a, &scale);
    let mut f = compliance(parts);
    for j in 0..order {
        let terms = f.col_mut(j).iter_mut().zip(&scale);
        terms.for_each(|(f, s)| *f *= s * scale[j]);
    }
    let mut chosen = Chosen::new(n, &scale, averages);
    loop {
        let k = product(&l, &f);
        if below(&k, tau) {
            return chosen.list;
        }
        let found = above(&k, &l, tau);
        let before = chosen.list.len();
        if parts.len() == 2 {
            found.iter().for_each(|c| {
                chosen.add(c);
            });
            return chosen.list;
        }
        // The strongest part of the worst functional is taken. The eigenvalues of the restricted M⁻¹ decide about the
        // next.
        let Some(worst) = found.first() else {
            return chosen.list;
        };
        let in_nodes = worst.iter().zip(&scale).enumerate();
        let worst: Vec<f64> = in_nodes
            .map(|(i, (c, s))| c * s / chosen.scale[i % n])
            .collect();
        if !chosen.add(&dominant(&worst, n)) {
            worst.chunks_exact(n).for_each(|c| {
                chosen.add(c);
            });
        }
        if chosen.list.len() == before {
            return chosen.list;
        }
        for c in &chosen.scaled[chosen.scaled.len() - (chosen.list.len() - before)..] {
            restrict(&mut f, c, &chosen.scale, &scale);
        }
    }
}

/// L of D⁻¹ A D⁻¹ = L Lᵀ, D = diag(scale).
fn factor(a: &Dense, scale: &[f64]) -> Dense {
    let n = a.rows;
    let mut shift = ROUNDING;
    loop {
        let mut l = Dense::zeros(n, n);
        for j in 0..n {
            for i in j..n {
                if scale[i] > 0.0 && scale[j] > 0.0 {
                    let value = 0.5 * (a.get(i, j) + a.get(j, i));
                    l.set(i, j, value / (scale[i] * scale[j]));
                }
            }
            l.set(j, j, 1.0 + shift);
        }
        // A is semidefinite up to rounding. A second round is needed only if rounding is larger than usual.
        if dense::cholesky(l.view_mut(), &mut Scratch::default()).is_ok() || shift > 1.0 {
            for j in 1..n {
                l.col_mut(j)[..j].fill(0.0);
            }
            return l;
        }
        shift *= 100.0;
    }
}

/// M⁻¹ = B T Bᵀ + B Ψ Σ⁺ Ψᵀ Bᵀ with the differences to the last subdomain as B.
fn compliance(parts: &[PencilTerm]) -> Dense {
    let n = parts[0].t.rows;
    let (last, others) = parts.split_last().expect("shared by at least two");
    let order = others.len() * n;
    let mut f = Dense::zeros(order, order);
    for (ia, a) in others.iter().enumerate() {
        for ib in 0..others.len() {
            for j in 0..n {
                for i in 0..n {
                    let own = if ia == ib { a.t.get(i, j) } else { 0.0 };
                    f.set(ia * n + i, ib * n + j, own + last.t.get(i, j));
                }
            }
        }
    }
    let mut number: HashMap<[u64; 2], usize> = HashMap::new();
    let mut stiff: Vec<f64> = Vec::new();
    let of: Vec<Vec<usize>> = parts
        .iter()
        .map(|part| {
            let named = part.names.iter().zip(&part.stiff);
            named
                .map(|(&name, s)| {
                    let next = number.len();
                    let p = *number.entry(name).or_insert(next);
                    stiff.resize(number.len(), 0.0);
                    stiff[p] += s;
                    p
                })
                .collect()
        })
        .collect();
    let m = stiff.len();
    if m == 0 {
        return f;
    }
    let scale: Vec<f64> = stiff.iter().map(|s| 1.0 / s.sqrt()).collect();
    let mut sigma = faer::Mat::<f64>::zeros(m, m);
    let mut jump = Dense::zeros(order, m);
    for (c, (part, of)) in parts.iter().zip(&of).enumerate() {
        for (q, &gq) in of.iter().enumerate() {
            for (p, &gp) in of.iter().enumerate() {
                sigma[(gp, gq)] += part.sigma.get(p, q) * scale[gp] * scale[gq];
            }
            for i in 0..n {
                let value = part.psi.get(i, q) * scale[gq];
                if c < others.len() {
                    let sum = jump.get(c * n + i, gq) + value;
                    jump.set(c * n + i, gq, sum);
                } else {
                    for ia in 0..others.len() {
                        let sum = jump.get(ia * n + i, gq) - value;
                        jump.set(ia * n + i, gq, sum);
                    }
                }
            }
        }
    }
    let eigen = sigma
        .self_adjoint_eigen(faer::Side::Lower)
        .expect("eigenvalues of a small symmetric finite matrix converge");
    let roots = faer::Mat::from_fn(m, m, |i, k| {
        eigen.U()[(i, k)] / eigen.S().column_vector()[k].max(FREE).sqrt()
    });
    let mut w = Dense::zeros(order, m);
    dense::multiply(w.view_mut(), false, 1.0, jump.view(), roots.as_ref());
    let (w, wt) = (w.view(), w.view().transpose());
    dense::multiply(f.view_mut(), true, 1.0, w, wt);
    f
}

/// Lᵀ F L.
fn product(l: &Dense, f: &Dense) -> Dense {
    let n = l.rows;
    let mut fl = Dense::zeros(n, n);
    dense::multiply(fl.view_mut(), false, 1.0, f.view(), l.view());
    let mut k = Dense::zeros(n, n);
    dense::multiply(k.view_mut(), false, 1.0, l.view().transpose(), fl.view());
    k
}

/// Whether all eigenvalues lie below τ. This takes one Cholesky factorisation, which is much cheaper than the
/// eigenvalues.
fn below(k: &Dense, tau: f64) -> bool {
    let mut rest = k.clone();
    rest.data.iter_mut().for_each(|v| *v = -*v);
    for i in 0..k.rows {
        rest.data[i * (k.rows + 1)] += tau;
    }
    dense::cholesky(rest.view_mut(), &mut Scratch::default()).is_ok()
}

/// L y for the eigenvectors y with eigenvalues above τ, the largest first.
fn above(k: &Dense, l: &Dense, tau: f64) -> Vec<Vec<f64>> {
    let n = k.rows;
    let eigen = k
        .view()
        .self_adjoint_eigen(faer::Side::Lower)
        .expect("eigenvalues of a small symmetric finite matrix converge");
    let mut found = Vec::new();
    for j in (0..n).rev().filter(|&j| eigen.S().column_vector()[j] > tau) {
        let y: Vec<f64> = (0..n).map(|i| eigen.U()[(i, j)]).collect();
        let mut c = vec![0.0; n];
        l.add_mul(&y, &mut c);
        found.push(c);
    }
    found
}

/// The first left singular vector of c as a matrix with n rows.
fn dominant(c: &[f64], n: usize) -> Vec<f64> {
    let matrix = faer::Mat::from_fn(n, c.len() / n, |i, j| c[i + j * n]);
    let svd = matrix
        .svd()
        .expect("an SVD of a small finite matrix converges");
    (0..n).map(|i| svd.U()[(i, 0)]).collect()
}

/// F ← F − F G (Gᵀ F G)⁺ Gᵀ F: the compliance with the functional held equal in all subdomains. `c` is the functional
/// in units of `node`, F is in units of `scale`.
fn restrict(f: &mut Dense, c: &[f64], node: &[f64], scale: &[f64]) {
    let (n, order) = (c.len(), f.rows);
    let blocks = order / n;
    let mut fg = Dense::zeros(order, blocks);
    for b in 0..blocks {
        let mut g = vec![0.0; order];
        for (i, c) in c.iter().enumerate() {
            let at = b * n + i;
            if scale[at] > 0.0 {
                g[at] = c * node[i] / scale[at];
            }
        }
        let size = g.iter().map(|v| v * v).sum::<f64>().sqrt();
        if size == 0.0 {
            continue;
        }
        g.iter_mut().for_each(|v| *v /= size);
        f.add_mul(&g, fg.col_mut(b));
        // The blocks are removed one after the other: G₁ is already removed when G₂ comes.
        let energy: f64 = g.iter().zip(fg.col(b)).map(|(g, f)| g * f).sum();
        if energy > 0.0 {
            for j in 0..order {
                let factor = fg.get(j, b) / energy;
                for i in 0..order {
                    let value = f.get(i, j) - fg.get(i, b) * factor;
                    f.set(i, j, value);
                }
            }
        }
    }
}

/// The functionals found so far.
struct Chosen {
    /// In the units of the caller.
    list: Vec<Vec<f64>>,
    /// Averages and functionals, orthonormal in units of `scale`.
    scaled: Vec<Vec<f64>>,
    /// √stiffness by dof.
    scale: Vec<f64>,
    basis: Basis,
}

impl Chosen {
    fn new(n: usize, scale: &[f64], averages: &[Vec<f64>]) -> Chosen {
        let largest = scale.iter().fold(0.0f64, |a, s| a.max(*s));
        let of = |i: usize| {
            let copies = scale.iter().skip(i).step_by(n);
            copies.fold(1e-150 * largest, |a: f64, s| a.max(*s))
        };
        let mut out = Chosen {
            list: Vec::new(),
            scaled: Vec::new(),
            scale: (0..n).map(of).collect(),
            basis: Basis::default(),
        };
        for average in averages {
            let scaled = average.iter().zip(&out.scale).map(|(w, s)| w / s);
            if let Some(rest) = out.beyond(scaled.collect()) {
                out.scaled.push(rest);
                out.basis.push((0..n).collect(), average);
            }
        }
        out
    }

    /// The part of a functional, in units of the scale, beyond the earlier ones, of unit length; `None` without one.
    fn beyond(&self, c: Vec<f64>) -> Option<Vec<f64>> {
        let norm = |c: &[f64]| c.iter().map(|v| v * v).sum::<f64>().sqrt();
        let size = norm(&c);
        let mut rest = c;
        for _ in 0..2 {
            for known in &self.scaled {
                let along: f64 = known.iter().zip(&rest).map(|(k, r)| k * r).sum();
                let terms = rest.iter_mut().zip(known);
                terms.for_each(|(r, k)| *r -= along * k);
            }
        }
        let left = norm(&rest);
        if left <= SAME * size || left.is_nan() {
            return None;
        }
        rest.iter_mut().for_each(|v| *v /= left);
        Some(rest)
    }

    /// Adds a functional in units of the scale; `false` if it depends on the earlier ones.
    fn add(&mut self, c: &[f64]) -> bool {
        let Some(rest) = self.beyond(c.to_vec()) else {
            return false;
        };
        let mut weights: Vec<f64> = rest.iter().zip(&self.scale).map(|(c, s)| c * s).collect();
        let largest = weights.iter().fold(0.0f64, |a, v| a.max(v.abs()));
        weights.iter_mut().for_each(|v| *v /= largest);
        let places = (0..weights.len()).collect();
        if !self.basis.push(places, &weights) {
            return false;
        }
        self.scaled.push(rest);
        self.list.push(weights);
        true
    }
}
