//! The solution at multipliers that no run of equations has left.

use super::judged::nodes_at;
use super::node::Node;
use super::nodes::Nodes;
use super::tuning::FrictionTuning;
use crate::contact::modes::TurnedRows;
use crate::contact::state::State;
use crate::feti::krylov::iterate::KrylovRun;
use crate::feti::krylov::loads::Loads;
use crate::feti::krylov::residual::Iterate;
use crate::feti::projector::kernel_motion::KernelMotion;
use crate::feti::{LinearMethod, LinearSolution};
use crate::substructures::Law;
use crate::Result;
use base::ErrorKind;

/// The solution at the multipliers and the set of `state`; see [`at_state`]. `run` says how the loop has ended.
///
/// Nodes slip in the direction of their forces. Their rows across say where a body is whose nodes all slip. Collective.
///
/// # Errors
/// PETSc's own.
pub fn recovered(
    method: &LinearMethod,
    tuning: &FrictionTuning,
    loads: Loads,
    state: &State,
    run: KrylovRun,
    seconds: f64,
) -> Result<LinearSolution> {
    let mut at = at_state(method, loads.clone(), state)?;
    if method.dual().natural.unheld().is_empty() {
        at.place(&method.dual())?;
        return method.recover(at, run, seconds);
    }
    match placed_across(method, tuning, &mut at, state) {
        // Where several contacts meet, rows across slips may depend on others.
        Err(e) if e.kind() == ErrorKind::NotConverged => {
            at = at_state(method, loads, state)?;
            at.place(&method.dual())?;
        }
        Err(e) => return Err(e),
        Ok(free) => method.system.settle(free),
    }
    method.recover(at, run, seconds)
}

/// Places bodies by the rows that hold at `state` and by those across slips. Returns the motions that these leave free.
/// Collective.
fn placed_across(
    method: &LinearMethod,
    tuning: &FrictionTuning,
    at: &mut Iterate,
    state: &State,
) -> Result<Vec<KernelMotion>> {
    let mut nodes = nodes_at(method, tuning, &state.lambda, &state.active)?;
    let mut turned = TurnedRows::of(method);
    let turns = Nodes::turns(&mut nodes);
    turned.turn(&turns);
    at.turn(&turns)?;
    let given = Nodes::given(&nodes, state.active.len());
    method.system.set_given_multipliers(given);
    let mut active = state.active.clone();
    for across in nodes.iter().filter_map(Node::slips_beside) {
        active[across] = true;
    }
    method.set_active(&active)?;
    at.place(&method.dual())?;
    let free = method.dual().natural.unheld().to_vec();
    at.turn(&turned.back())?;
    method.system.set_given_multipliers(given_at(method, state));
    method.set_active(&state.active)?;
    Ok(free)
}

/// λ and the `loads` of the problem at the multipliers and the set of `state`, in the directions that were given: what
/// tangential rows bear that do not hold is a given force. Rows are rigid, and have these directions. Collective.
///
/// # Errors
/// PETSc's own.
pub fn at_state(method: &LinearMethod, loads: Loads, state: &State) -> Result<Iterate> {
    let given = given_at(method, state);
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

/// The forces of tangential rows that do not hold, on the owned rows in the directions that were given.
fn given_at(method: &LinearMethod, state: &State) -> Vec<f64> {
    let slips = |(i, law): (usize, &Law)| match law.is_friction() && !state.active[i] {
        true => state.lambda[i],
        false => 0.0,
    };
    let law = &method.dual().stiffness.jump.law;
    law.iter().enumerate().map(slips).collect()
}
