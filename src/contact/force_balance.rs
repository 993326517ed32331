//! The balance of forces Gᵀ x = 0 on floating bodies, in variables in which its projector is orthogonal.

use std::rc::Rc;

use mpi::topology::SimpleCommunicator;

use crate::feti::projector::coarse_solver::InverseSide;
use crate::feti::projector::column_map::ColumnMap;
use crate::feti::projector::gram::Gram;
use crate::feti::projector::natural::NaturalCoarse;
use crate::feti::projector::refined::RefinedFactor;
use crate::feti::projector::rows::KernelRows;
use base::linalg::semidefinite::Semidefinite;

/// G (this rank's rows) and the factor of N = GᵀG, r × r, with dependent columns left out.
pub struct ForceBalance {
    g: KernelRows,
    /// The columns of G that this rank knows. Vectors of columns are the same wherever they are known.
    known: Rc<ColumnMap>,
    factor: NormalFactor,
}

/// The factor of N.
enum NormalFactor {
    /// Of few columns, with a choice of pivots.
    Dense(Semidefinite),
    /// Of many: sparse, in the order of the factor of P, with refinement in place of the choice.
    Sparse(Box<RefinedFactor>),
}

impl ForceBalance {
    /// Forms and factors N; `natural` has the G of all candidates, of which `g` are multiples of rows. Collective.
    pub fn new(comm: &SimpleCommunicator, g: KernelRows, natural: &NaturalCoarse) -> ForceBalance {
        ForceBalance::raised(comm, g, natural, None)
    }

    /// Forms and factors N = GᵀG + H for a diagonal H ≥ 0 of the columns that are known here (`None`: zero); `natural`
    /// has the G of all candidates, of which `g` are multiples of rows. Collective.
    pub fn raised(
        comm: &SimpleCommunicator,
        g: KernelRows,
        natural: &NaturalCoarse,
        h: Option<&[f64]>,
    ) -> ForceBalance {
        let shape = natural.shape.as_ref();
        let factor = match shape.and_then(|shape| Some((shape, shape.team()?))) {
            Some((shape, team)) => {
                let mut n = shape.product(comm, &g, &g, |_| true);
                for (k, h) in h.into_iter().flatten().enumerate() {
                    if team.has(k as u32) {
                        n.set_diagonal(k, n.get(k, k) + h);
                    }
                }
                let factor = Gram::new(shape, n.clone());
                NormalFactor::Sparse(RefinedFactor::symmetric(shape, factor, n).into())
            }
            None => {
                let mut n = g.product(comm, &g, natural.r, |_| true);
                for (k, h) in h.into_iter().flatten().enumerate() {
                    n.set(k, k, n.get(k, k) + h);
                }
                NormalFactor::Dense(match h {
                    // It is regular, however small H is beside GᵀG.
                    Some(_) => Semidefinite::above(&n, f64::EPSILON),
                    None => Semidefinite::new(&n),
                })
            }
        };
        let known = natural.known().clone();
        ForceBalance { g, known, factor }
    }

    /// The columns of G that this rank knows.
    pub fn known(&self) -> &ColumnMap {
        &self.known
    }

    /// Gᵀ x. Collective.
    pub fn forces(&self, comm: &SimpleCommunicator, x: &[f64]) -> Vec<f64> {
        let mut c = vec![0.0; self.known.n()];
        self.g.add_transpose(x, &mut c);
        self.known.sum(comm, &mut c);
        c
    }

    /// c ← N⁺ c.
    pub fn solve(&self, c: &mut [f64]) {
        match &self.factor {
            NormalFactor::Dense(factor) => factor.solve(c),
            NormalFactor::Sparse(factor) => factor.solve(c, InverseSide::Plain),
        }
    }

    /// N c. Collective.
    pub fn product(&self, comm: &SimpleCommunicator, c: &[f64]) -> Vec<f64> {
        let mut x = vec![0.0; self.g.n()];
        self.g.add(1.0, c, &mut x);
        self.forces(comm, &x)
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
        let [square] = self.known.total(comm, |k| [forces[k] * c[k]]);
        square.max(0.0).sqrt()
    }
}
