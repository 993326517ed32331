//! Gᵀ Q G and its inverse.
//!
//! With Q = I and many rigid motions the factor of GᵀG that tells what the rows hold ([`Gram`]) is the inverse, too
//! (`unweighted`). With other Q and many motions it is a factor of its own (`refined`). Ranks share both. The matrix of
//! few motions stands behind an LU factorisation of each rank (`scaled_ksp`). If an option with the prefix
//! `fetifeti_gtg_` is set, it stands behind a PETSc KSP over all ranks (`distributed`).

use std::cell::RefCell;
use std::rc::Rc;

use mpi::topology::SimpleCommunicator;

use super::coarse_solver::{CoarseSolver, InverseSide};
use super::distributed::Distributed;
use super::gram::{Gram, REGULAR};
use super::gram_pattern::GramPattern;
use super::refined::RefinedFactor;
use super::rows::KernelRows;
use super::scaled_ksp::ScaledKsp;
use super::team_factor::TeamFactor;
use super::unweighted::Unweighted;
use crate::feti::settings::ProjectorKind;
use crate::Result;
use base::linalg::csr::Csr;
use petsc::{Options, Session, Vec as PetscVec};

/// A factor is exact if a vector loses less than this on its way through the matrix and back.
const EXACT: f64 = 1e-11;

/// A solve with it leaves nothing for another one if it loses less than this.
const WHOLE: f64 = 1e-13;

/// The smallest eigenvalue of GᵀG, after scaling to a unit diagonal, with which a solve leaves nothing for another one:
/// rounding is magnified by the inverse.
const STRONG: f64 = 1e-3;

/// (Gᵀ Q G)⁻¹.
pub struct Gtg {
    /// Its solver.
    pub solver: Box<dyn CoarseSolver>,
    /// GᵀG of the rows that hold: what they hold.
    pub gram: Rc<Gram>,
    /// The way of distributed vectors to the factor, where ranks share it.
    spread: Option<Rc<TeamFactor>>,
    scratch: RefCell<Vec<f64>>,
}

impl Gtg {
    /// The inverse for the rows of `gram` and the weight `q`, not Auto, from G and QG; GᵀQG has the pattern of `shape`.
    /// `chosen` makes a solver of the user's choice. Collective.
    pub fn new(
        session: &Session,
        (shape, gram): (&GramPattern, Rc<Gram>),
        q: ProjectorKind,
        [g, qg]: [&KernelRows; 2],
        prefix: &str,
        chosen: impl FnOnce(&Gram) -> Result<Distributed>,
    ) -> Result<Gtg> {
        let comm = session.comm();
        let petsc = |a: Csr| -> Result<Box<dyn CoarseSolver>> {
            Ok(Box::new(ScaledKsp::new(session, &gram, a, prefix)?))
        };
        let solver: Box<dyn CoarseSolver> = match q {
            _ if Options::new(session, prefix).any()? => Box::new(chosen(&gram)?),
            ProjectorKind::Identity if gram.is_sparse() => Box::new(Unweighted(gram.clone())),
            _ if gram.is_sparse() => {
                let both = shape.product_and_transpose(comm, g, qg);
                match RefinedFactor::weighted(shape, both, &gram) {
                    Ok(factor) => Box::new(factor),
                    Err(a) => petsc(shape.gathered(comm, a))?,
                }
            }
            _ => petsc(shape.product(comm, g, qg, |_| true))?,
        };
        let n = gram.known().n();
        Ok(Gtg {
            solver,
            gram,
            spread: None,
            scratch: RefCell::new(vec![0.0; n]),
        })
    }

    /// Whether ranks share a factor that solves at once.
    pub fn is_shared(&self) -> bool {
        self.solver.shared().is_some()
    }

    /// Whether a factor of many columns solves to nearly all digits.
    pub fn is_exact(&self) -> bool {
        self.solver.loses_less(REGULAR, EXACT)
    }

    /// Whether another solve with a factor of many columns would not make a solution better.
    pub fn needs_no_second(&self) -> bool {
        self.solver.loses_less(STRONG, WHOLE)
    }

    /// Vectors go to the shared factor this way from now on.
    pub fn set_spread(&mut self, spread: Option<Rc<TeamFactor>>) {
        self.spread = spread;
    }

    /// c ← (Gᵀ Q G)⁻¹ (b + Σ c) (or with the transposed inverse), the sum over the ranks. A rank has the solution in
    /// the columns of its own rows and bodies; other entries are not to be read. `b` is the same wherever columns are
    /// known. Collective.
    pub fn solve_sum(
        &self,
        comm: &SimpleCommunicator,
        c: &mut [f64],
        b: Option<&[f64]>,
        side: InverseSide,
    ) -> Result<()> {
        if let (Some(factor), Some(spread)) = (self.solver.shared(), &self.spread) {
            return spread.solve(factor, c, b);
        }
        self.gram.known().sum(comm, c);
        if let Some(b) = b {
            c.iter_mut().zip(b).for_each(|(c, b)| *c += b);
        }
        self.solver.solve(c, side)
    }

    /// x ← x − along (Gᵀ Q G)⁻¹ fromᵀ x (or with the transposed inverse). Collective.
    pub fn remove(
        &self,
        comm: &SimpleCommunicator,
        x: &PetscVec,
        from: &KernelRows,
        along: &KernelRows,
        side: InverseSide,
    ) -> Result<()> {
        if let (Some(factor), Some(spread)) = (self.solver.shared(), &self.spread) {
            return spread.remove(factor, x, from, along);
        }
        let (known, mut c) = (self.gram.known(), self.scratch.borrow_mut());
        self.solver
            .remove((comm, known), x, [from, along], &mut c, side)
    }
}
