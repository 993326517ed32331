//! The functions of `wrappers/fetifeti.h` that create, set up, use and destroy a solver; their manual pages are there.

use super::handle::{alone, create, destroy, lent, not_null, together, HandlePointer};
use super::monitor::{Function, Monitor};
use super::object::Object;
use crate::Result;
use petsc::raw;
use std::ffi::{c_char, c_int, c_void, CStr};

#[no_mangle]
pub unsafe extern "C" fn FetiFetiCreate(comm: raw::MPI_Comm, ff: *mut HandlePointer) -> c_int {
    match super::processor() {
        0 => new(comm, ff),
        code => code,
    }
}

/// Not inlined: whatever it needs stands behind the question for the processor.
#[inline(never)]
fn new(comm: raw::MPI_Comm, ff: *mut HandlePointer) -> c_int {
    // SAFETY: the header asks for a communicator that outlives what is made on it, and for PETSc between its begin and
    // end.
    unsafe {
        create(comm, ff, c"FetiFetiCreate", |session| {
            Ok(Object::new(session))
        })
    }
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiCreateFortran(comm: c_int, ff: *mut HandlePointer) -> c_int {
    // SAFETY: the number of a communicator in Fortran.
    unsafe { FetiFetiCreate(raw::ff_comm_f2c(comm), ff) }
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiDestroy(ff: *mut HandlePointer) -> c_int {
    // SAFETY: the header asks for NULL, or a pointer to an object or NULL.
    unsafe { destroy(ff, c"FetiFetiDestroy") }
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiReset(ff: HandlePointer) -> c_int {
    together(ff, c"FetiFetiReset", |o| {
        let mut fresh = Object::new(o.session.clone());
        fresh.prefix = std::mem::take(&mut o.prefix);
        (fresh.bodies, fresh.view, fresh.monitor) = (o.bodies, o.view, o.monitor);
        *o = fresh;
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiSetOptionsPrefix(
    ff: HandlePointer,
    prefix: *const c_char,
) -> c_int {
    alone(ff, c"FetiFetiSetOptionsPrefix", |o| {
        o.prefix = if prefix.is_null() {
            String::new()
        } else {
            // SAFETY: a string.
            unsafe { CStr::from_ptr(prefix) }.to_string_lossy().into()
        };
        o.changed.whole = true;
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiSetFromOptions(ff: HandlePointer) -> c_int {
    together(ff, c"FetiFetiSetFromOptions", Object::set_from_options)
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiView(ff: HandlePointer, viewer: raw::PetscViewer) -> c_int {
    together(ff, c"FetiFetiView", |o| show(o, viewer))
}

fn show(o: &Object, viewer: raw::PetscViewer) -> Result<()> {
    if viewer.is_null() {
        o.print();
        return Ok(());
    }
    // SAFETY: the host hands over a live viewer (fetifeti.h).
    unsafe { raw::show(viewer, &o.text()) }
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiSetUp(ff: HandlePointer) -> c_int {
    together(ff, c"FetiFetiSetUp", Object::set_up)
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiSolve(ff: HandlePointer, b: raw::Vec, x: raw::Vec) -> c_int {
    together(ff, c"FetiFetiSolve", |o| {
        let b = lent(not_null(b, "right-hand side")?, &o.session)?;
        let x = lent(not_null(x, "solution")?, &o.session)?;
        o.solve(&b, &x)
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiContactMonitorSet(
    ff: HandlePointer,
    function: Option<Function>,
    context: *mut c_void,
) -> c_int {
    alone(ff, c"FetiFetiContactMonitorSet", |o| {
        o.monitor = function.map(|function| Monitor::new(function, context));
        Ok(())
    })
}
