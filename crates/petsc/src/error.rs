//! Errors across the border between Rust and C, in both directions.
//!
//! From C: PETSc's error handler is replaced by one that collects the stack frames, and [`check`] turns an error code
//! into [`ErrorKind::Petsc`](base::ErrorKind::Petsc) with this trace. To C: [`guard`] runs a callback, stores its error
//! or panic in a slot of this thread and returns an error code to PETSc. The outer call finds the slot filled and
//! returns the stored error.

use base::{Error, ErrorKind, Result};
use petsc_sys as sys;
use std::any::Any;
use std::cell::{Cell, RefCell};
use std::ffi::{c_char, c_int, CStr, CString};
use std::panic::{catch_unwind, AssertUnwindSafe};

thread_local! {
    /// The first error of a callback, while PETSc returns its code to the outer call.
    static PENDING: RefCell<Option<Error>> = const { RefCell::new(None) };
    /// PETSc's stack frames for the current error, innermost first.
    static TRACE: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
    /// Whether a call failed on this rank and the other ranks may not know.
    static FAILED: Cell<bool> = const { Cell::new(false) };
}

/// Calls a PETSc function and turns its code into a `Result`.
///
/// The macro contains the `unsafe` of the whole layer in one place. A caller must pass handles that are alive (they
/// come from [`Handle`](super::handle::Handle)s in scope), out-pointers to live locals, and slices of the lengths
/// passed.
macro_rules! petsc {
    ($function:ident ( $($argument:expr),* $(,)? )) => {
        // SAFETY: see the macro's documentation; arguments are valid for the duration of the call.
        $crate::error::check(unsafe { petsc_sys::$function($($argument),*) }, stringify!($function))
    };
}

/// `Ok` for code 0; otherwise the stored error of a callback, or PETSc's own error with its trace.
pub(crate) fn check(code: c_int, call: &'static str) -> Result<()> {
    if code == 0 {
        return Ok(());
    }
    FAILED.set(true);
    let trace = TRACE.take();
    Err(PENDING
        .take()
        .unwrap_or_else(|| Error::petsc(code, call, trace)))
}

/// The error for an option value that PETSc refused while it read the options with `prefix`: a user error in one
/// sentence.
pub(crate) fn refused_option(error: Error, prefix: &str) -> Error {
    match error.trace().first() {
        Some(message) => {
            // PETSc ends some messages with a list or a hint of several lines.
            let reason = message.lines().next().unwrap_or_default();
            Error::input(format!(
                "An option -{prefix}... has no valid value: {reason}"
            ))
        }
        None => error,
    }
}

/// Whether a PETSc call failed on this rank without the other ranks knowing.
pub(crate) fn failed() -> bool {
    FAILED.get()
}

/// Records that all ranks know of the failure: objects may be destroyed collectively again.
pub fn settled() {
    FAILED.set(false);
}

/// Runs a callback for PETSc: a panic does not unwind into C, and the error is stored for the outer call.
pub(crate) fn guard(what: &'static str, body: impl FnOnce() -> Result<()>) -> c_int {
    let error = match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(())) => return 0,
        Ok(Err(error)) => error,
        Err(payload) => panicked(what, payload.as_ref()),
    };
    let code = match error.kind() {
        ErrorKind::Petsc(code) => code,
        _ => sys::PETSC_ERR_LIB,
    };
    let message = c_string(&error.to_string());
    let function = c_string(what);
    // SAFETY: the strings live until the call returns; PetscError copies what it keeps.
    let code = unsafe {
        sys::ff_error(
            sys::ff_comm_self(),
            line!() as c_int,
            function.as_ptr(),
            c"callback".as_ptr(),
            code,
            message.as_ptr(),
        )
    };
    // The slot is filled after ff_error, since every new error empties it.
    PENDING.set(Some(error));
    code
}

/// Runs `body` for C; a panic becomes an error.
pub fn caught(what: &'static str, body: impl FnOnce() -> Result<()>) -> Result<()> {
    catch_unwind(AssertUnwindSafe(body))
        .unwrap_or_else(|payload| Err(panicked(what, payload.as_ref())))
}

/// Converts a panic to an error.
pub(crate) fn panicked(what: &str, payload: &(dyn Any + Send)) -> Error {
    let text = payload
        .downcast_ref::<&str>()
        .map(|s| s.to_string())
        .or_else(|| payload.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "no message".into());
    Error::environment(format!("Internal error: {what} panicked: {text}"))
}

/// A C string; a NUL inside the text ends it, which only shortens a message or a name.
pub(crate) fn c_string(text: &str) -> CString {
    let end = text.find('\0').unwrap_or(text.len());
    CString::new(&text[..end]).expect("the text was cut before its first NUL")
}

/// A Rust string from PETSc's, empty for NULL.
pub(crate) fn rust_string(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: PETSc hands out NUL-terminated strings that live at least until the next call.
    unsafe { CStr::from_ptr(text) }
        .to_string_lossy()
        .into_owned()
}

/// The number that a call writes.
pub(super) fn got<T: Default>(call: impl FnOnce(&mut T) -> Result<()>) -> Result<T> {
    let mut value = T::default();
    call(&mut value)?;
    Ok(value)
}

/// The text whose pointer a call writes; empty for NULL.
pub fn text(call: impl FnOnce(&mut *const c_char) -> Result<()>) -> Result<String> {
    let mut text = std::ptr::null();
    call(&mut text)?;
    Ok(rust_string(text))
}

/// A copy of an array that PETSc lends.
///
/// # Safety
/// `data` has `n` entries, or `n` is zero.
pub(super) unsafe fn copied<T: Clone>(data: *const T, n: sys::PetscInt) -> Vec<T> {
    if n == 0 {
        return Vec::new();
    }
    // SAFETY: by the caller.
    unsafe { std::slice::from_raw_parts(data, n as usize) }.to_vec()
}

/// Collects the frames of PETSc's errors on this thread instead of letting PETSc print them.
pub(crate) fn collect_traces() -> Result<()> {
    petsc!(ff_push_error_handler(Some(frame)))
}

/// One frame of an error: the first carries the message.
unsafe extern "C" fn frame(
    line: c_int,
    function: *const c_char,
    file: *const c_char,
    _code: c_int,
    initial: c_int,
    message: *const c_char,
) {
    let entry = format!(
        "{}() at {}:{line}",
        rust_string(function),
        rust_string(file)
    );
    // `try_with`: an error during thread exit has nowhere to go and must not panic here.
    let _ = TRACE.try_with(|trace| {
        if let Ok(mut trace) = trace.try_borrow_mut() {
            if initial != 0 {
                // A callback's error that PETSc swallowed must not be taken for the cause of this one.
                let _ = PENDING.try_with(|slot| slot.take());
                trace.clear();
                trace.push(rust_string(message).trim_end().to_string());
            }
            trace.push(entry);
        }
    });
}
