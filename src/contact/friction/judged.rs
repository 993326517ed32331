//! A solution beside the law of friction.

use super::node::{self, Node};
use super::tuning::FrictionTuning;
use crate::feti::{LinearMethod, LinearSolution};
use crate::substructures::FrictionNode;
use crate::Result;
use parallel::exchange::max_all;

/// The nodes of this rank in the states that multipliers and a set say. Collective.
pub fn nodes_at(
    method: &LinearMethod,
    tuning: &FrictionTuning,
    lambda: &[f64],
    active: &[bool],
) -> Result<Vec<Node>> {
    let dual = method.dual();
    let jump = &dual.stiffness.jump;
    let compliance = dual.stiffness.compliance_of_rows(&method.problem)?;
    let place = jump.places();
    let at = (lambda, active);
    let node = |given: &FrictionNode| {
        let beside = jump.rows_beside(place[given.normal]);
        Node::new(given, |r| place[r], beside, at, &compliance, tuning)
    };
    Ok(method.problem.friction.iter().map(node).collect())
}

/// The largest distance of a solution from the law of friction, as a force; slips say nothing up to the length
/// `nothing`. Collective.
pub fn error(
    method: &LinearMethod,
    tuning: &FrictionTuning,
    solution: &LinearSolution,
    nothing: f64,
) -> Result<f64> {
    let held = &method.dual().stiffness.jump.active.clone();
    let step = node::Step {
        lambda: &solution.lambda,
        gaps: &solution.gaps,
        active: held,
        nothing,
    };
    let nodes = nodes_at(method, tuning, &solution.lambda, held)?;
    let mut largest = [nodes.iter().fold(0.0, |a: f64, n| a.max(n.error(&step)))];
    max_all(method.session.comm(), &mut largest);
    Ok(largest[0])
}
