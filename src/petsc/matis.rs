//! Unassembled matrices (MATIS): one local matrix per rank and a map of its dofs to global ones.

use super::handle::Handle;
use super::mat::count;
use super::{Comm, Mat, Session, Vec};
use crate::linalg::csr::Csr;
use crate::{Error, Result};
use petsc_sys as sys;
use petsc_sys::Flag;

impl Mat {
    /// The square matrix Σ Rᵀ A_local R over the ranks. `local_to_global[i]` is the global number of local dof i, and
    /// `owned` is the number of global dofs that this rank owns. Collective.
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

    /// Converts the matrix to another PETSc format (`"aij"`, `"is"`, …). Collective.
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

/// The vectors of a null space that a host program attached to its matrix.
pub struct Attached {
    /// Whether the constants belong to it.
    pub constants: bool,
    /// The other vectors.
    pub vectors: std::vec::Vec<Vec>,
}

impl Mat {
    /// The type by PETSc's name.
    pub fn type_name(&self) -> Result<String> {
        let mut name = std::ptr::null();
        petsc!(MatGetType(self.raw(), &mut name))?;
        Ok(super::error::rust_string(name))
    }

    /// The block size: the number of rows of a node.
    pub fn block_size(&self) -> Result<usize> {
        let mut size = 1;
        petsc!(MatGetBlockSize(self.raw(), &mut size))?;
        Ok(size.max(1) as usize)
    }

    /// For a MATIS: this rank's local matrix with its stored entries, and the global number of each local row
    /// (negative: none).
    ///
    /// # Errors [`Error::Input`] if rows and columns have different maps; PETSc's own if the rows of the local matrix
    /// cannot be read.
    pub fn local_part(&self) -> Result<(Csr, std::vec::Vec<i32>)> {
        let rows = self.local_to_global()?;
        let mut raw = std::ptr::null_mut();
        petsc!(MatISGetLocalMat(self.raw(), &mut raw))?;
        let local = Mat::share(raw, self.session())?;
        let csr = local.to_csr();
        drop(local);
        petsc!(MatISRestoreLocalMat(self.raw(), &mut raw))?;
        Ok((csr?, rows))
    }

    /// For a MATIS: whether its map may list a dof several times, once for each of several subdomains on this rank
    /// (MatISSetAllowRepeated).
    pub fn is_repeated(&self) -> Result<bool> {
        let mut repeated = 0;
        petsc!(ff_is_repeated(self.raw(), &mut repeated))?;
        Ok(repeated != 0)
    }

    /// The rows of a sequential matrix of any type.
    fn to_csr(&self) -> Result<Csr> {
        let plain = if self.type_name()? == "seqaij" {
            self.clone()
        } else {
            self.convert("seqaij")?
        };
        let (n, _) = plain.size()?;
        let mut out = Csr {
            row_ptr: vec![0],
            ..Csr::default()
        };
        for i in 0..n {
            let (col, val) = plain.row(i)?;
            out.col.extend(col.iter().map(|&j| j as u32));
            out.val.extend(val);
            out.row_ptr.push(out.col.len());
        }
        Ok(out)
    }

    fn local_to_global(&self) -> Result<std::vec::Vec<i32>> {
        let (mut rows, mut cols) = (std::ptr::null_mut(), std::ptr::null_mut());
        petsc!(MatISGetLocalToGlobalMapping(
            self.raw(),
            &mut rows,
            &mut cols
        ))?;
        let list = mapped(rows)?;
        if cols != rows && mapped(cols)? != list {
            return Err(Error::input(
                "the rows and the columns of the MATIS have different local-to-global maps, expected the same",
            ));
        }
        Ok(list)
    }

    /// The null space that MatSetNullSpace attached.
    pub fn attached_null_space(&self) -> Result<Option<Attached>> {
        let mut raw = std::ptr::null_mut();
        petsc!(MatGetNullSpace(self.raw(), &mut raw))?;
        self.attached(raw)
    }

    /// The near-null space that MatSetNearNullSpace attached.
    pub fn attached_near_null_space(&self) -> Result<Option<Attached>> {
        let mut raw = std::ptr::null_mut();
        petsc!(MatGetNearNullSpace(self.raw(), &mut raw))?;
        self.attached(raw)
    }

    fn attached(&self, raw: sys::MatNullSpace) -> Result<Option<Attached>> {
        Attached::of(raw, self.session())
    }
}

impl Attached {
    /// The vectors of a null space; `None` for NULL.
    pub(crate) fn of(raw: sys::MatNullSpace, session: &Session) -> Result<Option<Attached>> {
        if raw.is_null() {
            return Ok(None);
        }
        let (mut constants, mut n, mut list) = (Flag::of(false), 0, std::ptr::null());
        petsc!(MatNullSpaceGetVecs(raw, &mut constants, &mut n, &mut list))?;
        let mut vectors = std::vec::Vec::new();
        for i in 0..n as usize {
            // SAFETY: PETSc lends `n` vectors; each is counted up here.
            vectors.push(Vec::share(unsafe { *list.add(i) }, session)?);
        }
        Ok(Some(Attached {
            constants: constants.get(),
            vectors,
        }))
    }
}

/// The global number of each local index of a map that a host program lent.
fn mapped(map: sys::ISLocalToGlobalMapping) -> Result<std::vec::Vec<i32>> {
    let (mut n, mut data) = (0, std::ptr::null());
    petsc!(ISLocalToGlobalMappingGetSize(map, &mut n))?;
    petsc!(ISLocalToGlobalMappingGetIndices(map, &mut data))?;
    let copy = if n == 0 {
        std::vec::Vec::new()
    } else {
        // SAFETY: PETSc lends `n` indices until they are restored.
        unsafe { std::slice::from_raw_parts(data, n as usize) }.to_vec()
    };
    petsc!(ISLocalToGlobalMappingRestoreIndices(map, &mut data))?;
    Ok(copy)
}
