//! Several right-hand sides of the host at once.

use super::solver::Embedded;
use crate::feti::krylov::together::Begun;
use crate::Result;
use cholesky::lanes::LANES;
use petsc::Vec as PetscVec;

impl Embedded {
    /// Runs the iterations for several right-hand sides, as many together as a sweep through a factor takes. Each is
    /// finished by [`Embedded::solve`]. Collective.
    ///
    /// # Errors
    /// As [`Embedded::solve`].
    pub fn together(&self, all: &[PetscVec]) -> Result<Vec<Option<Begun>>> {
        let mut begun = Vec::new();
        for some in all.chunks(LANES) {
            let mut loads = Vec::new();
            for b in some {
                self.load(b, None)?;
                loads.push(self.solver().condensed());
            }
            begun.extend(self.solver().together(loads)?);
        }
        Ok(begun)
    }
}
