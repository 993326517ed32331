//! Partitions of small graphs by PETSc's MatPartitioning.

use super::mat::count;
use super::Session;
use base::Result;
use petsc_sys::PetscInt;

/// The part (0 ≤ part < `parts`) of every vertex of a symmetric graph in compressed rows with edge weights, computed on
/// this rank alone. The option `-<prefix>mat_partitioning_type` sets the type.
///
/// # Errors
/// PETSc's own, for a type that it does not know among others.
pub fn partition(
    _session: &Session,
    prefix: &str,
    (row, col, weight): (&[PetscInt], &[PetscInt], &[PetscInt]),
    parts: usize,
) -> Result<Vec<u64>> {
    let n = row.len() - 1;
    let prefix = super::error::c_string(prefix);
    let mut part = vec![0 as PetscInt; n];
    petsc!(ff_partition(
        prefix.as_ptr(),
        count(n)?,
        row.as_ptr(),
        col.as_ptr(),
        weight.as_ptr(),
        count(parts)?,
        part.as_mut_ptr()
    ))?;
    Ok(part.iter().map(|&p| p as u64).collect())
}
