//! (Gᵀ Q G)⁻¹: what is asked of a solver of the natural coarse problem. [`Gtg`](super::gtg::Gtg) chooses one.

use mpi::topology::SimpleCommunicator;

use super::column_map::ColumnMap;
use super::gram::Gram;
use super::rows::KernelRows;
use crate::Result;
use parallel::clock::{self, Phase};
use petsc::{Ksp, Vec as PetscVec};

/// The inverse or its transpose.
#[derive(Clone, Copy)]
pub enum InverseSide {
    /// (Gᵀ Q G)⁻¹
    Plain,
    /// (Gᵀ Q G)⁻ᵀ
    Transposed,
}

/// How GᵀQG is solved by the user's choice, and how often it was.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CoarseSolves {
    /// KSP and PC that the user has chosen.
    pub solver: String,
    /// Whether FGMRES iterates around them.
    pub iterated: bool,
    /// Number of solutions.
    pub solves: usize,
    /// Iterations of FGMRES in all of them.
    pub iterations: usize,
}

/// A solver for GᵀQG. Vectors have an entry for each column that this rank knows, the same wherever it is known.
pub trait CoarseSolver {
    /// x ← (Gᵀ Q G)⁻¹ x or (Gᵀ Q G)⁻ᵀ x. Collective.
    ///
    /// # Errors
    /// An iteration that does not converge.
    fn solve(&self, x: &mut [f64], side: InverseSide) -> Result<()>;

    /// The relative error of a vector after multiplication with the scaled matrix and its inverse. It is about the
    /// condition number times rounding, and it is the accuracy that P loses. Collective.
    ///
    /// # Errors
    /// PETSc's own.
    fn defect(&self) -> Result<f64>;

    /// A name for `-fetifeti_ksp_view`.
    ///
    /// # Errors
    /// PETSc's own.
    fn describe(&self) -> Result<String>;

    /// Whether a factor of many columns has no smaller eigenvalue, or no larger defect.
    fn loses_less(&self, _eigenvalue: f64, _defect: f64) -> bool {
        false
    }

    /// The factor that ranks share, if it solves at once.
    fn shared(&self) -> Option<&Gram> {
        None
    }

    /// PETSc's solver, if it is one.
    fn ksp(&self) -> Option<&Ksp> {
        None
    }

    /// How the user's solver works, if it is one.
    ///
    /// # Errors
    /// PETSc's own.
    fn work(&self) -> Result<Option<CoarseSolves>> {
        Ok(None)
    }

    /// x ← x − along (Gᵀ Q G)⁻¹ fromᵀ x (or with the transposed inverse). `c` is for the columns. Collective.
    ///
    /// # Errors
    /// As [`solve`](CoarseSolver::solve).
    fn remove(
        &self,
        (comm, known): (&SimpleCommunicator, &ColumnMap),
        x: &PetscVec,
        [from, along]: [&KernelRows; 2],
        c: &mut [f64],
        side: InverseSide,
    ) -> Result<()> {
        c.fill(0.0);
        from.add_transpose(&x.array()?, c);
        clock::timed(Phase::Reduction, || known.sum(comm, c));
        clock::timed(Phase::Natural, || self.solve(c, side))?;
        along.add(-1.0, c, &mut x.array_mut()?);
        Ok(())
    }
}
