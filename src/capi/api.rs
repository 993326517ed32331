//! The functions of `wrappers/fetifeti.h` that take what a program says, and solve; their manual pages are there. Those that answer are in
//! [`results`](super::results).
//!
//! Each takes what C hands over, checks it, and gives it to an `Object`. Errors go to PETSc's error handler as one sentence.
#![allow(clippy::missing_safety_doc)] // the header says what each function needs

use super::error::{raise, status};
use super::object::{indices, Coordinates, Given, Object};
use crate::embed::torn::spanned;
use crate::embed::GivenRow;
use crate::petsc::{raw, Attached, Is, Mat, Session, Vec as PetscVec};
use crate::sparse::Csr;
use crate::substructures::RowKind;
use crate::{Error, Result};
use std::ffi::{c_char, c_int, CStr};

/// What a `FetiFeti` points to.
pub struct Held {
    magic: u64,
    comm: raw::MPI_Comm,
    object: Object,
}

/// Tells objects from other memory.
const MAGIC: u64 = 0x4645_5449_4645_5449;

/// What C calls a `FetiFeti`.
pub(super) type Handle = *mut Held;

fn held<'a>(ff: Handle) -> Result<&'a mut Held> {
    let none = || Error::input("the FetiFeti is NULL, expected one from FetiFetiCreate");
    // SAFETY: the header asks for NULL or an object of FetiFetiCreate.
    let held = unsafe { ff.as_mut() }.ok_or_else(none)?;
    if held.magic != MAGIC {
        return Err(Error::input(
            "the FetiFeti is not one that FetiFetiCreate made",
        ));
    }
    Ok(held)
}

/// A call in which all ranks of the object are.
pub(super) fn together(
    ff: Handle,
    name: &'static CStr,
    work: impl FnOnce(&mut Object) -> Result<()>,
) -> c_int {
    let comm = held(ff).ok().map(|h| h.comm);
    let code = status("fetifeti.h", |at_work| {
        let object = &mut held(ff)?.object;
        *at_work = Some(object.session.clone());
        work(object)
    });
    raise(code, name, comm)
}

/// A call that ranks make for themselves.
pub(super) fn alone(
    ff: Handle,
    name: &'static CStr,
    work: impl FnOnce(&mut Object) -> Result<()>,
) -> c_int {
    let code = status("fetifeti.h", |_| work(&mut held(ff)?.object));
    raise(code, name, None)
}

/// An array of C.
fn array<'a, T>(data: *const T, n: c_int, what: &str) -> Result<&'a [T]> {
    let n = usize::try_from(n)
        .map_err(|_| Error::input(format!("the length of {what} is {n}, expected at least 0")))?;
    if n == 0 {
        return Ok(&[]);
    }
    if data.is_null() {
        return Err(Error::input(format!(
            "{what} is NULL, expected an array of {n} entries"
        )));
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

/// Row pointers of a CSR array, and how many entries they stand for.
fn starts(ia: &[c_int]) -> Result<usize> {
    let bad = ia.windows(2).position(|w| w[1] < w[0]);
    match (ia.first(), bad) {
        (Some(&first), _) if first != 0 => Err(Error::input(format!(
            "the row pointers begin with {first}, expected 0"
        ))),
        (_, Some(row)) => Err(Error::input(format!(
            "the row pointers fall from {} to {} at row {row}, expected increasing ones",
            ia[row],
            ia[row + 1]
        ))),
        _ => Ok(ia.last().map_or(0, |&n| n as usize)),
    }
}

#[no_mangle]
#[allow(missing_docs)]
pub unsafe extern "C" fn FetiFetiCreate(comm: raw::MPI_Comm, ff: *mut Handle) -> c_int {
    let code = status("FetiFetiCreate", |at_work| {
        let session = Session::borrowed(comm)?;
        *at_work = Some(session.clone());
        if ff.is_null() {
            return Err(Error::input(
                "there is no place for the FetiFeti, expected a pointer to one",
            ));
        }
        let held = Held {
            magic: MAGIC,
            comm,
            object: Object::new(session),
        };
        put(ff, Box::into_raw(Box::new(held)));
        Ok(())
    });
    raise(code, c"FetiFetiCreate", Some(comm))
}

#[no_mangle]
#[allow(missing_docs)]
pub unsafe extern "C" fn FetiFetiCreateFortran(comm: c_int, ff: *mut Handle) -> c_int {
    // SAFETY: the number of a communicator in Fortran.
    unsafe { FetiFetiCreate(raw::ff_comm_f2c(comm), ff) }
}

#[no_mangle]
#[allow(missing_docs)]
pub unsafe extern "C" fn FetiFetiDestroy(ff: *mut Handle) -> c_int {
    if ff.is_null() || unsafe { *ff }.is_null() {
        return 0;
    }
    // SAFETY: not NULL.
    let handle = unsafe { *ff };
    let code = status("FetiFetiDestroy", |_| {
        held(handle)?.magic = 0;
        // SAFETY: from Box::into_raw in FetiFetiCreate, and forgotten below.
        drop(unsafe { Box::from_raw(handle) });
        put(ff, std::ptr::null_mut());
        Ok(())
    });
    raise(code, c"FetiFetiDestroy", None)
}

#[no_mangle]
#[allow(missing_docs)]
pub unsafe extern "C" fn FetiFetiReset(ff: Handle) -> c_int {
    together(ff, c"FetiFetiReset", |o| {
        let mut fresh = Object::new(o.session.clone());
        fresh.prefix = std::mem::take(&mut o.prefix);
        (fresh.bodies, fresh.view) = (o.bodies, o.view);
        *o = fresh;
        Ok(())
    })
}

#[no_mangle]
#[allow(missing_docs)]
pub unsafe extern "C" fn FetiFetiSetOptionsPrefix(ff: Handle, prefix: *const c_char) -> c_int {
    alone(ff, c"FetiFetiSetOptionsPrefix", |o| {
        o.prefix = match prefix.is_null() {
            true => String::new(),
            // SAFETY: a string.
            false => unsafe { CStr::from_ptr(prefix) }.to_string_lossy().into(),
        };
        o.stale = true;
        Ok(())
    })
}

#[no_mangle]
#[allow(missing_docs)]
pub unsafe extern "C" fn FetiFetiSetFromOptions(ff: Handle) -> c_int {
    together(ff, c"FetiFetiSetFromOptions", Object::set_from_options)
}

#[no_mangle]
#[allow(missing_docs)]
pub unsafe extern "C" fn FetiFetiView(ff: Handle, viewer: raw::PetscViewer) -> c_int {
    together(ff, c"FetiFetiView", |o| show(o, viewer))
}

fn show(o: &Object, viewer: raw::PetscViewer) -> Result<()> {
    if viewer.is_null() {
        o.print();
        return Ok(());
    }
    raw::show(viewer, &o.text())
}

#[no_mangle]
#[allow(missing_docs)]
pub unsafe extern "C" fn FetiFetiSetSizes(ff: Handle, local: c_int, global: c_int) -> c_int {
    alone(ff, c"FetiFetiSetSizes", |o| {
        // PETSC_DECIDE and PETSC_DETERMINE are negative.
        let size = |n: c_int| usize::try_from(n).ok();
        if size(local).is_none() && size(global).is_none() {
            return Err(Error::input(
                "neither the local nor the global number of unknowns was given, expected one of them",
            ));
        }
        o.sizes = Some((size(local), size(global)));
        o.stale = true;
        Ok(())
    })
}

#[no_mangle]
#[allow(missing_docs)]
pub unsafe extern "C" fn FetiFetiSetBlockSize(ff: Handle, bs: c_int) -> c_int {
    alone(ff, c"FetiFetiSetBlockSize", |o| {
        if bs < 1 {
            return Err(Error::input(format!(
                "the block size is {bs}, expected at least 1"
            )));
        }
        o.block_size = bs as usize;
        o.stale = true;
        Ok(())
    })
}

#[no_mangle]
#[allow(missing_docs)]
pub unsafe extern "C" fn FetiFetiAddSubdomain(
    ff: Handle,
    body: c_int,
    n: c_int,
    ia: *const c_int,
    ja: *const c_int,
    a: *const f64,
    dofs: *const c_int,
) -> c_int {
    alone(ff, c"FetiFetiAddSubdomain", |o| {
        let dofs = array(dofs, n, "dofs")?.to_vec();
        let ia = array(ia, n.saturating_add(1), "ia")?;
        let nnz = starts(ia)? as c_int;
        let (ja, a) = (array(ja, nnz, "ja")?, array(a, nnz, "a")?);
        let mut triplets = Vec::with_capacity(nnz as usize);
        for (row, range) in ia.windows(2).enumerate() {
            let range = range[0] as usize..range[1] as usize;
            for (&j, &v) in ja[range.clone()].iter().zip(&a[range]) {
                if !(0..n).contains(&j) {
                    return Err(Error::input(format!(
                        "row {row} of the subdomain has an entry in column {j}, expected columns from 0 to below {n}"
                    )));
                }
                if !v.is_finite() {
                    return Err(Error::input(format!(
                        "row {row} of the subdomain has the entry {v}, expected a finite number"
                    )));
                }
                triplets.push((row as u32, j as u32, v));
            }
        }
        let k = Csr::from_triplets(n as usize, &triplets);
        if n > 0 {
            o.subdomains.push(Given { k, dofs, body });
        }
        o.stale = true;
        Ok(())
    })
}

#[no_mangle]
#[allow(missing_docs)]
pub unsafe extern "C" fn FetiFetiSetMatIS(ff: Handle, a: raw::Mat, body: c_int) -> c_int {
    together(ff, c"FetiFetiSetMatIS", |o| {
        o.subdomains.clear();
        let a = Mat::share(not_null(a, "Mat")?, &o.session)?;
        o.add_matis(&a, None, body)
    })
}

#[no_mangle]
#[allow(missing_docs)]
pub unsafe extern "C" fn FetiFetiAddMatIS(
    ff: Handle,
    a: raw::Mat,
    numbers: raw::IS,
    body: c_int,
) -> c_int {
    together(ff, c"FetiFetiAddMatIS", |o| {
        let a = Mat::share(not_null(a, "Mat")?, &o.session)?;
        let numbers = match numbers.is_null() {
            true => None,
            false => Some(list(o, numbers)?),
        };
        o.add_matis(&a, numbers, body)
    })
}

fn not_null<T>(object: *mut T, what: &str) -> Result<*mut T> {
    match object.is_null() {
        true => Err(Error::input(format!("the {what} is NULL, expected one"))),
        false => Ok(object),
    }
}

#[no_mangle]
#[allow(missing_docs)]
pub unsafe extern "C" fn FetiFetiSetNearNullSpace(ff: Handle, space: raw::MatNullSpace) -> c_int {
    together(ff, c"FetiFetiSetNearNullSpace", |o| {
        o.near = None;
        if let Some(attached) = Attached::of(space, &o.session)? {
            let layout = match attached.vectors.first() {
                Some(first) => first.duplicate()?,
                None => o.vector()?,
            };
            o.near = Some(spanned(&layout, attached)?);
        }
        o.stale = true;
        Ok(())
    })
}

#[no_mangle]
#[allow(missing_docs)]
pub unsafe extern "C" fn FetiFetiSetCoordinates(
    ff: Handle,
    dim: c_int,
    n: c_int,
    coords: *const f64,
) -> c_int {
    alone(ff, c"FetiFetiSetCoordinates", |o| {
        if !(1..=3).contains(&dim) {
            return Err(Error::input(format!(
                "the dimension is {dim}, expected 1, 2 or 3"
            )));
        }
        let of_node = array(coords, n.saturating_mul(dim), "coords")?.to_vec();
        o.coordinates = Some(Coordinates {
            dim: dim as usize,
            of_node,
        });
        o.stale = true;
        Ok(())
    })
}

fn list(o: &Object, is: raw::IS) -> Result<Vec<i32>> {
    match is.is_null() {
        true => indices(None),
        false => indices(Some(&Is::share(is, &o.session)?)),
    }
}

#[no_mangle]
#[allow(missing_docs)]
pub unsafe extern "C" fn FetiFetiSetDirichletBoundaries(
    ff: Handle,
    dofs: raw::IS,
    values: raw::Vec,
) -> c_int {
    together(ff, c"FetiFetiSetDirichletBoundaries", |o| {
        o.held = list(o, dofs)?;
        o.held_values = match values.is_null() {
            true => None,
            false => Some(PetscVec::share(values, &o.session)?),
        };
        o.stale = true;
        Ok(())
    })
}

#[no_mangle]
#[allow(missing_docs)]
pub unsafe extern "C" fn FetiFetiSetNeumannBoundaries(ff: Handle, _dofs: raw::IS) -> c_int {
    together(ff, c"FetiFetiSetNeumannBoundaries", |_| Ok(()))
}

#[no_mangle]
#[allow(missing_docs)]
pub unsafe extern "C" fn FetiFetiSetPrimalDofs(ff: Handle, dofs: raw::IS) -> c_int {
    together(ff, c"FetiFetiSetPrimalDofs", |o| {
        o.primal = list(o, dofs)?;
        o.stale = true;
        Ok(())
    })
}

#[no_mangle]
#[allow(missing_docs)]
pub unsafe extern "C" fn FetiFetiSetContactRows(
    ff: Handle,
    n: c_int,
    ia: *const c_int,
    ja: *const c_int,
    b: *const f64,
    gap: *const f64,
    kind: *const c_int,
) -> c_int {
    alone(ff, c"FetiFetiSetContactRows", |o| {
        let mut rows = Vec::new();
        if n != 0 {
            let (gap, kind) = (array(gap, n, "gap")?, array(kind, n, "kind")?);
            let ia = array(ia, n.saturating_add(1), "ia")?;
            let nnz = starts(ia)? as c_int;
            let (ja, b) = (array(ja, nnz, "ja")?, array(b, nnz, "b")?);
            for r in 0..n as usize {
                rows.push(contact_row(r, ia, ja, b, gap[r], kind[r])?);
            }
        }
        o.rows = rows;
        o.stale = true;
        Ok(())
    })
}

fn contact_row(
    r: usize,
    ia: &[c_int],
    ja: &[c_int],
    b: &[f64],
    gap: f64,
    kind: c_int,
) -> Result<GivenRow> {
    let range = ia[r] as usize..ia[r + 1] as usize;
    let mut terms = Vec::new();
    for e in range {
        let dof = u32::try_from(ja[e]).map_err(|_| {
            Error::input(format!(
                "contact row {r} has a coefficient at unknown {}, expected at least 0",
                ja[e]
            ))
        })?;
        if b[e] != 0.0 {
            terms.push((dof, b[e]));
        }
    }
    if terms.is_empty() || terms.iter().any(|t| !t.1.is_finite()) || !gap.is_finite() {
        return Err(Error::input(format!(
            "contact row {r} is empty or not finite (gap {gap}), expected coefficients other than zero and a finite gap"
        )));
    }
    let kind = match kind {
        0 => RowKind::Equality,
        1 => RowKind::Inequality,
        _ => {
            return Err(Error::input(format!(
            "contact row {r} is of kind {kind}, expected FETIFETI_EQUALITY (0) or FETIFETI_INEQUALITY (1)"
        )))
        }
    };
    Ok(GivenRow { terms, gap, kind })
}

#[no_mangle]
#[allow(missing_docs)]
pub unsafe extern "C" fn FetiFetiSetUp(ff: Handle) -> c_int {
    together(ff, c"FetiFetiSetUp", Object::set_up)
}

#[no_mangle]
#[allow(missing_docs)]
pub unsafe extern "C" fn FetiFetiSolve(ff: Handle, b: raw::Vec, x: raw::Vec) -> c_int {
    together(ff, c"FetiFetiSolve", |o| {
        let b = PetscVec::share(not_null(b, "right-hand side")?, &o.session)?;
        let x = PetscVec::share(not_null(x, "solution")?, &o.session)?;
        o.solve(&b, &x)
    })
}
