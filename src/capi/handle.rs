//! The objects behind handles of C: checks of the arguments from C, and a common guard for all functions. The library
//! of load steps (`wrappers/step`) has its handles from here, too.

use super::error::{classified, raise};
use super::object::Object;
use crate::Result;
use base::Fault;
use petsc::{raw, PetscInt, Session};
use std::ffi::{c_int, CStr};
use std::ptr::null_mut;

/// The data behind a class of handles.
pub trait Held {
    /// The name of the class in C; `CLASSCreate` makes its objects.
    const CLASS: &'static str;
    /// Distinguishes valid objects from other memory.
    const MAGIC: u64;

    /// The session on the ranks of the object.
    fn session(&self) -> &Session;
}

impl Held for Object {
    const CLASS: &'static str = "FetiFeti";
    const MAGIC: u64 = 0x4645_5449_4645_5449;

    fn session(&self) -> &Session {
        &self.session
    }
}

/// The object that a handle points to.
pub struct HandleObject<T> {
    magic: u64,
    comm: raw::MPI_Comm,
    object: T,
}

/// A handle of C.
pub type Pointer<T> = *mut HandleObject<T>;

/// The pointer that C calls `FetiFeti`.
pub(super) type HandlePointer = Pointer<Object>;

/// Puts a handle of an object on the ranks of `comm` to `to`. Collective.
///
/// # Safety
/// `comm` outlives the object, PETSc is between its begin and end, and `to` is NULL or a place for the handle.
pub unsafe fn create<T: Held>(
    comm: raw::MPI_Comm,
    to: *mut Pointer<T>,
    name: &'static CStr,
    make: impl FnOnce(Session) -> Result<T>,
) -> c_int {
    let code = classified(T::CLASS, Fault::Wrong, |at_work| {
        // SAFETY: by the caller.
        let session = unsafe { Session::borrowed(comm) }?;
        *at_work = Some(session.clone());
        if to.is_null() {
            let class = T::CLASS;
            return Err(Fault::Null.error(format!(
                "there is no place for the {class}, expected a pointer to one"
            )));
        }
        let object = HandleObject {
            magic: T::MAGIC,
            comm,
            object: make(session)?,
        };
        put(to, Box::into_raw(Box::new(object)));
        Ok(())
    });
    raise(code, name, Some(comm))
}

fn held<'a, T: Held>(handle: Pointer<T>) -> Result<&'a mut HandleObject<T>> {
    let class = T::CLASS;
    let none = || {
        let what = format!("the {class} is NULL, expected one from {class}Create");
        Fault::Null.error(what)
    };
    // SAFETY: the headers ask for NULL or an object of the class.
    let held = unsafe { handle.as_mut() }.ok_or_else(none)?;
    if held.magic != T::MAGIC {
        let what = format!("the {class} is not one that {class}Create made");
        return Err(Fault::Corrupt.error(what));
    }
    Ok(held)
}

/// Destroys the object of a handle, which becomes NULL.
///
/// # Safety
/// `at` is NULL, or a pointer to NULL or a handle.
pub unsafe fn destroy<T: Held>(at: *mut Pointer<T>, name: &'static CStr) -> c_int {
    // SAFETY: by the caller.
    if at.is_null() || unsafe { *at }.is_null() {
        return 0;
    }
    // SAFETY: not NULL.
    let handle = unsafe { *at };
    let code = classified(T::CLASS, Fault::Wrong, |_| {
        held(handle)?.magic = 0;
        // SAFETY: from Box::into_raw in `create`; whoever calls this forgets it.
        drop(unsafe { Box::from_raw(handle) });
        put(at, null_mut());
        Ok(())
    });
    raise(code, name, None)
}

/// A call in which all ranks of the object take part.
pub fn together<T: Held>(
    handle: Pointer<T>,
    name: &'static CStr,
    work: impl FnOnce(&mut T) -> Result<()>,
) -> c_int {
    let comm = held(handle).ok().map(|h| h.comm);
    let code = classified(T::CLASS, Fault::Wrong, |at_work| {
        let object = &mut held(handle)?.object;
        *at_work = Some(object.session().clone());
        work(object)
    });
    raise(code, name, comm)
}

/// A call that each rank makes for itself.
pub fn alone<T: Held>(
    handle: Pointer<T>,
    name: &'static CStr,
    work: impl FnOnce(&mut T) -> Result<()>,
) -> c_int {
    let code = classified(T::CLASS, Fault::Wrong, |_| work(&mut held(handle)?.object));
    raise(code, name, None)
}

/// A C array as a slice.
pub(super) fn array<'a, T>(data: *const T, n: PetscInt, what: &str) -> Result<&'a [T]> {
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

/// A C array as a slice; `None` for NULL.
pub(super) fn optional<'a, T>(data: *const T, n: PetscInt, what: &str) -> Result<Option<&'a [T]>> {
    if data.is_null() {
        return Ok(None);
    }
    array(data, n, what).map(Some)
}

/// Puts a result to its place, unless the caller does not want it.
#[allow(clippy::not_unsafe_ptr_arg_deref)] // the headers ask for NULL or a place
pub fn put<T>(to: *mut T, value: T) {
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
pub(super) fn starts(ia: &[PetscInt]) -> Result<usize> {
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
pub fn list(o: &Object, is: raw::IS) -> Result<Vec<PetscInt>> {
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
