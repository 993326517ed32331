//! Index sets.

use super::error::{copied, got};
use super::handle::Handle;
use super::{Comm, Session};
use base::Result;
use petsc_sys as sys;
use petsc_sys::PetscInt;

/// A list of indices, distributed or of this rank alone.
pub type Is = Handle<sys::_p_IS>;

impl Is {
    /// An index set whose part on this rank is `indices`, in this order.
    pub fn general(session: &Session, comm: Comm, indices: &[PetscInt]) -> Result<Is> {
        Is::made(session, |raw| {
            petsc!(ISCreateGeneral(
                session.raw_comm(comm),
                indices.len() as PetscInt,
                indices.as_ptr(),
                sys::PETSC_COPY_VALUES,
                raw
            ))
        })
    }

    /// This rank's indices.
    pub fn indices(&self) -> Result<std::vec::Vec<PetscInt>> {
        let n = got(|n| petsc!(ISGetLocalSize(self.raw(), n)))?;
        let mut data = std::ptr::null();
        petsc!(ISGetIndices(self.raw(), &mut data))?;
        // SAFETY: PETSc lends `n` indices until they are restored.
        let copy = unsafe { copied(data, n) };
        petsc!(ISRestoreIndices(self.raw(), &mut data))?;
        Ok(copy)
    }
}
