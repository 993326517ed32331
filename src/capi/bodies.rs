//! The functions of `wrappers/fetifeti.h` that take the bodies of a program: sizes, matrices, rigid motions; their
//! manual pages are there.

use super::coordinates::Coordinates;
use super::handle::{alone, array, lent, list, not_null, starts, together, HandlePointer};
use super::stack::HostMatrix;
use crate::Result;
use base::linalg::csr::Csr;
use base::Fault;
use petsc::{raw, AttachedNullSpace, PetscInt};
use std::ffi::c_int;

#[no_mangle]
pub unsafe extern "C" fn FetiFetiSetSizes(
    ff: HandlePointer,
    local: PetscInt,
    global: PetscInt,
) -> c_int {
    alone(ff, c"FetiFetiSetSizes", |o| {
        // PETSC_DECIDE and PETSC_DETERMINE are negative.
        let size = |n: PetscInt| usize::try_from(n).ok();
        if size(local).is_none() && size(global).is_none() {
            return Err(Fault::Wrong.error(
                "neither the local nor the global number of unknowns was given, expected one of them",
            ));
        }
        o.sizes = Some((size(local), size(global)));
        o.changed.whole = true;
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiSetBlockSize(ff: HandlePointer, bs: PetscInt) -> c_int {
    alone(ff, c"FetiFetiSetBlockSize", |o| {
        if bs < 1 {
            return Err(
                Fault::OutOfRange.error(format!("the block size is {bs}, expected at least 1"))
            );
        }
        o.block_size = Some(bs as usize);
        o.changed.whole = true;
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiAddSubdomain(
    ff: HandlePointer,
    body: PetscInt,
    n: PetscInt,
    ia: *const PetscInt,
    ja: *const PetscInt,
    a: *const f64,
    dofs: *const PetscInt,
) -> c_int {
    alone(ff, c"FetiFetiAddSubdomain", |o| {
        if !o.stack.is_empty() {
            return Err(o.mixed());
        }
        let dofs = array(dofs, n, "dofs")?.to_vec();
        let ia = array(ia, n.saturating_add(1), "ia")?;
        let nnz = starts(ia)? as PetscInt;
        let (ja, a) = (array(ja, nnz, "ja")?, array(a, nnz, "a")?);
        let k = matrix(n, ia, ja, a)?;
        o.push(HostMatrix {
            k,
            dofs,
            copies: None,
            body,
            map: None,
        });
        Ok(())
    })
}

/// A square matrix from compressed rows; entries at the same place are added up.
fn matrix(n: PetscInt, ia: &[PetscInt], ja: &[PetscInt], a: &[f64]) -> Result<Csr> {
    let mut triplets = Vec::with_capacity(ja.len());
    for (row, range) in ia.windows(2).enumerate() {
        let range = range[0] as usize..range[1] as usize;
        for (&j, &v) in ja[range.clone()].iter().zip(&a[range]) {
            if !(0..n).contains(&j) {
                return Err(Fault::OutOfRange.error(format!(
                    "row {row} of the subdomain has an entry in column {j}, expected columns from 0 to below {n}"
                )));
            }
            if !v.is_finite() {
                return Err(Fault::Wrong.error(format!(
                    "row {row} of the subdomain has the entry {v}, expected a finite number"
                )));
            }
            triplets.push((row as u32, j as u32, v));
        }
    }
    Ok(Csr::from_triplets(n as usize, &triplets))
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiUpdateSubdomain(
    ff: HandlePointer,
    s: PetscInt,
    n: PetscInt,
    ia: *const PetscInt,
    ja: *const PetscInt,
    a: *const f64,
) -> c_int {
    alone(ff, c"FetiFetiUpdateSubdomain", |o| {
        let ia = array(ia, n.saturating_add(1), "ia")?;
        let nnz = starts(ia)? as PetscInt;
        let (ja, a) = (array(ja, nnz, "ja")?, array(a, nnz, "a")?);
        let k = matrix(n, ia, ja, a)?;
        o.update_subdomain(s, k)
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiUpdateMatrices(
    ff: HandlePointer,
    n: PetscInt,
    matrices: *const raw::Mat,
) -> c_int {
    together(ff, c"FetiFetiUpdateMatrices", |o| {
        let list = o
            .session
            .agree(array(matrices, n, "the list of matrices"))?;
        let one = |a: &raw::Mat| {
            if a.is_null() {
                Ok(None)
            } else {
                lent(*a, &o.session).map(Some)
            }
        };
        let list = list.iter().map(one).collect::<Result<Vec<_>>>()?;
        o.update_matrices(&list)
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiSetMatIS(ff: HandlePointer, a: raw::Mat, body: PetscInt) -> c_int {
    together(ff, c"FetiFetiSetMatIS", |o| {
        o.set_matis(&lent(not_null(a, "Mat")?, &o.session)?, body)
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiAddMatIS(
    ff: HandlePointer,
    a: raw::Mat,
    numbers: raw::IS,
    body: PetscInt,
) -> c_int {
    together(ff, c"FetiFetiAddMatIS", |o| {
        let a = lent(not_null(a, "Mat")?, &o.session)?;
        if numbers.is_null() {
            o.stack_matis(&a, body)
        } else {
            o.add_matis(&a, &list(o, numbers)?, body)
        }
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiSetNearNullSpace(
    ff: HandlePointer,
    space: raw::MatNullSpace,
) -> c_int {
    together(ff, c"FetiFetiSetNearNullSpace", |o| {
        // SAFETY: the host hands over NULL or a live null space (fetifeti.h).
        o.near = unsafe { AttachedNullSpace::of_host(space, &o.session) }?;
        o.changed.whole = true;
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiSetCoordinates(
    ff: HandlePointer,
    dim: PetscInt,
    n: PetscInt,
    coords: *const f64,
) -> c_int {
    alone(ff, c"FetiFetiSetCoordinates", |o| {
        if !(1..=3).contains(&dim) {
            return Err(
                Fault::OutOfRange.error(format!("the dimension is {dim}, expected 1, 2 or 3"))
            );
        }
        let of_node = array(coords, n.saturating_mul(dim), "coords")?.to_vec();
        o.coordinates = Some(Coordinates {
            dim: dim as usize,
            of_node,
        });
        o.changed.whole = true;
        Ok(())
    })
}
