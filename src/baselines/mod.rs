//! PETSc's own solvers on the same problem.

use crate::cli::args::Compare;
use crate::petsc::Session;
use crate::{Error, Result};

/// Runs the comparison.
pub fn compare(_session: &Session, _args: &Compare, _petsc: &[String]) -> Result<()> {
    Err(Error::environment("this build has no baselines"))
}

/// Runs one method of a comparison.
pub fn run_job(_session: &Session, _job: &std::path::Path) -> Result<()> {
    Err(Error::environment("this build has no baselines"))
}
