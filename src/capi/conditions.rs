//! The functions of `wrappers/fetifeti.h` for conditions: held unknowns, primal unknowns, contact; their manual pages
//! are there.

use super::handle::{
    alone, array, lent, list, not_null, optional, starts, together, HandlePointer,
};
use super::numbering::HostNumbering;
use super::object::Object;
use super::rows::{law, pairs, HostRow, PairSide, RowOrigin};
use crate::Result;
use base::Fault;
use petsc::{raw, PetscInt};
use std::ffi::c_int;

#[no_mangle]
pub unsafe extern "C" fn FetiFetiSetDirichletBoundaries(
    ff: HandlePointer,
    dofs: raw::IS,
    values: raw::Vec,
) -> c_int {
    together(ff, c"FetiFetiSetDirichletBoundaries", |o| {
        let held = list(o, dofs)?;
        // Values alone are read at each solve.
        o.changed.whole |= held != o.held;
        o.held = held;
        o.held_values = if values.is_null() {
            None
        } else {
            Some(lent(values, &o.session)?)
        };
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiSetNeumannBoundaries(ff: HandlePointer, _dofs: raw::IS) -> c_int {
    together(ff, c"FetiFetiSetNeumannBoundaries", |_| Ok(()))
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiSetPrimalDofs(ff: HandlePointer, dofs: raw::IS) -> c_int {
    together(ff, c"FetiFetiSetPrimalDofs", |o| {
        o.primal = list(o, dofs)?;
        o.changed.whole = true;
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiSetContactRows(
    ff: HandlePointer,
    n: PetscInt,
    ia: *const PetscInt,
    ja: *const PetscInt,
    b: *const f64,
    gap: *const f64,
    kind: *const PetscInt,
) -> c_int {
    alone(ff, c"FetiFetiSetContactRows", |o| {
        contact_rows(o, n, ia, (None, ja), b, gap, kind)
    })
}

#[allow(clippy::too_many_arguments)]
#[no_mangle]
pub unsafe extern "C" fn FetiFetiSetContactRowsByMatrix(
    ff: HandlePointer,
    n: PetscInt,
    ia: *const PetscInt,
    matrix: *const PetscInt,
    ja: *const PetscInt,
    b: *const f64,
    gap: *const f64,
    kind: *const PetscInt,
) -> c_int {
    alone(ff, c"FetiFetiSetContactRowsByMatrix", |o| {
        contact_rows(o, n, ia, (Some(matrix), ja), b, gap, kind)
    })
}

/// Replaces the rows of this rank. Columns are numbers of all unknowns, or those of a matrix for each term.
fn contact_rows(
    o: &mut Object,
    n: PetscInt,
    ia: *const PetscInt,
    (matrix, ja): (Option<*const PetscInt>, *const PetscInt),
    b: *const f64,
    gap: *const f64,
    kind: *const PetscInt,
) -> Result<()> {
    let mut rows = Vec::new();
    if n != 0 {
        let (gap, kind) = (array(gap, n, "gap")?, array(kind, n, "kind")?);
        let ia = array(ia, n.saturating_add(1), "ia")?;
        let nnz = starts(ia)? as PetscInt;
        let (ja, b) = (array(ja, nnz, "ja")?, array(b, nnz, "b")?);
        let matrix = matrix.map(|list| array(list, nnz, "matrix")).transpose()?;
        for r in 0..n as usize {
            let mut terms = Vec::new();
            for e in ia[r] as usize..ia[r + 1] as usize {
                let whose = matrix.map_or(-1, |list| list[e]);
                let (numbering, dof) = column(o, r, whose, ja[e])?;
                terms.push((numbering, dof, b[e]));
            }
            rows.push(contact_row(r, terms, gap[r], kind[r])?);
        }
    }
    o.rows.retain(|row| row.origin != RowOrigin::Rows);
    o.rows.extend(rows);
    o.changed.rows = true;
    Ok(())
}

/// The unknown of a term of row `r`: number `dof` of matrix `whose`, or of all unknowns where that is negative.
fn column(o: &Object, r: usize, whose: PetscInt, dof: PetscInt) -> Result<(HostNumbering, u32)> {
    let (numbering, n) = match usize::try_from(whose) {
        Err(_) => (HostNumbering::All, None),
        Ok(k) => (
            HostNumbering::Matrix(k),
            Some(o.size_of(k, &format!("contact row {r} names"))?),
        ),
    };
    let number = u32::try_from(dof).ok();
    let number = number.filter(|d| n.is_none_or(|n| (*d as usize) < n));
    let number = number.ok_or_else(|| {
        let expected = match n {
            None => "at least 0".into(),
            Some(n) => format!("numbers from 0 to below {n}, those of matrix {whose}"),
        };
        Fault::OutOfRange.error(format!(
            "contact row {r} has a coefficient at unknown {dof}, expected {expected}"
        ))
    })?;
    Ok((numbering, number))
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiSetContactGaps(
    ff: HandlePointer,
    n: PetscInt,
    gap: *const f64,
) -> c_int {
    alone(ff, c"FetiFetiSetContactGaps", |o| {
        if n as usize != o.rows.len() {
            return Err(Fault::Sizes.error(format!(
                "there are {n} gaps, expected {}: as many as this rank gave rows",
                o.rows.len()
            )));
        }
        let gap = array(gap, n, "gap")?;
        if let Some((r, g)) = gap.iter().enumerate().find(|(_, g)| !g.is_finite()) {
            return Err(Fault::Wrong.error(format!(
                "the new gap of row {r} of rank {} is {g}, expected a finite one",
                o.session.rank()
            )));
        }
        for (row, &gap) in o.rows.iter_mut().zip(gap) {
            row.gap = gap;
        }
        o.changed.gaps = true;
        Ok(())
    })
}

fn contact_row(
    r: usize,
    mut terms: Vec<(HostNumbering, u32, f64)>,
    gap: f64,
    number: PetscInt,
) -> Result<HostRow> {
    terms.retain(|t| t.2 != 0.0);
    if terms.is_empty() || terms.iter().any(|t| !t.2.is_finite()) || !gap.is_finite() {
        return Err(Fault::Wrong.error(format!(
            "contact row {r} is empty or not finite (gap {gap}), expected coefficients other than zero and a finite gap"
        )));
    }
    let law = law(number, || format!("contact row {r} is"))?;
    Ok(HostRow::new(RowOrigin::Rows, terms, gap, law))
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiSetContactPairs(
    ff: HandlePointer,
    a: PetscInt,
    first: raw::IS,
    b: PetscInt,
    second: raw::IS,
    gap: *const f64,
    kind: PetscInt,
) -> c_int {
    together(ff, c"FetiFetiSetContactPairs", |o| {
        if first.is_null() && second.is_null() {
            o.rows.retain(|row| row.origin != RowOrigin::Pairs);
        } else {
            let rows = o
                .session
                .agree(contact_pairs(o, (a, first), (b, second), gap, kind))?;
            o.rows.extend(rows);
        }
        o.changed.rows = true;
        Ok(())
    })
}

/// The rows of pairs of unknowns (matrix, numbers).
fn contact_pairs(
    o: &Object,
    first: (PetscInt, raw::IS),
    second: (PetscInt, raw::IS),
    gap: *const f64,
    kind: PetscInt,
) -> Result<Vec<HostRow>> {
    let law = law(kind, || "contact pairs are".into())?;
    let first = PairSide::new(o, first.0, list(o, not_null(first.1, "first IS")?)?)?;
    let second = PairSide::new(o, second.0, list(o, not_null(second.1, "second IS")?)?)?;
    let gap = optional(gap, first.dofs.len() as PetscInt, "gap")?;
    pairs(
        o.session.rank(),
        &first,
        &second,
        gap.unwrap_or_default(),
        law,
    )
}
