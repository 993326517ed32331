//! Solves that the host judges: it measures the residual of its own equations.

use super::solver::Embedded;
use crate::feti::krylov::together::Begun;
use crate::feti::krylov::verdict::{HostSolution, JudgeTiming, Verdict};
use crate::status::Status;
use crate::Result;
use petsc::Vec as PetscVec;

/// Looks at the solution x for the host.
pub type SolutionJudge<'a> = dyn Fn(&PetscVec, JudgeTiming) -> Result<Verdict> + 'a;

/// The result of a solve that the host has judged.
#[derive(Debug, Clone)]
pub struct JudgedResult {
    /// Iterations.
    pub iterations: usize,
    /// Why it stopped.
    pub status: Status,
    /// (largest, smallest) eigenvalue of the preconditioned operator, as the iteration estimated them.
    pub spectrum: Option<(f64, f64)>,
    /// Whether x is the one that has satisfied the host.
    pub satisfied: bool,
}

impl Embedded {
    /// Solves for the right-hand side b. Whenever x satisfies the tolerance of the dual problem, and before an
    /// iteration that may have nothing to do, `enough` is called. The iteration may have been run already, together
    /// with others. Collective.
    ///
    /// # Errors
    /// A load that is not balanced, or that acts on an empty row; PETSc's own errors and those of `enough`.
    pub fn solve(
        &self,
        begun: Option<Begun>,
        b: &PetscVec,
        x: &PetscVec,
        enough: &SolutionJudge,
    ) -> Result<JudgedResult> {
        self.load(b, None)?;
        let solved = self.solver().judged(begun, &|u, look| {
            self.put_together(u, x)?;
            enough(x, look)
        })?;
        let (iterations, status, estimate, satisfied) = match solved {
            HostSolution::Satisfied(run) => (run.iterations, run.status, run.estimate, true),
            HostSolution::Certified(found) => {
                self.put_together(&found.u, x)?;
                (found.iterations, found.status, found.estimate, false)
            }
        };
        Ok(JudgedResult {
            iterations,
            status,
            spectrum: estimate.map(|s| (s.lambda_max, s.lambda_min)),
            satisfied,
        })
    }
}
