//! Matrices: assembled matrices (AIJ), and the functions common to all types.

use super::error::copied;
use super::handle::Handle;
use super::{Comm, Session, Vec};
use base::linalg::csr::Csr;
use base::{Error, Result};
use petsc_sys as sys;
use petsc_sys::Flag;
use petsc_sys::PetscInt;

/// A property of a matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MatFlag {
    /// Symmetric: Aᵀ = A, also after changes.
    Symmetric,
    /// Symmetric positive definite.
    Spd,
}

/// A linear operator: assembled, unassembled (MATIS) or a shell. Clones are handles to the same matrix.
pub type Mat = Handle<sys::_p_Mat>;

impl Mat {
    /// An AIJ matrix of this size, without preallocation.
    fn empty_aij(session: &Session, comm: Comm, rows: usize, cols: usize) -> Result<Mat> {
        let mat = Mat::made(session, |raw| {
            petsc!(MatCreate(session.raw_comm(comm), raw))
        })?;
        petsc!(MatSetSizes(
            mat.raw(),
            count(rows)?,
            count(cols)?,
            sys::PETSC_DETERMINE,
            sys::PETSC_DETERMINE
        ))?;
        petsc!(MatSetType(mat.raw(), c"aij".as_ptr()))?;
        Ok(mat)
    }

    /// An AIJ matrix with `rows` rows and `cols` columns on this rank, from (global row, global column, value) entries
    /// that any rank may give for any row; repeated entries are added up. Collective.
    pub fn from_triplets(
        session: &Session,
        comm: Comm,
        rows: usize,
        cols: usize,
        entries: &[(PetscInt, PetscInt, f64)],
    ) -> Result<Mat> {
        let mat = Mat::empty_aij(session, comm, rows, cols)?;
        let raw = mat.raw();
        // PETSc sorts the index arrays in place.
        let mut i: std::vec::Vec<PetscInt> = entries.iter().map(|e| e.0).collect();
        let mut j: std::vec::Vec<PetscInt> = entries.iter().map(|e| e.1).collect();
        let v: std::vec::Vec<f64> = entries.iter().map(|e| e.2).collect();
        petsc!(MatSetPreallocationCOO(
            raw,
            entries.len() as sys::PetscCount,
            i.as_mut_ptr(),
            j.as_mut_ptr()
        ))?;
        petsc!(MatSetValuesCOO(raw, v.as_ptr(), sys::ADD_VALUES))?;
        Ok(mat)
    }

    /// An AIJ matrix of this rank alone.
    pub fn from_csr(session: &Session, csr: &Csr) -> Result<Mat> {
        let n = csr.n();
        let mat = Mat::preallocated(
            session,
            Comm::Own,
            n,
            n,
            &(0..n)
                .map(|i| csr.row(i).0.len() as PetscInt)
                .collect::<std::vec::Vec<_>>(),
            &[],
        )?;
        for i in 0..n {
            let (col, val) = csr.row(i);
            let col: std::vec::Vec<PetscInt> = col.iter().map(|&j| j as PetscInt).collect();
            mat.add_values(&[i as PetscInt], &col, val)?;
        }
        mat.assemble()?;
        Ok(mat)
    }

    /// An empty AIJ matrix with room in row i for `d_nnz[i]` entries in the columns of this rank and `o_nnz[i]` entries
    /// in the other columns (`o_nnz` is ignored with [`Comm::Own`]). [`Mat::add_values`] and [`Mat::assemble`] fill it.
    pub fn preallocated(
        session: &Session,
        comm: Comm,
        rows: usize,
        cols: usize,
        d_nnz: &[PetscInt],
        o_nnz: &[PetscInt],
    ) -> Result<Mat> {
        if d_nnz.len() != rows || (comm == Comm::World && o_nnz.len() != rows) {
            return Err(Error::environment(format!(
                "Internal error: a matrix with {rows} rows was given {} and {} row lengths.",
                d_nnz.len(),
                o_nnz.len()
            )));
        }
        let mat = Mat::empty_aij(session, comm, rows, cols)?;
        let raw = mat.raw();
        petsc!(MatSeqAIJSetPreallocation(raw, 0, d_nnz.as_ptr()))?;
        if comm == Comm::World {
            petsc!(MatMPIAIJSetPreallocation(
                raw,
                0,
                d_nnz.as_ptr(),
                0,
                o_nnz.as_ptr()
            ))?;
        }
        Ok(mat)
    }

    /// Adds a dense block (by rows) at these global rows and columns; [`Mat::assemble`] must follow.
    pub fn add_values(&self, rows: &[PetscInt], cols: &[PetscInt], block: &[f64]) -> Result<()> {
        if rows.len() * cols.len() != block.len() {
            return Err(Error::environment(format!(
                "Internal error: a {} × {} block came with {} values.",
                rows.len(),
                cols.len(),
                block.len()
            )));
        }
        petsc!(MatSetValues(
            self.raw(),
            rows.len() as PetscInt,
            rows.as_ptr(),
            cols.len() as PetscInt,
            cols.as_ptr(),
            block.as_ptr(),
            sys::ADD_VALUES
        ))
    }

    /// Sets all entries of these rows (global numbers of rows of this rank) to zero and keeps the pattern. Collective.
    pub fn zero_rows(&self, rows: &[PetscInt]) -> Result<()> {
        let raw = self.raw();
        petsc!(MatSetOption(
            raw,
            sys::MAT_KEEP_NONZERO_PATTERN,
            Flag::of(true)
        ))?;
        petsc!(MatZeroRows(
            raw,
            count(rows.len())?,
            rows.as_ptr(),
            0.0,
            std::ptr::null_mut(),
            std::ptr::null_mut()
        ))
    }

    /// Sends the values to their owners. Collective.
    pub fn assemble(&self) -> Result<()> {
        petsc!(MatAssemblyBegin(self.raw(), sys::MAT_FINAL_ASSEMBLY))?;
        petsc!(MatAssemblyEnd(self.raw(), sys::MAT_FINAL_ASSEMBLY))
    }

    /// (rows, columns) on this rank.
    pub fn local_size(&self) -> Result<(usize, usize)> {
        let (mut m, mut n) = (0, 0);
        petsc!(MatGetLocalSize(self.raw(), &mut m, &mut n))?;
        Ok((m as usize, n as usize))
    }

    /// (rows, columns) over all ranks.
    pub fn size(&self) -> Result<(usize, usize)> {
        let (mut m, mut n) = (0, 0);
        petsc!(MatGetSize(self.raw(), &mut m, &mut n))?;
        Ok((m as usize, n as usize))
    }

    /// Global numbers of this rank's rows.
    pub fn ownership_range(&self) -> Result<std::ops::Range<usize>> {
        let (mut start, mut end) = (0, 0);
        petsc!(MatGetOwnershipRange(self.raw(), &mut start, &mut end))?;
        Ok(start as usize..end as usize)
    }

    /// y ← A x. Collective.
    ///
    /// # Errors
    /// For a shell, the error of its [`ShellMat::mult`](super::ShellMat::mult).
    pub fn mult(&self, x: &Vec, y: &Vec) -> Result<()> {
        let (x, y) = (x.read()?, y.write()?);
        petsc!(MatMult(self.raw(), x, y))
    }

    /// y ← Aᵀ x. Collective.
    pub fn mult_transpose(&self, x: &Vec, y: &Vec) -> Result<()> {
        let (x, y) = (x.read()?, y.write()?);
        petsc!(MatMultTranspose(self.raw(), x, y))
    }

    /// Global columns and values of a row of this rank.
    pub fn row(&self, row: usize) -> Result<(std::vec::Vec<PetscInt>, std::vec::Vec<f64>)> {
        let (mut n, mut cols, mut vals) = (0, std::ptr::null(), std::ptr::null());
        let row = count(row)?;
        petsc!(MatGetRow(self.raw(), row, &mut n, &mut cols, &mut vals))?;
        // SAFETY: PETSc lends `n` columns and values until they are restored.
        let copy = unsafe { (copied(cols, n), copied(vals, n)) };
        petsc!(MatRestoreRow(self.raw(), row, &mut n, &mut cols, &mut vals))?;
        Ok(copy)
    }

    /// d ← diagonal of A.
    pub fn diagonal(&self, d: &Vec) -> Result<()> {
        let d = d.write()?;
        petsc!(MatGetDiagonal(self.raw(), d))
    }

    /// A vector x with the layout of the columns.
    pub fn right_vec(&self) -> Result<Vec> {
        Vec::made(self.session(), |raw| {
            petsc!(MatCreateVecs(self.raw(), raw, std::ptr::null_mut()))
        })
    }

    /// A vector y with the layout of the rows.
    pub fn left_vec(&self) -> Result<Vec> {
        Vec::made(self.session(), |raw| {
            petsc!(MatCreateVecs(self.raw(), std::ptr::null_mut(), raw))
        })
    }

    /// Tells PETSc what the matrix is.
    pub fn set_flag(&self, flag: MatFlag) -> Result<()> {
        petsc!(MatSetOption(self.raw(), sys::MAT_SYMMETRIC, Flag::of(true)))?;
        petsc!(MatSetOption(
            self.raw(),
            sys::MAT_SYMMETRY_ETERNAL,
            Flag::of(true)
        ))?;
        if flag == MatFlag::Spd {
            petsc!(MatSetOption(self.raw(), sys::MAT_SPD, Flag::of(true)))?;
        }
        Ok(())
    }

    /// Tells PETSc that rows come in blocks of this size; it must divide every rank's number of rows.
    pub fn set_block_size(&self, size: usize) -> Result<()> {
        petsc!(MatSetBlockSize(self.raw(), count(size)?))
    }

    /// Attaches the constants and orthonormal vectors as the near-null space, for multigrid.
    pub fn set_near_null_space(&self, constants: bool, vectors: &[Vec]) -> Result<()> {
        let list: std::vec::Vec<sys::Vec> = vectors.iter().map(Vec::raw).collect();
        // SAFETY: the matrix is alive, so its communicator is.
        let comm = unsafe { sys::PetscObjectComm(self.object()) };
        let space = Handle::made(self.session(), |raw| {
            petsc!(MatNullSpaceCreate(
                comm,
                Flag::of(constants),
                list.len() as PetscInt,
                list.as_ptr(),
                raw
            ))
        })?;
        petsc!(MatSetNearNullSpace(self.raw(), space.raw()))
    }
}

/// A count or index as a 32-bit PETSc integer.
pub(super) fn count(n: usize) -> Result<PetscInt> {
    PetscInt::try_from(n).map_err(|_| {
        Error::input(format!(
            "A matrix of {n} rows or columns exceeds what PETSc with 32-bit indices can number."
        ))
    })
}
