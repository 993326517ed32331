//! The solution at multipliers that no run of equations has left.

use crate::contact::state::State;
use crate::feti::krylov::iterate::KrylovRun;
use crate::feti::krylov::loads::Loads;
use crate::feti::krylov::residual::Iterate;
use crate::feti::{LinearMethod, LinearSolution};
use crate::substructures::Law;
use crate::Result;

/// The solution at the multipliers and the set of `state`; see [`at_state`]. `run` says how the loop has ended.
/// Collective.
///
/// # Errors
/// PETSc's own.
pub fn recovered(
    method: &LinearMethod,
    loads: Loads,
    state: &State,
    run: KrylovRun,
    seconds: f64,
) -> Result<LinearSolution> {
    let mut at = at_state(method, loads, state)?;
    at.place(&method.dual())?;
    method.recover(at, run, seconds)
}

/// λ and the `loads` of the problem at the multipliers and the set of `state`, in the directions that were given: what
/// tangential rows bear that do not hold is a given force. Rows are rigid, and have these directions. Collective.
///
/// # Errors
/// PETSc's own.
pub fn at_state(method: &LinearMethod, loads: Loads, state: &State) -> Result<Iterate> {
    let slips = |(i, law): (usize, &Law)| match law.is_friction() && !state.active[i] {
        true => state.lambda[i],
        false => 0.0,
    };
    let law = method.dual().stiffness.jump.law.clone();
    let given: Vec<f64> = law.iter().enumerate().map(slips).collect();
    method.system.set_given_multipliers(given.clone());
    method.set_active(&state.active)?;
    let dual = method.dual();
    let (g, kernel) = loads.with_multipliers(&method.problem, &dual, &given)?;
    let at = Iterate::new(&dual, Loads { g, kernel, ..loads })?;
    let mut lambda = at.lambda.array_mut()?;
    lambda.copy_from_slice(&state.lambda);
    dual.stiffness.jump.release(&state.active, &mut lambda);
    drop(lambda);
    Ok(at)
}
