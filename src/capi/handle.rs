//! The object behind a C `FetiFeti`: checks of the arguments from C, and a common guard for all functions.

use super::error::{classified, raise};
use super::object::Object;
use crate::Result;
use base::Fault;
use petsc::{raw, Session};
use std::ffi::{c_int, CStr};

/// The object that a `FetiFeti` points to.
pub struct HandleObject {
    magic: u64,
    comm: raw::MPI_Comm,
    object: Object,
}

impl HandleObject {
    /// An object on the ranks of `comm`.
    pub fn new(comm: raw::MPI_Comm, session: Session) -> HandleObject {
        HandleObject {
            magic: MAGIC,
            comm,
            object: Object::new(session),
        }
    }
}

/// Distinguishes valid objects from other memory.
const MAGIC: u64 = 0x4645_5449_4645_5449;

/// The pointer that C calls `FetiFeti`.
pub(super) type HandlePointer = *mut HandleObject;

fn held<'a>(ff: HandlePointer) -> Result<&'a mut HandleObject> {
    let none = || Fault::Null.error("the FetiFeti is NULL, expected one from FetiFetiCreate");
    // SAFETY: the header asks for NULL or an object of FetiFetiCreate.
    let held = unsafe { ff.as_mut() }.ok_or_else(none)?;
    if held.magic != MAGIC {
        return Err(Fault::Corrupt.error("the FetiFeti is not one that FetiFetiCreate made"));
    }
    Ok(held)
}

/// Destroys an object.
pub(super) fn destroy(ff: HandlePointer) -> Result<()> {
    held(ff)?.magic = 0;
    // SAFETY: from Box::into_raw in FetiFetiCreate; whoever calls this forgets it.
    drop(unsafe { Box::from_raw(ff) });
    Ok(())
}

/// A call in which all ranks of the object take part.
pub(super) fn together(
    ff: HandlePointer,
    name: &'static CStr,
    work: impl FnOnce(&mut Object) -> Result<()>,
) -> c_int {
    let comm = held(ff).ok().map(|h| h.comm);
    let code = classified("fetifeti.h", Fault::Wrong, |at_work| {
        let object = &mut held(ff)?.object;
        *at_work = Some(object.session.clone());
        work(object)
    });
    raise(code, name, comm)
}

/// A call that each rank makes for itself.
pub(super) fn alone(
    ff: HandlePointer,
    name: &'static CStr,
    work: impl FnOnce(&mut Object) -> Result<()>,
) -> c_int {
    let code = classified("fetifeti.h", Fault::Wrong, |_| work(&mut held(ff)?.object));
    raise(code, name, None)
}

/// A C array as a slice.
pub(super) fn array<'a, T>(data: *const T, n: c_int, what: &str) -> Result<&'a [T]> {
    let n = usize::try_from(n).map_err(|_| {
        Fault::OutOfRange.error(format!("the length of {what} is {n}, expected at least 0"))
    })?;
    if n == 0 {
        return Ok(&[]);
    }
    if data.is_null() {
        return Err(Fault::Null.error(format!("{what} is NULL, expected an array of {n} entries")));
    }
    // SAFETY: the header asks for this length.
    Ok(unsafe { std::slice::from_raw_parts(data, n) })
}

pub(super) fn put<T>(to: *mut T, value: T) {
    if !to.is_null() {
        // SAFETY: NULL, or a place for the value.
        unsafe { to.write(value) }
    }
}

pub(super) fn not_null<T>(object: *mut T, what: &str) -> Result<*mut T> {
    if object.is_null() {
        Err(Fault::Null.error(format!("the {what} is NULL, expected one")))
    } else {
        Ok(object)
    }
}

/// Checks the row pointers of a CSR array; returns the number of entries.
pub(super) fn starts(ia: &[c_int]) -> Result<usize> {
    let bad = ia.windows(2).position(|w| w[1] < w[0]);
    match (ia.first(), bad) {
        (Some(&first), _) if first != 0 => {
            Err(Fault::Wrong.error(format!("the row pointers begin with {first}, expected 0")))
        }
        (_, Some(row)) => Err(Fault::Wrong.error(format!(
            "the row pointers fall from {} to {} at row {row}, expected increasing ones",
            ia[row],
            ia[row + 1]
        ))),
        _ => Ok(ia.last().map_or(0, |&n| n as usize)),
    }
}

/// The numbers of an index set; empty for NULL.
pub fn list(o: &Object, is: raw::IS) -> Result<Vec<i32>> {
    if is.is_null() {
        Ok(Vec::new())
    } else {
        lent(is, &o.session)?.indices()
    }
}

/// A reference to an object that the host lends for the time of the call, as fetifeti.h says.
pub(super) fn lent<T>(raw: *mut T, session: &Session) -> Result<petsc::Handle<T>> {
    // SAFETY: the host hands over a live object of this class.
    unsafe { petsc::Handle::of_host(raw, session) }
}
