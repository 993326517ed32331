//! The augmented Lagrangian of the inequalities, minimised by damped Newton steps: the method that always ends
//! (docs/theory.md, section 9).
//!
//! ```text
//!     φ(u) = ½ uᵀK u − fᵀu + ½ Σ_j C_j (s_j)₊²,      s_j = μ_j + (B u − c)_j / C_j,      μ ← (s)₊
//! ```
//!
//! Contact rows are springs of compliance C with a force μ in them. On the set A = { s > 0 } a Newton step solves the
//! equations B u − C λ = c − C μ: the dual problem of the active-set method with F + C in place of F. In contrast to
//! that method, φ tells how far to go along the step. Each minimisation ends after finitely many steps, and μ converges
//! for every C. Small C make few minimisations of many steps; they therefore begin soft and become stiffer.
//!
//! After a minimisation that has come to its end, or nearly, steps of the active-set method try its set. They bring the
//! answer to the tolerance of the user, mostly long before μ has converged.

use std::time::Instant;

use super::active_set::{ActiveSet, Verdict};
use super::judge;
use super::newton::{Came, Search};
use super::settings::ContactSettings;
use super::state::{Observer, Progress, State, Step};
use crate::feti::{LinearMethod, LinearSolution};
use crate::status::Status;
use crate::Result;

/// Number of minimisations that end where the set hardly changes any more. Later ones go to the end: then convergence
/// is proved.
const EARLY: usize = 8;

/// In a trial, a gap is violated only if it is above this many tolerances, relative to the largest displacement. Rows
/// without force come and go by rounding.
const OPEN: f64 = 0.1;

/// Steps without progress after which a trial ends. It also ends if more than a few rows are wrong ([`Search::few`]).
const PATIENCE: usize = 1;

/// A minimisation that ends early with more wrong rows than this is not followed by a trial. A trial with no more has
/// twice the patience.
const CLOSE: usize = 4;

/// Solves from `state`, after `steps` that took `seconds`. Collective.
pub(super) fn solve(
    method: &LinearMethod,
    settings: &ContactSettings,
    mut state: State,
    mut steps: Vec<Step>,
    seconds: f64,
    observe: &mut Observer,
) -> Result<(LinearSolution, Vec<Step>)> {
    let clock = Instant::now();
    let rtol = state.accuracy * method.ksp.tolerances()?.0;
    state.safeguarded = true;
    let mut search = Search::new(method, &mut state)?;
    let elapsed = || seconds + clock.elapsed().as_secs_f64();
    for round in 0.. {
        let mut inner = 0;
        let (came, status) = loop {
            if state.steps >= settings.max_it {
                search.rigid();
                let run = ActiveSet::new(method, settings, Some(&state))?;
                return Ok((run.finish(&steps, elapsed(), Status::ContactSteps)?, steps));
            }
            let (step, status, came) = search.step(&mut state)?;
            observe(&step, &state)?;
            steps.push(step);
            inner += 1;
            // A step that is as exact as rounding permits is a step.
            if !status.converged() && !status.broke_down() {
                return Ok((search.finish(&steps, elapsed(), status)?, steps));
            }
            let near = round < EARLY && inner > 1 && came == Came::Near;
            if near || matches!(came, Came::Down | Came::Nowhere) {
                break (came, status);
            }
        };
        let minimal = came == Came::Down;
        if minimal && search.is_solution(rtol)? {
            let status = match status.converged() {
                true => status,
                false => Status::Rounding,
            };
            return Ok((search.finish(&steps, elapsed(), status)?, steps));
        }
        search.update(&mut state);
        let wrong = steps.last().map_or(0, |s| s.wrong);
        if came == Came::Near && wrong > CLOSE {
            search.stiffen();
            continue;
        }
        search.rigid();
        let trial = State {
            safeguarded: false,
            progress: Progress::default(),
            ..state.clone()
        };
        let mut run = ActiveSet::new(method, settings, Some(&trial))?;
        run.open = (OPEN * rtol).max(judge::ROUNDING);
        run.exact = true;
        // A set that is the minimum's is solved to the end at once.
        run.tight = minimal;
        run.length = search.length;
        while state.steps < settings.max_it {
            let (step, status, verdict) = run.step()?;
            state.steps += 1;
            let kept = State {
                lambda: run.state.lambda.clone(),
                before: run.state.before.clone(),
                ..state.clone()
            };
            observe(&step, &kept)?;
            steps.push(step);
            if status.broke_down() {
                break;
            }
            if verdict == Verdict::Solved || !status.converged() {
                return Ok((run.finish(&steps, elapsed(), status)?, steps));
            }
            let patience = match run.state.progress.wrong() > CLOSE {
                true => PATIENCE,
                false => 2 * PATIENCE,
            };
            let lost = run.state.progress.wrong() > search.few;
            if lost || run.state.safeguarded || run.state.progress.stalled(patience) {
                break;
            }
        }
        search.stiffen();
    }
    unreachable!("the loop returns")
}
