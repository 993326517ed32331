//! The functions of `wrappers/fetifeti.h` for surfaces that mortar rows join; their manual pages are there.

use super::handle::{alone, array, optional, put, starts, together, HandlePointer};
use super::laws::INFINITY;
use super::mortar::{GivenMortar, HostSurfaces};
use super::object::Object;
use super::rows::law;
use super::surface::{GivenSurface, HostSurface};
use crate::Result;
use base::Fault;
use petsc::PetscInt;
use std::ffi::c_int;

#[allow(clippy::too_many_arguments)]
#[no_mangle]
pub unsafe extern "C" fn FetiFetiAddSurface(
    ff: HandlePointer,
    matrix: PetscInt,
    dim: PetscInt,
    components: PetscInt,
    n: PetscInt,
    dofs: *const PetscInt,
    coords: *const f64,
    faces: PetscInt,
    start: *const PetscInt,
    nodes: *const PetscInt,
    surface: *mut PetscInt,
) -> c_int {
    together(ff, c"FetiFetiAddSurface", |o| {
        let arrays = || {
            let per_node = |k: PetscInt| n.saturating_mul(k.max(1));
            let (start, nodes) = match faces {
                0 => (&[][..], &[][..]),
                _ => {
                    let start = array(start, faces.saturating_add(1), "start")?;
                    (start, array(nodes, starts(start)? as PetscInt, "nodes")?)
                }
            };
            Ok(GivenSurface {
                matrix,
                dim,
                components,
                dofs: array(dofs, per_node(components), "dofs")?,
                coords: array(coords, per_node(dim), "coords")?,
                start,
                nodes,
            })
        };
        let given = o.session.agree(arrays())?;
        let number = o.surfaces.len();
        let made = HostSurface::new(&o.session, &given, number, &|k| {
            o.size_of(k, "a surface names")
        })?;
        o.surfaces.push(made);
        put(surface, number as PetscInt);
        Ok(())
    })
}

#[allow(clippy::too_many_arguments)]
#[no_mangle]
pub unsafe extern "C" fn FetiFetiAddMortar(
    ff: HandlePointer,
    first: PetscInt,
    second: PetscInt,
    kind: PetscInt,
    reach: f64,
    adjust: f64,
    gap: f64,
    gaps: *const f64,
    without: *const PetscInt,
    mortar: *mut PetscInt,
) -> c_int {
    together(ff, c"FetiFetiAddMortar", |o| {
        let n = usize::try_from(first).ok().and_then(|k| o.surfaces.get(k));
        let n = n.map_or(0, |s| s.mine.len()) as PetscInt;
        let law = law(kind, || "a mortar is".into());
        let given = GivenMortar {
            surfaces: [first, second],
            law: o.session.agree(law)?,
            reach,
            adjust,
            gap,
            gaps: optional(gaps, n, "gaps")?.unwrap_or_default(),
            without: optional(without, n, "without")?.unwrap_or_default(),
        };
        let all = HostSurfaces {
            session: &o.session,
            list: &o.surfaces,
        };
        let made = all.mortar(&given)?;
        put(mortar, o.mortars.len() as PetscInt);
        o.mortars.push(made);
        o.changed.rows = true;
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiResetMortar(ff: HandlePointer) -> c_int {
    together(ff, c"FetiFetiResetMortar", |o| {
        o.surfaces.clear();
        o.mortars.clear();
        o.outcome = None;
        o.changed.rows = true;
        Ok(())
    })
}

#[no_mangle]
pub unsafe extern "C" fn FetiFetiGetMortar(
    ff: HandlePointer,
    mortar: PetscInt,
    n: PetscInt,
    lambda: *mut f64,
    pressure: *mut f64,
    gap: *mut f64,
    state: *mut PetscInt,
) -> c_int {
    alone(ff, c"FetiFetiGetMortar", |o| {
        let (m, surface) = solved_mortar(o, mortar, n)?;
        let each = if o.mortars[m].law.is_inequality() {
            1
        } else {
            surface.components
        };
        for (i, node) in surface.mine.iter().enumerate() {
            let component = |c| node.and_then(|node| o.at_nodes.get(&(m, node, c)));
            let at: Vec<_> = (0..each).map(component).collect();
            let carried = || at.iter().flatten();
            let remaining = carried().map(|a| a.gap);
            let remaining = remaining.max_by(|a, b| a.abs().total_cmp(&b.abs()));
            let holds = carried().map(|a| a.contact.state).max();
            for (c, at) in at.iter().enumerate() {
                let multiplier = at.map_or(0.0, |a| a.multiplier);
                at_place(lambda, i * each + c, multiplier);
                at_place(
                    pressure,
                    i * each + c,
                    at.map_or(0.0, |a| multiplier / a.area),
                );
            }
            at_place(gap, i, remaining.unwrap_or(INFINITY));
            at_place(state, i, holds.unwrap_or(-1));
        }
        Ok(())
    })
}

/// A mortar of the last solve, and the surface of its multipliers, of which this rank gave `n` nodes.
///
/// # Errors
/// A number that there is not; another number of nodes.
pub(super) fn solved_mortar(
    o: &Object,
    mortar: PetscInt,
    n: PetscInt,
) -> Result<(usize, &HostSurface)> {
    o.outcome()?;
    let solved = o.mortar_rows.counts.len();
    let found = usize::try_from(mortar).ok().filter(|&m| m < solved);
    let m = found.ok_or_else(|| {
        Fault::OutOfRange.error(format!(
            "there is no mortar {mortar} in what was solved, expected one of {solved} (from 0)"
        ))
    })?;
    let first = o.mortars[m].surfaces[0];
    let surface = &o.surfaces[first];
    if n as usize != surface.mine.len() {
        return Err(Fault::Sizes.error(format!(
            "there is room for {n} nodes, expected {}: as many as this rank gave of surface {first}",
            surface.mine.len()
        )));
    }
    Ok((m, surface))
}

/// Puts a number into an array of results; `place` is within what the header asks for.
pub(super) fn at_place<T>(to: *mut T, place: usize, value: T) {
    if !to.is_null() {
        // SAFETY: the header asks for room for so many numbers of each node.
        put(unsafe { to.add(place) }, value);
    }
}
