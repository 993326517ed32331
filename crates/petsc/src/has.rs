//! Parts of PETSc that not every build has.

use super::error::c_string;
use super::Session;
use base::Result;

/// Whether it has this type of preconditioner (`"hypre"`, `"hpddm"`, …).
///
/// # Errors
/// PETSc's.
pub fn has_pc(_session: &Session, name: &str) -> Result<bool> {
    let (name, mut found) = (c_string(name), 0);
    petsc!(ff_has_pc(name.as_ptr(), &mut found))?;
    Ok(found != 0)
}

/// Whether it has this package for Cholesky factorisations on one process (`"cholmod"`, `"mumps"`, …).
///
/// # Errors
/// PETSc's.
pub fn has_cholesky(_session: &Session, name: &str) -> Result<bool> {
    let (name, mut found) = (c_string(name), 0);
    petsc!(ff_has_cholesky(name.as_ptr(), &mut found))?;
    Ok(found != 0)
}
