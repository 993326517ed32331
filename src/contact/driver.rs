//! The contact loop on one page: propose, solve, judge, step, certify, doubt.
//!
//! A [`Strategy`](super::strategy::Strategy) proposes steps. The driver lets it make them, counts, observes, times and
//! stops. The certificate has the last word: rows that it finds on the wrong side send the loop on.

use std::time::Instant;

use super::certified_signs::{signs, Signs};
use super::existence::Existence;
use super::settings::{ContactSettings, ContactType};
use super::state::{Observer, State, Step};
use super::strategies;
use super::strategy::{Checkpoint, Proposal};
use crate::feti::krylov::loads::Loads;
use crate::feti::{LinearMethod, LinearSolution};
use crate::status::Status;
use crate::Result;

/// Solves the problem with its inequalities. Returns the solution and the steps of the loop. After an error the rows of
/// the method hold that held before. Collective.
///
/// # Errors
/// Contradictory rows, bodies that the load pushes away for ever, PETSc's own errors, and those of `observe`.
pub(crate) fn solve(
    method: &LinearMethod,
    settings: &ContactSettings,
    start: Option<&State>,
    observe: &mut Observer,
) -> Result<(LinearSolution, Vec<Step>)> {
    method.with_rows_kept(|| {
        Existence::new(method, &method.dual(), settings).of_gaps()?;
        certified(method, settings, start, observe)
    })
}

/// Follows strategies until the certificate finds all rows on the right side. Collective.
fn certified(
    method: &LinearMethod,
    settings: &ContactSettings,
    start: Option<&State>,
    observe: &mut Observer,
) -> Result<(LinearSolution, Vec<Step>)> {
    let before = start.map_or(0, |s| s.steps);
    let begin = start.cloned();
    let (mut found, mut steps) = follow(method, settings, settings.kind, begin, observe)?;
    let tuning = &settings.tuning;
    let mut accuracy = 1.0;
    for _ in 0..tuning.certified_rounds {
        let certified = method.certify(method.refine(found)?)?;
        // A certificate that rows on the wrong side have spoilt is for the loop to mend.
        if !certified.status.converged() && certified.status != Status::Certificate {
            return Ok((certified, steps));
        }
        let mut state = match signs(method, tuning, &certified)? {
            Signs::Right => return Ok((certified, steps)),
            Signs::Shared(lambda) => {
                return Ok((method.with_multipliers(certified, lambda)?, steps));
            }
            Signs::Wrong(state) => state,
        };
        accuracy *= tuning.certified_reduction;
        state.accuracy = accuracy;
        state.steps = before + steps.len();
        let kind = ContactType::ActiveSet;
        let (next, more) = follow(method, settings, kind, Some(state), observe)?;
        let (iterations, seconds) = (certified.iterations, certified.solve_seconds);
        steps.extend(more);
        found = LinearSolution {
            iterations: iterations + next.iterations,
            solve_seconds: seconds + next.solve_seconds,
            ..next
        };
    }
    let mut last = method.certify(method.refine(found)?)?;
    if last.status.converged() {
        match signs(method, tuning, &last)? {
            Signs::Right => {}
            Signs::Shared(lambda) => last = method.with_multipliers(last, lambda)?,
            Signs::Wrong(_) => last.status = Status::Certificate,
        }
    }
    Ok((last, steps))
}

/// Follows a strategy, and those to which it hands over, to the end. The result has no certificate. Collective.
fn follow(
    method: &LinearMethod,
    settings: &ContactSettings,
    kind: ContactType,
    start: Option<State>,
    observe: &mut Observer,
) -> Result<(LinearSolution, Vec<Step>)> {
    let clock = Instant::now();
    let mut steps: Vec<Step> = Vec::new();
    let mut strategy = strategies::begin(kind, method, settings, start)?;
    let mut asked = strategy.asks_first();
    if asked {
        doubt(method, settings, &strategy.state().lambda)?;
    }
    // The number of steps when the strategy began.
    let mut before = 0;
    let status = loop {
        if strategy.state().steps >= settings.max_it {
            break Status::ContactSteps;
        }
        if strategy.checkpoint() == Checkpoint::HandOver {
            let state = strategy.state().clone();
            drop(strategy);
            let kind = ContactType::AugmentedLagrangian;
            strategy = strategies::begin(kind, method, settings, Some(state))?;
            (before, asked) = (steps.len(), false);
        }
        let (step, proposal) = strategy.step()?;
        observe(&step, strategy.state())?;
        steps.push(step);
        if !asked && steps.len() - before == settings.tuning.doubt_after {
            asked = true;
            doubt(method, settings, &strategy.state().lambda)?;
        }
        if let Proposal::End(status) = proposal {
            break status;
        }
    };
    let found = strategy.finish(&steps, clock.elapsed().as_secs_f64(), status)?;
    if !found.status.converged() && !asked {
        doubt(method, settings, &found.lambda)?;
    }
    Ok((found, steps))
}

/// Asks whether there is a solution: returns an error that names bodies which the load pushes away for ever. Few rigid
/// motions are asked about before the loop, many only here, from the λ where the loop is: where it has failed or does
/// not end, and before a strategy that would go on for ever. Collective.
fn doubt(method: &LinearMethod, settings: &ContactSettings, lambda: &[f64]) -> Result<()> {
    let dual = method.dual();
    let load = Loads::new(&method.problem, &dual).kernel;
    Existence::new(method, &dual, settings).if_many(&load, lambda)
}
