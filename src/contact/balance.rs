//! The balance of forces Gᵀ x = 0 on floating bodies, in variables in which its projector is orthogonal.

use mpi::topology::SimpleCommunicator;

use crate::feti::projector::rows::Rows;
use crate::linalg::dense::Dense;
use crate::linalg::semidefinite::Semidefinite;
use crate::parallel::exchange::sum_all;

/// G (this rank's rows) and the factor of N = GᵀG, with dependent columns left out.
pub struct Balance {
    g: Rows,
    /// N = Gᵀ G, r × r, the same on every rank.
    pub n: Dense,
    factor: Semidefinite,
}

impl Balance {
    /// Forms and factors N. Collective.
    pub fn new(comm: &SimpleCommunicator, g: Rows, r: usize) -> Balance {
        let n = g.product(comm, &g, r, |_| true);
        let factor = Semidefinite::new(&n);
        Balance { g, n, factor }
    }

    /// Gᵀ x. Collective.
    pub fn forces(&self, comm: &SimpleCommunicator, x: &[f64]) -> Vec<f64> {
        let mut c = vec![0.0; self.n.rows];
        self.g.add_transpose(x, &mut c);
        sum_all(comm, &mut c);
        c
    }

    /// c ← N⁺ c.
    pub fn solve(&self, c: &mut [f64]) {
        self.factor.solve(c);
    }

    /// x ← x + α G c.
    pub fn add(&self, alpha: f64, c: &[f64], x: &mut [f64]) {
        self.g.add(alpha, c, x);
    }

    /// x ← P x = x − G N⁺ Gᵀ x; returns the coefficients N⁺ Gᵀ x of what was removed. Collective.
    pub fn project(&self, comm: &SimpleCommunicator, x: &mut [f64]) -> Vec<f64> {
        let mut c = self.forces(comm, x);
        self.solve(&mut c);
        self.add(-1.0, &c, x);
        c
    }

    /// ‖(I − P) x‖. Collective.
    pub fn violation(&self, comm: &SimpleCommunicator, x: &[f64]) -> f64 {
        let forces = self.forces(comm, x);
        let mut c = forces.clone();
        self.solve(&mut c);
        let square: f64 = forces.iter().zip(&c).map(|(f, c)| f * c).sum();
        square.max(0.0).sqrt()
    }
}
