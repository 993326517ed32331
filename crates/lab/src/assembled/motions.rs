//! Rigid motions of bodies, and which of them ties, springs, prescribed values and rows leave free.
//!
//! A body moves by α ∈ Rᵐ, m = 1 (scalars), 3 or 6; the α of all bodies form one long vector. A row that holds, a tie
//! or a prescribed value is a linear form that vanishes on this vector. Forms are collected in echelon form: a form
//! that is independent of the earlier ones holds a motion that was free.

use std::collections::{BTreeMap, HashMap};
use std::ops::Range;

use elements::cell::rigid_motions;
use scene::{Body, Scene};

/// A form is dependent if its remainder, relative to its largest entry, is below this.
const DEPENDENT: f64 = 1e-9;

/// A form is chosen to complete the equations only if this part of it remains after elimination. Where no candidate
/// reaches the bound, the bound is halved, again and again.
const FIRM: f64 = 0.3;

/// A linear form, or the left-hand side of an equation: (index, coefficient), indices increasing.
pub type Functional = Vec<(usize, f64)>;

/// Independent equations in echelon form.
#[derive(Debug, Clone, Default)]
pub struct Echelon {
    /// Equations with their pivots: (pivot, form, right-hand side). The pivot of an earlier equation does not occur in
    /// a later one.
    rows: Vec<(usize, BTreeMap<usize, f64>, f64)>,
    of_pivot: HashMap<usize, usize>,
}

impl Echelon {
    /// Number of independent equations.
    pub fn rank(&self) -> usize {
        self.rows.len()
    }

    /// Eliminates the pivots from a form. Returns the remainder, the largest entry of the form, and the remaining
    /// right-hand side.
    fn reduce(&self, form: &Functional, mut rhs: f64) -> (BTreeMap<usize, f64>, f64) {
        let mut rest: BTreeMap<usize, f64> = BTreeMap::new();
        form.iter()
            .for_each(|&(k, v)| *rest.entry(k).or_default() += v);
        while let Some(r) = rest.keys().filter_map(|k| self.of_pivot.get(k)).min() {
            let (pivot, row, its) = &self.rows[*r];
            let factor = rest.remove(pivot).expect("the pivot was found in it");
            rhs -= factor * its;
            for (&k, v) in row.iter().filter(|(k, _)| *k != pivot) {
                *rest.entry(k).or_default() -= factor * v;
            }
        }
        (rest, rhs)
    }

    /// The remainder of a form after elimination, relative to the form: 0 if it depends on the equations.
    pub fn left(&self, form: &Functional) -> f64 {
        let largest = |m: f64, v: f64| m.max(v.abs());
        let size = form.iter().map(|t| t.1).fold(0.0, largest);
        let left = self.reduce(form, 0.0).0.into_values().fold(0.0, largest);
        if left > DEPENDENT * size {
            left / size
        } else {
            0.0
        }
    }

    /// Adds form·α = rhs if it is independent, and says whether it was.
    pub fn insert(&mut self, form: &Functional, rhs: f64) -> bool {
        let size = form.iter().fold(0.0f64, |m, t| m.max(t.1.abs()));
        let (mut rest, mut rhs) = self.reduce(form, rhs);
        let by_size = |a: &(&usize, &f64), b: &(&usize, &f64)| {
            a.1.abs().total_cmp(&b.1.abs()).then(b.0.cmp(a.0))
        };
        let Some((&pivot, &value)) = rest.iter().max_by(by_size) else {
            return false;
        };
        if value.abs() <= DEPENDENT * size {
            return false;
        }
        // Entries that are rounding would fill the rows.
        rest.retain(|_, v| v.abs() > 1e-14 * size);
        rest.values_mut().for_each(|v| *v /= value);
        rhs /= value;
        self.of_pivot.insert(pivot, self.rows.len());
        self.rows.push((pivot, rest, rhs));
        true
    }

    /// The candidates that, set to zero, hold all n motions together with these equations; those with the largest
    /// remainders are preferred.
    pub fn complete(&self, n: usize, candidates: &[(u64, Functional)]) -> Vec<(u64, Functional)> {
        let (mut now, mut chosen) = (self.clone(), Vec::new());
        let mut firm = FIRM;
        while now.rank() < n && firm > 1e-6 {
            for candidate in candidates {
                if now.left(&candidate.1) >= firm && now.insert(&candidate.1, 0.0) {
                    chosen.push(candidate.clone());
                }
            }
            firm *= 0.5;
        }
        chosen
    }

    /// The α of length n that satisfies the equations and is zero elsewhere.
    pub fn solve(&self, n: usize) -> Vec<f64> {
        let mut alpha = vec![0.0; n];
        for (pivot, row, rhs) in self.rows.iter().rev() {
            let others = row.iter().filter(|(k, _)| *k != pivot);
            alpha[*pivot] = rhs - others.map(|(&k, v)| v * alpha[k]).sum::<f64>();
        }
        alpha
    }
}

/// The rigid motions of the bodies of a scene.
#[derive(Debug, Clone)]
pub struct Motions {
    dim: usize,
    components: usize,
    /// Which of the rigid motions a body has.
    own: Range<usize>,
    /// Centre and radius of every body.
    bodies: Vec<([f64; 3], f64)>,
}

impl Motions {
    /// The rigid motions of the bodies of `scene`.
    pub fn new(scene: &Scene) -> Motions {
        let (dim, components) = (scene.dim(), scene.components());
        Motions {
            dim,
            components,
            own: match components {
                1 => 0..1,
                _ => scene.form.rigid(dim),
            },
            bodies: scene.bodies.iter().map(Body::ball).collect(),
        }
    }

    /// Number of motions of all bodies.
    pub fn len(&self) -> usize {
        self.own.len() * self.bodies.len()
    }

    /// The form of component `component` of u at a point of a body.
    pub fn form(&self, body: usize, point: [f64; 3], component: usize) -> Functional {
        let first = body * self.own.len();
        if self.components == 1 {
            return vec![(first, 1.0)];
        }
        let (centre, radius) = self.bodies[body];
        let motions = rigid_motions(self.dim, centre, radius, point);
        let own = motions[self.own.clone()].iter().enumerate();
        let entries = own.map(|(m, motion)| (first + m, motion[component]));
        entries.filter(|e| e.1 != 0.0).collect()
    }

    /// The form of Σ coefficient · u(body dof).
    pub fn of_terms(&self, scene: &Scene, terms: &[(u64, f64)]) -> Functional {
        let mut out: BTreeMap<usize, f64> = BTreeMap::new();
        for &(dof, coefficient) in terms {
            let body = scene.bodies.partition_point(|b| b.first_dof <= dof) - 1;
            let inside = (dof - scene.bodies[body].first_dof) as usize;
            for (k, v) in self.at(scene, body, inside) {
                *out.entry(k).or_default() += coefficient * v;
            }
        }
        out.into_iter().collect()
    }

    /// The form of degree of freedom C k + c of a body.
    fn at(&self, scene: &Scene, body: usize, inside: usize) -> Functional {
        let spec = &scene.bodies[body].spec;
        let at = spec.position(inside / self.components);
        self.form(body, at, inside % self.components)
    }

    /// The equations of ties, springs and prescribed values, and those between displacements.
    pub fn held(&self, scene: &Scene) -> Echelon {
        let mut out = Echelon::default();
        for (b, body) in scene.bodies.iter().enumerate() {
            for &(dof, _) in &body.prescribed {
                out.insert(&self.at(scene, b, dof), 0.0);
            }
            for node in scene.sprung(body) {
                for c in 0..self.components {
                    out.insert(&self.form(b, body.spec.position(node), c), 0.0);
                }
            }
        }
        for point in &scene.points {
            for (member, &to) in point.members.iter().zip(&point.tied_to) {
                let other = &point.members[to];
                if (member.body, member.node) == (other.body, other.node) {
                    continue;
                }
                for c in 0..self.components {
                    let dof = |b: usize, node: usize| {
                        scene.bodies[b].first_dof + (node * self.components + c) as u64
                    };
                    let tie = [
                        (dof(member.body, member.node), 1.0),
                        (dof(other.body, other.node), -1.0),
                    ];
                    out.insert(&self.of_terms(scene, &tie), 0.0);
                }
            }
        }
        for row in scene.rows.iter().filter(|row| !row.law.is_inequality()) {
            // The others are ties of points.
            if row.combination.is_some() {
                out.insert(&self.of_terms(scene, &row.terms(&scene.bodies)), 0.0);
            }
        }
        out
    }
}

#[cfg(test)]
#[path = "../../tests/assembled/motions.rs"]
mod tests;
