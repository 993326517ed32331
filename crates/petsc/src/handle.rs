//! One generic, counted handle for every class of PETSc object.

use super::error::failed;
use super::Session;
use base::Result;
use petsc_sys as sys;

/// A reference to a PETSc object of the struct `T` (`_p_Vec`, `_p_Mat`, …): never null, counted by PETSc, and holding
/// the session so that PETSc is finalised after the last object. Clones are references to the same object.
pub struct Handle<T> {
    raw: *mut T,
    session: Session,
}

impl<T> Handle<T> {
    /// Takes over the one reference that a create routine returned.
    pub(crate) fn own(raw: *mut T, session: &Session) -> Self {
        debug_assert!(!raw.is_null());
        Handle {
            raw,
            session: session.clone(),
        }
    }

    /// The new object whose pointer a create routine writes.
    pub(crate) fn made(
        session: &Session,
        create: impl FnOnce(&mut *mut T) -> Result<()>,
    ) -> Result<Self> {
        let mut raw = std::ptr::null_mut();
        create(&mut raw)?;
        Ok(Handle::own(raw, session))
    }

    /// The object that PETSc lends: its pointer is what `get` writes.
    pub(crate) fn borrowed(
        session: &Session,
        get: impl FnOnce(&mut *mut T) -> Result<()>,
    ) -> Result<Self> {
        let mut raw = std::ptr::null_mut();
        get(&mut raw)?;
        Handle::share(raw, session)
    }

    /// Adds a reference to an object that a host program lends.
    ///
    /// # Safety
    /// `raw` is a live object of this class.
    pub unsafe fn of_host(raw: *mut T, session: &Session) -> Result<Self> {
        Handle::share(raw, session)
    }

    /// Adds a reference to an object that PETSc lent.
    pub(crate) fn share(raw: *mut T, session: &Session) -> Result<Self> {
        petsc!(PetscObjectReference(raw as sys::PetscObject))?;
        Ok(Handle::own(raw, session))
    }

    /// The pointer for PETSc's functions of this class.
    pub fn raw(&self) -> *mut T {
        self.raw
    }

    /// The pointer for functions that take any object.
    pub(crate) fn object(&self) -> sys::PetscObject {
        self.raw as sys::PetscObject
    }

    pub(crate) fn session(&self) -> &Session {
        &self.session
    }

    fn is_parallel(&self) -> bool {
        let mut size = 1;
        // SAFETY: the object is alive, so its communicator is.
        unsafe { mpi::ffi::MPI_Comm_size(sys::PetscObjectComm(self.object()), &mut size) };
        size > 1
    }
}

impl<T> Clone for Handle<T> {
    fn clone(&self) -> Self {
        Handle::share(self.raw, &self.session).expect("a live object can be referenced")
    }
}

impl<T> Drop for Handle<T> {
    fn drop(&mut self) {
        // Destroying is collective. After a failure that the other ranks have not heard of they are elsewhere, and
        // waiting for them would hang the run that is about to be ended; leaking the object is the lesser evil.
        if (failed() || std::thread::panicking()) && self.is_parallel() {
            return;
        }
        let mut object = self.object();
        // SAFETY: this handle owns one reference. The code is dropped: there is nobody to hand an error to
        // (an object that a failed call left half-way may refuse to be destroyed).
        unsafe { sys::PetscObjectDestroy(&mut object) };
    }
}
