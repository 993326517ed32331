//! Unassembled matrices (MATIS): one local matrix per rank and a map of its dofs to global ones.

use super::error::{c_string, copied, got, text};
use super::handle::Handle;
use super::mat::count;
use super::{Comm, Mat, Session, Vec};
use base::linalg::csr::Csr;
use base::{Error, Result};
use petsc_sys as sys;
use petsc_sys::Flag;
use petsc_sys::PetscInt;

impl Mat {
    /// The square matrix Σ Rᵀ A_local R over the ranks. `local_to_global[i]` is the global number of local dof i, and
    /// `owned` is the number of global dofs that this rank owns. With `repeated` several local dofs may have one
    /// number, each in a subdomain of its own; PETSc 3.21 and later. Collective.
    pub fn unassembled(
        session: &Session,
        owned: usize,
        local_to_global: &[PetscInt],
        local: &Mat,
        repeated: bool,
    ) -> Result<Mat> {
        let comm = session.raw_comm(Comm::World);
        let n = count(local_to_global.len())?;
        let map = Handle::made(session, |map| {
            let numbers = local_to_global.as_ptr();
            petsc!(ISLocalToGlobalMappingCreate(
                comm,
                1,
                n,
                numbers,
                sys::PETSC_COPY_VALUES,
                map
            ))
        })?;
        let owned = count(owned)?;
        let mat = Mat::made(session, |raw| petsc!(MatCreate(comm, raw)))?;
        let rest = sys::PETSC_DETERMINE;
        petsc!(MatSetSizes(mat.raw(), owned, owned, rest, rest))?;
        petsc!(MatSetType(mat.raw(), c"is".as_ptr()))?;
        if repeated {
            petsc!(ff_allow_repeated(mat.raw()))?;
        }
        petsc!(MatSetLocalToGlobalMapping(mat.raw(), map.raw(), map.raw()))?;
        petsc!(MatISSetLocalMat(mat.raw(), local.raw()))?;
        mat.assemble()?;
        Ok(mat)
    }

    /// Converts the matrix to another PETSc format (`"aij"`, `"is"`, …). Collective.
    pub fn convert(&self, format: &str) -> Result<Mat> {
        Mat::made(self.session(), |raw| {
            petsc!(MatConvert(
                self.raw(),
                c_string(format).as_ptr(),
                sys::MAT_INITIAL_MATRIX,
                raw
            ))
        })
    }

    /// The type by PETSc's name.
    pub fn type_name(&self) -> Result<String> {
        text(|name| petsc!(MatGetType(self.raw(), name)))
    }

    /// The type of vectors that the matrix is multiplied with, by PETSc's name.
    pub fn vec_type_name(&self) -> Result<String> {
        text(|name| petsc!(MatGetVecType(self.raw(), name)))
    }

    /// For a MATIS: the type of this rank's local matrix by PETSc's name.
    pub fn local_type_name(&self) -> Result<String> {
        let mut raw = std::ptr::null_mut();
        petsc!(MatISGetLocalMat(self.raw(), &mut raw))?;
        let name = Mat::share(raw, self.session())?.type_name();
        petsc!(MatISRestoreLocalMat(self.raw(), &mut raw))?;
        name
    }

    /// The block size: the number of rows of a node.
    pub fn block_size(&self) -> Result<usize> {
        let size = got(|size| petsc!(MatGetBlockSize(self.raw(), size)))?;
        Ok(size.max(1) as usize)
    }

    /// For a MATIS: this rank's local matrix with its stored entries, and the global number of each local row
    /// (negative: none).
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) if rows and columns have different maps; PETSc's own if the rows of
    /// the local matrix cannot be read.
    pub fn local_part(&self) -> Result<(Csr, std::vec::Vec<PetscInt>)> {
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
        Ok(got(|repeated| petsc!(ff_is_repeated(self.raw(), repeated)))? != 0)
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

    fn local_to_global(&self) -> Result<std::vec::Vec<PetscInt>> {
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
    pub fn attached_null_space(&self) -> Result<Option<AttachedNullSpace>> {
        let mut raw = std::ptr::null_mut();
        petsc!(MatGetNullSpace(self.raw(), &mut raw))?;
        AttachedNullSpace::of(raw, self.session())
    }

    /// The near-null space that MatSetNearNullSpace attached.
    pub fn attached_near_null_space(&self) -> Result<Option<AttachedNullSpace>> {
        let mut raw = std::ptr::null_mut();
        petsc!(MatGetNearNullSpace(self.raw(), &mut raw))?;
        AttachedNullSpace::of(raw, self.session())
    }
}

/// The vectors of a null space that a host program attached to its matrix.
pub struct AttachedNullSpace {
    /// Whether the constants belong to it.
    pub constants: bool,
    /// The other vectors.
    pub vectors: std::vec::Vec<Vec>,
}

impl AttachedNullSpace {
    /// The vectors of a null space that a host program lends; `None` for NULL.
    ///
    /// # Safety
    /// `raw` is NULL or a live null space.
    pub unsafe fn of_host(
        raw: sys::MatNullSpace,
        session: &Session,
    ) -> Result<Option<AttachedNullSpace>> {
        AttachedNullSpace::of(raw, session)
    }

    /// The vectors of a null space; `None` for NULL.
    fn of(raw: sys::MatNullSpace, session: &Session) -> Result<Option<AttachedNullSpace>> {
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
        Ok(Some(AttachedNullSpace {
            constants: constants.get(),
            vectors,
        }))
    }
}

/// The global number of each local index of a map that a host program lent.
fn mapped(map: sys::ISLocalToGlobalMapping) -> Result<std::vec::Vec<PetscInt>> {
    let n = got(|n| petsc!(ISLocalToGlobalMappingGetSize(map, n)))?;
    let mut data = std::ptr::null();
    petsc!(ISLocalToGlobalMappingGetIndices(map, &mut data))?;
    // SAFETY: PETSc lends `n` indices until they are restored.
    let copy = unsafe { copied(data, n) };
    petsc!(ISLocalToGlobalMappingRestoreIndices(map, &mut data))?;
    Ok(copy)
}
