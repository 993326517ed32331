//! The functions that create, use and destroy a `FetiFetiStep`.

use std::ffi::{c_char, c_int, CStr};

use base::{Fault, Result};
use fetifeti::inside::c::{self, create, destroy, put, together};
use petsc::raw;
use petsc_sys::{Flag, PetscBool};

use crate::object::Steps;

/// The pointer that C calls `FetiFetiStep`.
pub type Pointer = c::Pointer<Steps>;

/// The name of a file.
pub fn file_name<'a>(name: *const c_char, what: &str) -> Result<&'a [u8]> {
    if name.is_null() {
        return Err(Fault::Null.error(format!("the name of the {what} is NULL, expected one")));
    }
    // SAFETY: the header asks for a string.
    Ok(unsafe { CStr::from_ptr(name) }.to_bytes())
}

#[no_mangle]
unsafe extern "C" fn FetiFetiStepCreate(
    comm: raw::MPI_Comm,
    scene: *const c_char,
    step: *mut Pointer,
) -> c_int {
    match c::processor() {
        0 => new(comm, scene, step),
        code => code,
    }
}

/// Not inlined: whatever it needs stands behind the question for the processor.
#[inline(never)]
fn new(comm: raw::MPI_Comm, scene: *const c_char, step: *mut Pointer) -> c_int {
    // SAFETY: the header asks for a communicator that outlives what is made on it, and for PETSc between its begin and
    // end.
    unsafe {
        create(comm, step, c"FetiFetiStepCreate", |session| {
            Steps::new(session, file_name(scene, "scene")?)
        })
    }
}

#[no_mangle]
unsafe extern "C" fn FetiFetiStepCreateFortran(
    comm: c_int,
    scene: *const c_char,
    step: *mut Pointer,
) -> c_int {
    // SAFETY: the number of a communicator in Fortran.
    unsafe { FetiFetiStepCreate(raw::ff_comm_f2c(comm), scene, step) }
}

#[no_mangle]
unsafe extern "C" fn FetiFetiStepDestroy(step: *mut Pointer) -> c_int {
    // SAFETY: the header asks for NULL, or a pointer to an object or NULL.
    unsafe { destroy(step, c"FetiFetiStepDestroy") }
}

#[no_mangle]
unsafe extern "C" fn FetiFetiStepNext(step: Pointer, solved: *mut PetscBool) -> c_int {
    together(step, c"FetiFetiStepNext", |o| {
        put(solved, PetscBool::of(false));
        let more = o.next()?;
        put(solved, PetscBool::of(more));
        Ok(())
    })
}
