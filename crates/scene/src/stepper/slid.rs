//! How far the sides of contacts with friction have slid up to the start of a load step: the history of friction.
//!
//! ```text
//!     c_t = A + drag,      A ← A + w + drag        w = B_t u - c_t, the slip of the step
//! ```
//!
//! Where contacts are renewed, A is that of the new rows for the displacements at the end of the last step, less what
//! elastic slip has given way.

use std::collections::HashMap;

use super::renewed::{places, RowKey};
use crate::checked::Scene;
use base::Result;
use fetifeti::solution::State;
use fetifeti::{FetiFeti, Solution};
use parallel::exchange::any;

/// Adds A to the right-hand sides of the tangential rows, in the order in which a rank provides its rows.
pub(super) fn add(solver: &FetiFeti, state: Option<&State>, gaps: &mut [f64]) {
    let Some(state) = state.filter(|s| !s.slid.is_empty()) else {
        return;
    };
    let slid = solver.in_given_order(&state.slid);
    gaps.iter_mut().zip(slid).for_each(|(c, a)| *c += a);
}

/// A after a load step, on the owned rows; empty without friction on any rank. Collective.
///
/// # Errors
/// As [`Scene::gaps`].
pub(super) fn after(
    scene: &Scene,
    owns: &dyn Fn(usize) -> bool,
    (solver, solution): (&FetiFeti, &Solution),
    (step, before): (usize, Option<&State>),
) -> Result<Vec<f64>> {
    // A rank may have read a part of the scene without friction.
    if !any(solver.session().comm(), scene.has_friction()) {
        return Ok(Vec::new());
    }
    let drags = scene.drags(owns, step)?;
    let dual = solver.dual();
    let jump = &dual.stiffness.jump;
    let known = before.map_or(&[][..], |s| &s.slid);
    let mut out = vec![0.0; jump.n_owned];
    for i in jump
        .rows_between_bodies()
        .filter(|&i| jump.law[i].is_friction())
    {
        let a = known.get(i).copied().unwrap_or(0.0);
        out[i] = a + solution.gaps[i] + drags[solver.given_row(i)];
    }
    Ok(out)
}

/// The forces of friction on nodes after a load step, by the places of their rows.
pub(super) type Forces = HashMap<RowKey, [f64; 3]>;

/// A for new rows, on the owned ones, where step `before` has left the displacements `u` and these forces; empty
/// without friction on any rank. Collective.
///
/// # Errors
/// As [`Scene::gaps`].
pub(super) fn renewed(
    scene: &Scene,
    owns: &dyn Fn(usize) -> bool,
    (solver, u): (&FetiFeti, &[Vec<f64>]),
    (before, forces): (usize, &Forces),
) -> Result<Vec<f64>> {
    if !any(solver.session().comm(), scene.has_friction()) {
        return Ok(Vec::new());
    }
    let (gaps, drags) = (scene.gaps(owns, before)?, scene.drags(owns, before)?);
    let dual = solver.dual();
    let jump = &dual.stiffness.jump;
    let mut out = dual.stiffness.jumps_of(u)?;
    let rows = &solver.problem().rows;
    for i in jump.rows_between_bodies() {
        if !jump.law[i].is_friction() {
            out[i] = 0.0;
            continue;
        }
        let given = solver.given_row(i);
        let row = &rows[given];
        let force = places(scene, &row.label, true).enumerate();
        let force = force.filter_map(|(k, place)| Some((k, forces.get(&place)?)));
        let along = |f: &[f64; 3]| (0..3).map(|k| f[k] * row.label.normal[k]).sum::<f64>();
        let elastic = force.map(|(k, f)| if k == 0 { along(f) } else { -along(f) });
        let elastic = row.compliance * elastic.last().unwrap_or(0.0);
        out[i] -= elastic + gaps[given] - drags[given];
    }
    Ok(out)
}
