//! The contact loop on one page: propose, solve, judge, step, certify, doubt.
//!
//! A [`Strategy`] proposes steps. The driver lets it make them, counts, observes, times and stops. The certificate has
//! the last word: rows that it finds on the wrong side send the loop on. What the equations are, and who solves them,
//! is the matter of an [`InnerProblem`].

use std::time::Instant;

pub use super::inner::{Begin, Begun, InnerProblem, Verdict};
pub use super::strategy::{Checkpoint, Course, Proposal, Strategy};
use crate::Result;

type State<P> = <<P as InnerProblem>::Course as Course>::State;
type Step<P> = <<P as InnerProblem>::Course as Course>::Step;
/// Called after each step.
pub type Watch<'w, P> = dyn FnMut(&Step<P>, &State<P>) -> Result<()> + 'w;
type Solution<P> = <<P as InnerProblem>::Course as Course>::Solution;

/// Solves a problem with its inequalities, from a state or from scratch. Returns the solution and the steps of the
/// loop; `observe` sees each of them. Collective.
///
/// # Errors
/// Bodies that the load pushes away for ever, PETSc's own errors, and those of `observe`.
pub fn solve<P: InnerProblem>(
    problem: &P,
    start: Option<State<P>>,
    observe: &mut Watch<P>,
) -> Result<(Solution<P>, Vec<Step<P>>)> {
    let (mut found, mut steps) = follow(problem, Begin::First(start), observe)?;
    for round in 0.. {
        match problem.certify(found, steps.len(), round)? {
            Verdict::Done(certified) => return Ok((certified, steps)),
            Verdict::Wrong(state, certified) => {
                let (next, more) = follow(problem, Begin::Again(state), observe)?;
                steps.extend(more);
                found = problem.joined(&certified, next);
            }
        }
    }
    unreachable!("a problem ends the rounds of its certificate")
}

/// Follows a strategy, and those to which it hands over, to the end. The result has no certificate. Collective.
fn follow<P: InnerProblem>(
    problem: &P,
    begin: Begin<State<P>>,
    observe: &mut Watch<P>,
) -> Result<(Solution<P>, Vec<Step<P>>)> {
    let clock = Instant::now();
    let mut steps: Vec<Step<P>> = Vec::new();
    let mut strategy = problem.begin(begin)?;
    let mut asked = strategy.asks_first();
    if asked {
        problem.doubt(strategy.state())?;
    }
    // The number of steps when the strategy began.
    let mut before = 0;
    let end = loop {
        if let Some(end) = problem.stop(strategy.state()) {
            break end;
        }
        if strategy.checkpoint() == Checkpoint::HandOver {
            let state = strategy.state().clone();
            drop(strategy);
            strategy = problem.begin(Begin::HandOver(state))?;
            (before, asked) = (steps.len(), false);
        }
        let (step, proposal) = strategy.step()?;
        observe(&step, strategy.state())?;
        steps.push(step);
        if !asked && problem.is_doubtful(steps.len() - before) {
            asked = true;
            problem.doubt(strategy.state())?;
        }
        if let Proposal::End(end) = proposal {
            break end;
        }
    };
    let found = strategy.finish(&steps, clock.elapsed().as_secs_f64(), end)?;
    if !asked {
        problem.doubt_end(&found)?;
    }
    Ok((found, steps))
}
