//! How far the sides of contacts with friction have slid up to the start of a load step: the history of friction.
//!
//! ```text
//!     c_t = A + drag,      A ← A + w + drag        w = B_t u - c_t, the slip of the step
//! ```

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
    let dual = solver.dual();
    let slid = dual.stiffness.jump.in_given_order(&state.slid);
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
        out[i] = a + solution.gaps[i] + drags[jump.given(i)];
    }
    Ok(out)
}
