//! The functions of `wrappers/fetifeti.h` for conditions: held unknowns, primal unknowns, contact; their manual pages
//! are there.

use super::handle::{alone, array, list, not_null, starts, together, Handle};
use super::numbering::Numbering;
use super::object::Object;
use super::rows::{pairs, row_kind, Origin, Row, Side};
use crate::error::Fault;
use crate::petsc::{raw, Vec as PetscVec};
use crate::Result;
use std::ffi::c_int;

#[no_mangle]
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
pub unsafe extern "C" fn FetiFetiSetNeumannBoundaries(ff: Handle, _dofs: raw::IS) -> c_int {
    together(ff, c"FetiFetiSetNeumannBoundaries", |_| Ok(()))
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiSetPrimalDofs(ff: Handle, dofs: raw::IS) -> c_int {
    together(ff, c"FetiFetiSetPrimalDofs", |o| {
        o.primal = list(o, dofs)?;
        o.stale = true;
        Ok(())
    })
}

#[no_mangle]
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
        o.rows.retain(|row| row.origin != Origin::Rows);
        o.rows.extend(rows);
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
    number: c_int,
) -> Result<Row> {
    let range = ia[r] as usize..ia[r + 1] as usize;
    let mut terms = Vec::new();
    for e in range {
        let dof = u32::try_from(ja[e]).map_err(|_| {
            Fault::OutOfRange.error(format!(
                "contact row {r} has a coefficient at unknown {}, expected at least 0",
                ja[e]
            ))
        })?;
        if b[e] != 0.0 {
            terms.push((Numbering::All, dof, b[e]));
        }
    }
    if terms.is_empty() || terms.iter().any(|t| !t.2.is_finite()) || !gap.is_finite() {
        return Err(Fault::Wrong.error(format!(
            "contact row {r} is empty or not finite (gap {gap}), expected coefficients other than zero and a finite gap"
        )));
    }
    let kind = row_kind(number, || format!("contact row {r} is"))?;
    Ok(Row {
        origin: Origin::Rows,
        terms,
        gap,
        kind,
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiSetContactPairs(
    ff: Handle,
    a: c_int,
    first: raw::IS,
    b: c_int,
    second: raw::IS,
    gap: *const f64,
    kind: c_int,
) -> c_int {
    together(ff, c"FetiFetiSetContactPairs", |o| {
        if first.is_null() && second.is_null() {
            o.rows.retain(|row| row.origin != Origin::Pairs);
        } else {
            let rows = o
                .session
                .agree(contact_pairs(o, (a, first), (b, second), gap, kind))?;
            o.rows.extend(rows);
        }
        o.stale = true;
        Ok(())
    })
}

/// The rows of pairs of unknowns (matrix, numbers).
fn contact_pairs(
    o: &Object,
    first: (c_int, raw::IS),
    second: (c_int, raw::IS),
    gap: *const f64,
    kind: c_int,
) -> Result<Vec<Row>> {
    let kind = row_kind(kind, || "contact pairs are".into())?;
    let first = Side::new(o, first.0, list(o, not_null(first.1, "first IS")?)?)?;
    let second = Side::new(o, second.0, list(o, not_null(second.1, "second IS")?)?)?;
    let gap = match gap.is_null() {
        true => &[],
        false => array(gap, first.dofs.len() as c_int, "gap")?,
    };
    pairs(o.session.rank(), &first, &second, gap, kind)
}
