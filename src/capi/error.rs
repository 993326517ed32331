//! Rust errors as C sees them: a status, and a message on request.

use crate::Result;
use base::{ErrorKind, Fault};
use petsc::raw::{self, caught, settle};
use petsc::Session;
use std::cell::RefCell;
use std::ffi::{c_char, c_int, CStr, CString};

/// An error with a message, the same on all ranks.
pub const SENTENCE: c_int = 1;
/// An error about a matrix that cannot be factored, or a load that is no number, with a message, the same on all ranks.
pub const UNFIT: c_int = 2;
/// PETSc has already reported the error.
const RAISED: c_int = 3;
/// An error with a message that this rank has and others may not have.
const ALONE: c_int = 4;

/// PETSC_ERR_NOT_CONVERGED.
const ERR_NOT_CONVERGED: c_int = 91;
/// PETSC_ERR_LIB.
const ERR_LIB: c_int = 76;

thread_local! {
    static LAST: RefCell<(CString, c_int)> = RefCell::default();
}

/// [`classified`] with errors of input taken as [`Fault::Unsupported`].
pub fn status(what: &'static str, body: impl FnOnce(&mut Option<Session>) -> Result<()>) -> c_int {
    classified(what, Fault::Unsupported, body)
}

/// Runs `body` and converts its result to a status. All ranks of the session that it makes or has take part. A panic
/// counts as an error. Errors of input that do not concern an argument are taken as `input`.
pub fn classified(
    what: &'static str,
    input: Fault,
    body: impl FnOnce(&mut Option<Session>) -> Result<()>,
) -> c_int {
    // A host that continues after an error has dealt with it.
    settle();
    let mut session = None;
    let result = caught(what, || body(&mut session));
    let concluded = match &session {
        Some(session) => session.conclude(result),
        None => result.map_err(|error| (error, true)),
    };
    let Err((error, common)) = concluded else {
        return 0;
    };
    let (status, code) = match error.kind() {
        ErrorKind::Petsc(code) => (RAISED, code),
        ErrorKind::Argument(fault) => (SENTENCE, fault as c_int),
        ErrorKind::Input => (SENTENCE, input as c_int),
        ErrorKind::Unfit => (SENTENCE, Fault::Wrong as c_int),
        ErrorKind::NotConverged => (SENTENCE, ERR_NOT_CONVERGED),
        _ => (SENTENCE, ERR_LIB),
    };
    let status = if status == SENTENCE && !common {
        ALONE
    } else {
        status
    };
    let text = error.to_string().replace('\0', " ");
    LAST.set((CString::new(text).unwrap_or_default(), code));
    status
}

/// Keeps a sentence that explains the result of a solve; it is no error.
pub fn remark(text: &str) {
    let text = text.replace('\0', " ");
    LAST.set((CString::new(text).unwrap_or_default(), 0));
}

/// Passes the error of a status of [`status`] to the host's error handler, and returns the PETSc error code. `comm` is
/// given if all its ranks are in the same call, otherwise it is `None`.
pub fn raise(status: c_int, name: &CStr, comm: Option<raw::MPI_Comm>) -> c_int {
    if status == 0 {
        return 0;
    }
    let (text, code) = LAST.with_borrow(|(text, code)| (text.clone(), *code));
    if status == RAISED {
        return code;
    }
    // SAFETY: without arguments.
    let own = unsafe { raw::ff_comm_self() };
    let comm = comm.filter(|_| status != ALONE).unwrap_or(own);
    let file = c"src/capi/error.rs";
    let line = line!() as c_int;
    // SAFETY: strings that live, and a communicator of the caller's.
    unsafe {
        raw::ff_error(
            comm,
            line,
            name.as_ptr(),
            file.as_ptr(),
            code,
            text.as_ptr(),
        )
    }
}

/// The last message, valid until the next one, and its PETSc error code.
///
/// # Safety
/// `code` can be written to.
#[no_mangle]
pub unsafe extern "C" fn fetifeti_plugin_message(code: *mut c_int) -> *const c_char {
    LAST.with_borrow(|(text, number)| {
        // SAFETY: by the caller.
        unsafe { *code = *number };
        text.as_ptr()
    })
}
