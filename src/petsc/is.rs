//! Index sets.

use super::handle::Handle;
use super::{Comm, Session};
use crate::Result;
use petsc_sys as sys;

/// A list of indices, distributed or of this rank alone.
#[derive(Clone)]
pub struct Is(pub(crate) Handle<sys::_p_IS>);

impl Is {
    /// An index set whose part on this rank is `indices`, in this order.
    pub fn general(session: &Session, comm: Comm, indices: &[i32]) -> Result<Is> {
        let mut raw = std::ptr::null_mut();
        petsc!(ISCreateGeneral(
            session.raw_comm(comm),
            indices.len() as i32,
            indices.as_ptr(),
            sys::PETSC_COPY_VALUES,
            &mut raw
        ))?;
        Ok(Is(Handle::own(raw, session)))
    }

    pub(crate) fn share(raw: sys::IS, session: &Session) -> Result<Is> {
        Ok(Is(Handle::share(raw, session)?))
    }

    /// Number of indices on this rank.
    pub fn local_len(&self) -> Result<usize> {
        let mut n = 0;
        petsc!(ISGetLocalSize(self.0.raw(), &mut n))?;
        Ok(n as usize)
    }

    /// This rank's indices.
    pub fn indices(&self) -> Result<std::vec::Vec<i32>> {
        let n = self.local_len()?;
        let mut data = std::ptr::null();
        petsc!(ISGetIndices(self.0.raw(), &mut data))?;
        let copy = if n == 0 {
            std::vec::Vec::new()
        } else {
            // SAFETY: PETSc lends `n` indices until they are restored.
            unsafe { std::slice::from_raw_parts(data, n) }.to_vec()
        };
        petsc!(ISRestoreIndices(self.0.raw(), &mut data))?;
        Ok(copy)
    }
}
