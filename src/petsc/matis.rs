//! Unassembled matrices (MATIS): one local matrix per rank and a map of its dofs to global ones.

use super::handle::Handle;
use super::mat::count;
use super::{Comm, Mat, Session};
use crate::Result;
use petsc_sys as sys;

impl Mat {
    /// The square matrix Σ Rᵀ A_local R over the ranks; `local_to_global[i]` is the global number of local dof i and `owned` the number of
    /// global dofs whose rows this rank owns in vectors. Collective.
    pub fn unassembled(
        session: &Session,
        owned: usize,
        local_to_global: &[i32],
        local: &Mat,
    ) -> Result<Mat> {
        let comm = session.raw_comm(Comm::World);
        let mut map = std::ptr::null_mut();
        petsc!(ISLocalToGlobalMappingCreate(
            comm,
            1,
            count(local_to_global.len())?,
            local_to_global.as_ptr(),
            sys::PETSC_COPY_VALUES,
            &mut map
        ))?;
        let map = Handle::own(map, session);
        let owned = count(owned)?;
        let mut raw = std::ptr::null_mut();
        petsc!(MatCreateIS(
            comm,
            1,
            owned,
            owned,
            sys::PETSC_DETERMINE,
            sys::PETSC_DETERMINE,
            map.raw(),
            map.raw(),
            &mut raw
        ))?;
        let mat = Mat::own(raw, session);
        petsc!(MatISSetLocalMat(raw, local.raw()))?;
        mat.assemble()?;
        Ok(mat)
    }

    /// The matrix in another format of PETSc (`"aij"`, `"is"`, …). Collective.
    pub fn convert(&self, format: &str) -> Result<Mat> {
        let mut raw = std::ptr::null_mut();
        petsc!(MatConvert(
            self.raw(),
            super::error::c_string(format).as_ptr(),
            sys::MAT_INITIAL_MATRIX,
            &mut raw
        ))?;
        Ok(Mat::own(raw, self.session()))
    }
}
