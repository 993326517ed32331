//! The rows once more, by the multipliers of the certified solution.
//!
//! The loop ends by the residual, in displacements. Forces between stiff bodies follow from small differences of these
//! and may still have the wrong sign when displacements have converged. The certificate then refines the solution with
//! the rows that hold, and multipliers get their digits: some may turn out to pull.

use super::friction;
use super::judge::JudgeSizes;
use super::state::State;
use super::tuning::Tuning;
use crate::feti::jump::blocks::Block;
use crate::feti::jump::operator::Jump;
use crate::feti::{LinearMethod, LinearSolution};
use crate::Result;
use parallel::exchange::{any, max_all};

/// The signs of a certified solution.
pub enum Signs {
    /// All rows are on the right side.
    Right,
    /// They are with these multipliers, which have the same forces: rows depend on each other.
    Shared(Vec<f64>),
    /// Some rows are on the wrong side: the state from which the loop must go on.
    Wrong(State),
}

/// Judges the signs of a certified solution. Collective.
///
/// # Errors
/// PETSc's.
pub fn signs(method: &LinearMethod, tuning: &Tuning, solution: &LinearSolution) -> Result<Signs> {
    let rounding = tuning.certified_rounding;
    let rtol = method.ksp.tolerances()?.0;
    let dual = method.dual();
    let jump = &dual.stiffness.jump;
    let size = |list: &mut dyn Iterator<Item = &f64>| list.fold(0.0f64, |a, v| a.max(v.abs()));
    let mut lambda = solution.lambda.clone();
    let forces = jump.blocks.iter().map(|block| {
        let forces = block.forces(&lambda[block.rows.clone()]);
        size(&mut forces.iter())
    });
    let mut largest = [
        forces.fold(0.0, f64::max),
        size(&mut solution.u.iter().flatten()),
    ];
    max_all(dual.comm(), &mut largest);
    let JudgeSizes { load, give } = JudgeSizes::of(&dual, &method.problem);
    let [pull, open] = largest.map(|l| (tuning.certified_wrong * rtol).max(rounding) * l);
    let (pull, open) = (pull.max(rounding * load), open.max(rounding * give));
    let mut active = jump.active.clone();
    let mut shared = false;
    for block in &jump.blocks {
        shared |= leave(block, jump, &mut lambda, pull, &mut active);
    }
    for r in jump.rows_between_bodies() {
        if !solution.active[r] && jump.law[r].violation(solution.gaps[r], false) > open {
            active[r] = true;
        }
    }
    let slides = friction::error(method, &tuning.friction, solution, open)? > pull;
    if any(dual.comm(), active != jump.active) || slides {
        jump.release(&active, &mut lambda);
        return Ok(Signs::Wrong(State::warm(lambda, &active)));
    }
    Ok(match any(dual.comm(), shared) {
        true => Signs::Shared(lambda),
        false => Signs::Right,
    })
}

/// Takes rows of `block` that pull by more than `pull` out of the set. Rows that depend on each other may carry their
/// forces with multipliers of both signs: they get others that are not negative, if those do as well. Returns whether
/// they have.
fn leave(block: &Block, jump: &Jump, lambda: &mut [f64], pull: f64, active: &mut [bool]) -> bool {
    let start = block.rows.start;
    let held = active[block.rows.clone()].to_vec();
    let pulls = |r: &usize| jump.law[start + r].pull(lambda[start + r]) > pull;
    let on = |r: &usize| held[*r];
    if !(0..held.len()).filter(on).any(|r| pulls(&r)) {
        return false;
    }
    let mut leaves: Vec<usize> = (0..held.len()).filter(on).filter(pulls).collect();
    let (law, own) = (&jump.law[block.rows.clone()], &lambda[block.rows.clone()]);
    let others = block.others(&held, law, own);
    let others = others.filter(|others| others.rest <= pull);
    if let Some(others) = &others {
        leaves.retain(|r| !others.rows.contains(r));
        for (r, value) in &others.multipliers {
            lambda[start + r] = *value;
        }
    }
    leaves.iter().for_each(|r| active[start + r] = false);
    others.is_some()
}
