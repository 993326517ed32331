//! The orthogonal matrix R = diag(Q, …, Q) of a subdomain, with the same Q at every node.
//!
//! All components of a node stand side by side, in the local dofs as on Γ. The averages A₀ of the subdomain that was
//! factored and those of the copy, A, see the same: A R = T A₀ with a regular matrix T. It takes the values of the ones
//! to those of the others, as R does with the vertices.

use super::basis::Basis;
use super::problem::Gamma;
use base::linalg::dense::Dense;
use base::linalg::orthogonal::Matrix;

/// Averages of the copy may see this much that turned averages do not see, relative to the size of an average. It is a
/// few digits more than the rounding of their weights.
const UNSEEN: f64 = 1e-11;

/// R of a subdomain with `components` dofs at every node. Q turns, mirrors, or both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    /// Number of components, 2 or 3.
    components: usize,
    /// Q; in the plane the third row and column are those of the identity.
    q: Matrix,
}

/// R_Π = diag(Q, …, Q, T⁻ᵀ, I) on the coarse functions: those of vertices, averages, and fixing dofs, which do not
/// turn.
#[derive(Debug)]
pub struct TurnOnPrimal {
    turn: Turn,
    /// Number of vertices.
    vertices: usize,
    /// T⁻ᵀ.
    averages: Dense,
}

impl Turn {
    /// R with `q` at every node.
    pub fn new(components: usize, q: Matrix) -> Turn {
        Turn { components, q }
    }

    /// Number of components.
    pub fn components(&self) -> usize {
        self.components
    }

    /// The entry of Q in row i and column a.
    pub fn entry(&self, i: usize, a: usize) -> f64 {
        self.q[i][a]
    }

    /// x ← R x; x has all components of each node side by side.
    pub fn forth(&self, x: &mut [f64]) {
        self.each(x, |q, i, a| q[i][a]);
    }

    /// x ← Rᵀ x.
    pub fn back(&self, x: &mut [f64]) {
        self.each(x, |q, i, a| q[a][i]);
    }

    fn each(&self, x: &mut [f64], entry: impl Fn(&Matrix, usize, usize) -> f64) {
        let c = self.components;
        for node in x.chunks_exact_mut(c) {
            let mut sum = [0.0; 3];
            for (i, s) in sum[..c].iter_mut().enumerate() {
                *s = (0..c).map(|a| entry(&self.q, i, a) * node[a]).sum();
            }
            node.copy_from_slice(&sum[..c]);
        }
    }

    /// A ← R A Rᵀ, A on the nodes of Γ.
    pub fn congruence(&self, a: &mut Dense) {
        (0..a.cols).for_each(|j| self.forth(a.col_mut(j)));
        rows(a, |row| self.forth(row));
    }

    /// Whether the functionals `to` on `n` dofs see what the turned functionals `from` see.
    pub fn takes(&self, n: usize, from: &Basis, to: &Basis) -> bool {
        from.len() == to.len()
            && from.vectors(n).iter_mut().all(|q| {
                self.forth(q);
                to.remove(q);
                q.iter().all(|v| v.abs() <= UNSEEN)
            })
    }

    /// R_Π from the subdomain with `gamma` to a copy with the functionals `basis`.
    pub fn on_primal(&self, gamma: &Gamma, basis: &Basis) -> TurnOnPrimal {
        let n = gamma.basis.len();
        let mut averages = Dense::zeros(n, n);
        for k in 0..n {
            let (mut value, mut u) = (vec![0.0; n], vec![0.0; gamma.n_gamma()]);
            value[k] = 1.0;
            basis.set_values(&value, &mut u);
            self.back(&mut u);
            for (m, v) in gamma.basis.values(&u).into_iter().enumerate() {
                averages.set(k, m, v);
            }
        }
        TurnOnPrimal {
            turn: *self,
            vertices: gamma.n_vertices(),
            averages,
        }
    }

    /// Γ of the copy with the functionals `basis`: R Ψ R_Πᵀ in place of Ψ. Its fixing dofs are those of `gamma`, dofs
    /// of Rᵀ u.
    pub fn of_gamma(self, gamma: &Gamma, basis: Basis, on_primal: &TurnOnPrimal) -> Gamma {
        let mut out = gamma.clone();
        (0..out.psi.cols).for_each(|p| self.forth(out.psi.col_mut(p)));
        on_primal.columns(&mut out.psi);
        let before = std::mem::replace(&mut out.basis, basis);
        out.turn = Some((self, before));
        out
    }
}

impl TurnOnPrimal {
    /// A ← R_Π A R_Πᵀ.
    pub fn congruence(&self, a: &mut Dense) {
        (0..a.cols).for_each(|j| self.forth(a.col_mut(j)));
        self.columns(a);
    }

    /// A ← A R_Πᵀ.
    fn columns(&self, a: &mut Dense) {
        if a.cols > 0 {
            rows(a, |row| self.forth(row));
        }
    }

    /// p ← R_Π p.
    fn forth(&self, p: &mut [f64]) {
        let (vertices, others) = p.split_at_mut(self.vertices);
        self.turn.forth(vertices);
        let averages = &mut others[..self.averages.cols];
        let before = averages.to_vec();
        averages.fill(0.0);
        self.averages.add_mul(&before, averages);
    }
}

/// Changes every row of `a`.
fn rows(a: &mut Dense, change: impl Fn(&mut [f64])) {
    let mut row = vec![0.0; a.cols];
    for i in 0..a.rows {
        let entries = row.iter_mut().enumerate();
        entries.for_each(|(j, v)| *v = a.get(i, j));
        change(&mut row);
        let entries = row.iter().enumerate();
        entries.for_each(|(j, v)| a.set(i, j, *v));
    }
}
