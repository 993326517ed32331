//! Vectors.

use super::error::{c_string, got};
use super::handle::Handle;
use super::{Comm, Session};
use base::{Error, Result};
use petsc_sys as sys;
use petsc_sys::PetscInt;
use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::{Deref, DerefMut};
use std::path::Path;

thread_local! {
    /// The borrow state of vectors whose entries are lent out: the number of readers, or -1 for one writer.
    ///
    /// Handles are shared and PETSc writes through them: the borrow rules are therefore checked at run time, as in a
    /// `RefCell`.
    static LENT: RefCell<HashMap<usize, isize>> = RefCell::default();
}

/// A vector of real numbers, distributed over the ranks of a session or of this rank alone.
///
/// Clones are handles to the same vector; [`Vec::duplicate`] makes a new one. Methods that write take `&self`, as PETSc
/// does. While entries are lent out by [`Vec::array`] nothing may write to the vector, and while they are lent out by
/// [`Vec::array_mut`] nothing may use it: such calls return an error.
pub type Vec = Handle<sys::_p_Vec>;

impl Vec {
    /// A zero vector with `local` entries on this rank.
    pub fn new(session: &Session, comm: Comm, local: usize) -> Result<Vec> {
        Vec::sized(session, comm, count(local)?, sys::PETSC_DETERMINE)
    }

    /// A zero vector over all ranks with `local` entries on this one.
    pub fn mpi(session: &Session, local: usize) -> Result<Vec> {
        Vec::new(session, Comm::World, local)
    }

    /// A zero vector of this rank alone.
    pub fn seq(session: &Session, n: usize) -> Result<Vec> {
        Vec::new(session, Comm::Own, n)
    }

    /// A zero vector over all ranks with `global` entries, spread evenly by PETSc.
    pub fn with_global_len(session: &Session, global: usize) -> Result<Vec> {
        Vec::sized(session, Comm::World, sys::PETSC_DECIDE, count(global)?)
    }

    /// A zero vector over all ranks with these numbers of entries; PETSc chooses a number that is not given.
    /// Collective.
    pub fn over_ranks(
        session: &Session,
        local: Option<usize>,
        global: Option<usize>,
    ) -> Result<Vec> {
        let local = local.map_or(Ok(sys::PETSC_DECIDE), count)?;
        let global = global.map_or(Ok(sys::PETSC_DETERMINE), count)?;
        Vec::sized(session, Comm::World, local, global)
    }

    /// A vector of this rank alone with these entries.
    pub fn from_slice(session: &Session, entries: &[f64]) -> Result<Vec> {
        let vec = Vec::seq(session, entries.len())?;
        vec.array_mut()?.copy_from_slice(entries);
        Ok(vec)
    }

    fn sized(session: &Session, comm: Comm, local: PetscInt, global: PetscInt) -> Result<Vec> {
        let vec = Vec::made(session, |raw| {
            petsc!(VecCreate(session.raw_comm(comm), raw))
        })?;
        let raw = vec.raw();
        petsc!(VecSetSizes(raw, local, global))?;
        let kind = match comm {
            Comm::World => c"standard",
            Comm::Own => c"seq",
        };
        petsc!(VecSetType(raw, kind.as_ptr()))?;
        petsc!(VecSet(raw, 0.0))?;
        Ok(vec)
    }

    /// The pointer for a call that reads the entries.
    pub(crate) fn read(&self) -> Result<sys::Vec> {
        match self.lent() {
            -1 => Err(lent_out("read")),
            _ => Ok(self.raw()),
        }
    }

    /// The pointer for a call that writes the entries.
    pub(crate) fn write(&self) -> Result<sys::Vec> {
        match self.lent() {
            0 => Ok(self.raw()),
            _ => Err(lent_out("written")),
        }
    }

    fn lent(&self) -> isize {
        LENT.with_borrow(|lent| lent.get(&(self.raw() as usize)).copied().unwrap_or(0))
    }

    fn lend(&self, change: isize) {
        let key = self.raw() as usize;
        LENT.with_borrow_mut(|lent| {
            let now = lent.get(&key).copied().unwrap_or(0) + change;
            if now == 0 {
                lent.remove(&key);
            } else {
                lent.insert(key, now);
            }
        });
    }

    /// Number of entries on this rank.
    pub fn local_len(&self) -> usize {
        let mut n = 0;
        // SAFETY: the vector is alive and has its sizes; the call cannot fail then.
        unsafe { sys::VecGetLocalSize(self.raw(), &mut n) };
        n as usize
    }

    /// Number of entries over all ranks.
    pub fn global_len(&self) -> usize {
        let mut n = 0;
        // SAFETY: as above.
        unsafe { sys::VecGetSize(self.raw(), &mut n) };
        n as usize
    }

    /// Global numbers of this rank's entries.
    pub fn ownership_range(&self) -> std::ops::Range<usize> {
        let (mut start, mut end) = (0, 0);
        // SAFETY: as above.
        unsafe { sys::VecGetOwnershipRange(self.raw(), &mut start, &mut end) };
        start as usize..end as usize
    }

    /// This rank's entries, for reading.
    pub fn array(&self) -> Result<Array> {
        let raw = self.read()?;
        let mut data = std::ptr::null();
        petsc!(VecGetArrayRead(raw, &mut data))?;
        self.lend(1);
        Ok(Array {
            vec: self.clone(),
            data,
            len: self.local_len(),
        })
    }

    /// This rank's entries, for writing.
    pub fn array_mut(&self) -> Result<ArrayMut> {
        let raw = self.write()?;
        let mut data = std::ptr::null_mut();
        petsc!(VecGetArray(raw, &mut data))?;
        self.lend(-1);
        Ok(ArrayMut {
            vec: self.clone(),
            data,
            len: self.local_len(),
        })
    }

    /// A copy of this rank's entries.
    pub fn to_vec(&self) -> Result<std::vec::Vec<f64>> {
        Ok(self.array()?.to_vec())
    }

    /// A new zero vector of the same kind and sizes.
    pub fn duplicate(&self) -> Result<Vec> {
        let copy = Vec::made(self.session(), |raw| petsc!(VecDuplicate(self.raw(), raw)))?;
        petsc!(VecSet(copy.raw(), 0.0))?;
        Ok(copy)
    }

    /// self ← value in every entry.
    pub fn set(&self, value: f64) -> Result<()> {
        let y = self.write()?;
        petsc!(VecSet(y, value))
    }

    /// self ← x.
    pub fn copy_from(&self, x: &Vec) -> Result<()> {
        let (x, y) = (x.read()?, self.write()?);
        petsc!(VecCopy(x, y))
    }

    /// self ← self + a x.
    pub fn axpy(&self, a: f64, x: &Vec) -> Result<()> {
        let (x, y) = (x.read()?, self.write()?);
        petsc!(VecAXPY(y, a, x))
    }

    /// self ← a self + x.
    pub fn aypx(&self, a: f64, x: &Vec) -> Result<()> {
        let (x, y) = (x.read()?, self.write()?);
        petsc!(VecAYPX(y, a, x))
    }

    /// self ← a self.
    pub fn scale(&self, a: f64) -> Result<()> {
        let y = self.write()?;
        petsc!(VecScale(y, a))
    }

    /// selfᵀ x. Collective.
    pub fn dot(&self, x: &Vec) -> Result<f64> {
        let (a, b) = (self.read()?, x.read()?);
        got(|value| petsc!(VecDot(a, b, value)))
    }

    /// Sum of all entries. Collective.
    pub fn sum(&self) -> Result<f64> {
        let x = self.read()?;
        got(|value| petsc!(VecSum(x, value)))
    }

    /// Euclidean norm. Collective.
    pub fn norm2(&self) -> Result<f64> {
        self.norm(sys::NORM_2)
    }

    /// Largest magnitude. Collective.
    pub fn norm_inf(&self) -> Result<f64> {
        self.norm(sys::NORM_INFINITY)
    }

    fn norm(&self, kind: sys::NormType) -> Result<f64> {
        let x = self.read()?;
        got(|value| petsc!(VecNorm(x, kind, value)))
    }

    /// self_i ← x_i y_i.
    pub fn pointwise_mult(&self, x: &Vec, y: &Vec) -> Result<()> {
        let (x, y, w) = (x.read()?, y.read()?, self.write()?);
        petsc!(VecPointwiseMult(w, x, y))
    }

    /// self_i ← x_i / y_i, and 0 where y_i = 0. What 0 / 0 is in VecPointwiseDivide depends on the version of PETSc.
    pub fn pointwise_divide(&self, x: &Vec, y: &Vec) -> Result<()> {
        let quotients: std::vec::Vec<f64> = {
            let (x, y) = (x.array()?, y.array()?);
            let pairs = x.iter().zip(y.iter());
            pairs
                .map(|(x, y)| if *y == 0.0 { 0.0 } else { x / y })
                .collect()
        };
        self.array_mut()?.copy_from_slice(&quotients);
        Ok(())
    }

    /// self ← pseudo-random entries in (0, 1), the same in every run with the same number of ranks.
    pub fn set_random(&self) -> Result<()> {
        let y = self.write()?;
        petsc!(VecSetRandom(y, std::ptr::null_mut()))
    }

    /// Writes the vector to a file in PETSc's binary format. Collective.
    pub fn save(&self, path: &Path) -> Result<()> {
        let x = self.read()?;
        let viewer = binary(self, path, sys::FILE_MODE_WRITE)?;
        petsc!(VecView(x, viewer.raw()))
    }

    /// Reads the entries from a file in PETSc's binary format; the lengths must agree. Collective.
    pub fn load(&self, path: &Path) -> Result<()> {
        let x = self.write()?;
        let viewer = binary(self, path, sys::FILE_MODE_READ)?;
        petsc!(VecLoad(x, viewer.raw()))
    }
}

fn binary(vec: &Vec, path: &Path, mode: sys::PetscFileMode) -> Result<Handle<sys::_p_PetscViewer>> {
    // SAFETY: the vector is alive, so its communicator is.
    let comm = unsafe { sys::PetscObjectComm(vec.object()) };
    let name = c_string(&path.display().to_string());
    Handle::made(vec.session(), |raw| {
        petsc!(PetscViewerBinaryOpen(comm, name.as_ptr(), mode, raw))
    })
}

fn count(n: usize) -> Result<PetscInt> {
    PetscInt::try_from(n).map_err(|_| {
        Error::input(format!(
            "A vector of {n} entries exceeds what PETSc with 32-bit indices can number."
        ))
    })
}

fn lent_out(what: &str) -> Error {
    Error::environment(format!(
        "Internal error: a vector was to be {what} while its entries are lent out."
    ))
}

/// The entries of a [`Vec`] on this rank, lent for reading.
pub struct Array {
    vec: Vec,
    data: *const f64,
    len: usize,
}

impl Deref for Array {
    type Target = [f64];
    fn deref(&self) -> &[f64] {
        if self.len == 0 {
            return &[];
        }
        // SAFETY: PETSc lends `len` entries until they are restored in `drop`; the count in LENT keeps writers away.
        unsafe { std::slice::from_raw_parts(self.data, self.len) }
    }
}

impl Drop for Array {
    fn drop(&mut self) {
        self.vec.lend(-1);
        // SAFETY: gives back what VecGetArrayRead lent.
        unsafe { sys::VecRestoreArrayRead(self.vec.raw(), &mut self.data) };
    }
}

/// The entries of a [`Vec`] on this rank, lent for writing.
pub struct ArrayMut {
    vec: Vec,
    data: *mut f64,
    len: usize,
}

impl Deref for ArrayMut {
    type Target = [f64];
    fn deref(&self) -> &[f64] {
        if self.len == 0 {
            return &[];
        }
        // SAFETY: PETSc lends `len` entries until they are restored in `drop`; LENT keeps all others away.
        unsafe { std::slice::from_raw_parts(self.data, self.len) }
    }
}

impl DerefMut for ArrayMut {
    fn deref_mut(&mut self) -> &mut [f64] {
        if self.len == 0 {
            return &mut [];
        }
        // SAFETY: as above, and `&mut self` makes this the only slice.
        unsafe { std::slice::from_raw_parts_mut(self.data, self.len) }
    }
}

impl Drop for ArrayMut {
    fn drop(&mut self) {
        self.vec.lend(1);
        // SAFETY: gives back what VecGetArray lent, and tells PETSc that the entries changed.
        unsafe { sys::VecRestoreArray(self.vec.raw(), &mut self.data) };
    }
}
