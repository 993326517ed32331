//! The orthogonal matrix R = diag(Q, …, Q) of a subdomain, with the same Q at every node.
//!
//! All components of a node stand side by side, in the local dofs as on Γ. Averages are sorted by component first.

use super::problem::Gamma;
use base::linalg::dense::Dense;
use base::linalg::orthogonal::Matrix;

/// R of a subdomain with `components` dofs at every node. Q turns, mirrors, or both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    /// Number of components, 2 or 3.
    components: usize,
    /// Q; in the plane the third row and column are those of the identity.
    q: Matrix,
}

/// The places of one vector, by component; in the plane the third does not count.
type VectorComponents = [usize; 3];

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
        let c = self.components;
        let nodes = (0..a.cols / c).map(|k| [c * k, c * k + 1, c * k + 2]);
        let nodes: Vec<VectorComponents> = nodes.collect();
        (0..a.cols).for_each(|j| self.forth(a.col_mut(j)));
        self.columns(a, &nodes);
    }

    /// A ← R_Π A R_Πᵀ, A on the primal dofs. Vertices and averages turn, fixing dofs do not.
    pub fn congruence_of_primal(&self, gamma: &Gamma, a: &mut Dense) {
        let places = self.primal(gamma);
        for j in 0..a.cols {
            let column = a.col_mut(j);
            for at in &places {
                let old = at.map(|p| column.get(p).copied().unwrap_or(0.0));
                for i in 0..self.components {
                    column[at[i]] = (0..self.components).map(|a| self.q[i][a] * old[a]).sum();
                }
            }
        }
        self.columns(a, &places);
    }

    /// Γ with R Ψ R_Πᵀ in place of Ψ. Its fixing dofs are those of `gamma`, dofs of Rᵀ u.
    pub fn of_gamma(self, gamma: &Gamma) -> Gamma {
        let mut out = gamma.clone();
        (0..out.psi.cols).for_each(|p| self.forth(out.psi.col_mut(p)));
        self.columns(&mut out.psi, &self.primal(gamma));
        out.turn = Some(self);
        out
    }

    /// A ← A R_Pᵀ, where R_P turns the columns at these places.
    fn columns(&self, a: &mut Dense, places: &[VectorComponents]) {
        let c = self.components;
        for at in places {
            for row in 0..a.rows {
                let mut sum = [0.0; 3];
                for (i, s) in sum[..c].iter_mut().enumerate() {
                    *s = (0..c).map(|k| self.q[i][k] * a.get(row, at[k])).sum();
                }
                (0..c).for_each(|i| a.set(row, at[i], sum[i]));
            }
        }
    }

    /// The places of the vertices and averages among the primal dofs.
    fn primal(&self, gamma: &Gamma) -> Vec<VectorComponents> {
        let (c, n, averages) = (self.components, gamma.n_vertices(), gamma.basis.len());
        let each = averages / c;
        let vertices = (0..n / c).map(|k| [c * k, c * k + 1, c * k + 2]);
        let averages = (0..each).map(|k| [0, 1, 2].map(|i| n + i * each + k));
        vertices.chain(averages).collect()
    }
}
