//! The augmented Lagrangian of the inequalities, minimised by damped Newton steps: but for rounding it ends
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
//! Where a minimisation has come to its end, or nearly, or few rows are wrong and their number does not fall, steps of
//! the active-set method try the set. They bring the answer to the tolerance of the user, mostly long before μ has
//! converged.

use std::time::Instant;

use super::active_set::{ActiveSet, ActiveSetChange};
use super::judge;
use super::semismooth_newton::{NewtonOutcome, SemismoothNewton};
use super::settings::ContactSettings;
use super::state::{ActiveSetProgress, Observer, State, Step};
use crate::feti::{LinearMethod, LinearSolution};
use crate::status::Status;
use crate::Result;

/// Number of minimisations that end where the set hardly changes any more. Later ones go to the end: then convergence
/// is proved.
const EARLY: usize = 8;

/// In a trial, a gap is violated only if it is above this many tolerances, relative to the largest displacement. Rows
/// without force come and go by rounding.
const OPEN: f64 = 0.1;

/// Steps without progress after which a trial ends. It also ends if more than a few rows are wrong
/// ([`SemismoothNewton::few`]).
const PATIENCE: usize = 1;

/// A minimisation that ends early with more wrong rows than this is not followed by a trial. A trial with no more has
/// twice the patience.
const CLOSE: usize = 4;

/// Steps in which the number of wrong rows does not fall, after which a set with few of them is tried before the
/// minimisation ends. Each trial that fails doubles it. Where springs are stiff, rows without force come and go by
/// rounding: 2,191 spheres take 97 steps without such trials, and 18 with them.
const FLICKER: usize = 1;

/// A step of a trial that is this much more exact than the best one counts wrong rows anew: it sees more of them.
const FINER: f64 = 0.1;

/// Least factor on the tolerance of a trial. It falls by [`FINER`] with each minimum whose set turns out to be wrong:
/// short waves of multipliers need more digits for their signs than displacements.
const MOST_DIGITS: f64 = 1e-4;

/// Steps after which the loop asks whether the rows can carry the load. Most loops have ended before.
const DOUBT: usize = 20;

/// Solves from `state`, after `steps` that took `seconds`. Collective.
pub(super) fn solve(
    method: &LinearMethod,
    settings: &ContactSettings,
    mut state: State,
    steps: Vec<Step>,
    seconds: f64,
    observe: &mut Observer,
) -> Result<(LinearSolution, Vec<Step>)> {
    state.safeguarded = true;
    let mut course = LagrangianLoop {
        method,
        settings,
        rtol: state.accuracy * method.ksp.tolerances()?.0,
        clock: Instant::now(),
        seconds,
        before: steps.len(),
        digits: 1.0,
        steps,
        observe,
    };
    let mut search = SemismoothNewton::new(method, &mut state)?;
    let (mut progress, mut patience) = (ActiveSetProgress::default(), FLICKER);
    for round in 0.. {
        let mut inner = 0;
        let (came, status, may_try) = loop {
            if state.steps >= settings.max_it {
                search.rigid();
                let run = ActiveSet::new(method, settings, Some(&state))?;
                return course.end(run, Status::ContactSteps);
            }
            let (step, status, came) = search.step(&mut state)?;
            let wrong = step.wrong;
            progress.note(wrong);
            course.note(step, &state)?;
            inner += 1;
            // A step that is as exact as rounding permits is a step.
            if !status.converged() && !status.broke_down() {
                return course.finish(search, status);
            }
            if matches!(came, NewtonOutcome::Down | NewtonOutcome::Nowhere) {
                break (came, status, true);
            }
            let early = round < EARLY && inner > 1 && came == NewtonOutcome::Near;
            let flickers = wrong <= search.few && progress.stalled(patience);
            if flickers {
                (progress, patience) = (ActiveSetProgress::default(), 2 * patience);
                if let Some((run, status)) = course.attempt(&search, &mut state, false)? {
                    return course.end(run, status);
                }
                search.soften();
            }
            if early {
                break (came, status, wrong <= CLOSE && !flickers);
            }
        };
        let minimal = came == NewtonOutcome::Down;
        // Where φ falls no more, rounding may have ended the last minimisation.
        let ended = minimal || (came == NewtonOutcome::Nowhere && progress.wrong() == 0);
        if ended && search.is_solution(course.rtol)? {
            let status = if status.converged() {
                status
            } else {
                Status::Rounding
            };
            return course.finish(search, status);
        }
        search.update(&mut state);
        if may_try {
            if let Some((run, status)) = course.attempt(&search, &mut state, minimal)? {
                return course.end(run, status);
            }
            if minimal {
                course.digits = (FINER * course.digits).max(MOST_DIGITS);
            }
        }
        search.stiffen();
    }
    unreachable!("the loop returns")
}

/// The steps so far, and what they go by.
struct LagrangianLoop<'a, 'o> {
    method: &'a LinearMethod,
    settings: &'a ContactSettings,
    rtol: f64,
    clock: Instant,
    /// Seconds that the steps before this search took.
    seconds: f64,
    /// All steps, and the number of those before.
    steps: Vec<Step>,
    before: usize,
    /// Factor on the tolerance of a trial of a minimum's set.
    digits: f64,
    observe: &'a mut Observer<'o>,
}

impl<'a> LagrangianLoop<'a, '_> {
    fn note(&mut self, step: Step, state: &State) -> Result<()> {
        (self.observe)(&step, state)?;
        self.steps.push(step);
        match self.steps.len() - self.before {
            DOUBT => super::ask(self.method, &state.lambda),
            _ => Ok(()),
        }
    }

    fn elapsed(&self) -> f64 {
        self.seconds + self.clock.elapsed().as_secs_f64()
    }

    fn finish(
        self,
        search: SemismoothNewton,
        status: Status,
    ) -> Result<(LinearSolution, Vec<Step>)> {
        let seconds = self.elapsed();
        let found = search.finish(&self.steps, seconds, status)?;
        self.answer(found)
    }

    fn end(self, run: ActiveSet, status: Status) -> Result<(LinearSolution, Vec<Step>)> {
        let seconds = self.elapsed();
        let found = run.finish(&self.steps, seconds, status)?;
        self.answer(found)
    }

    /// Before a loop that has not converged says so, it asks whether there is a solution.
    fn answer(self, found: LinearSolution) -> Result<(LinearSolution, Vec<Step>)> {
        if !found.status.converged() && self.steps.len() < self.before + DOUBT {
            super::ask(self.method, &found.lambda)?;
        }
        Ok((found, self.steps))
    }

    /// Steps of the active-set method from the set of `state`, which is that of a minimum if it is `minimal`. Returns
    /// the run if it has come to an end. It leaves the rows rigid. Collective.
    fn attempt(
        &mut self,
        search: &SemismoothNewton,
        state: &mut State,
        minimal: bool,
    ) -> Result<Option<(ActiveSet<'a>, Status)>> {
        search.rigid();
        let trial = State {
            safeguarded: false,
            progress: ActiveSetProgress::default(),
            accuracy: if minimal {
                self.digits * state.accuracy
            } else {
                state.accuracy
            },
            ..state.clone()
        };
        let mut run = ActiveSet::new(self.method, self.settings, Some(&trial))?;
        run.open = (OPEN * self.rtol).max(judge::ROUNDING);
        run.exact = true;
        // A set that is the minimum's is solved to the end at once.
        run.tight = minimal;
        run.length = search.length;
        let mut best: Option<(usize, f64)> = None;
        while state.steps < self.settings.max_it {
            let (step, status, verdict) = run.step()?;
            state.steps += 1;
            let (wrong, tolerance) = (step.wrong, step.tolerance);
            match best {
                Some((fewest, of)) if wrong >= fewest && tolerance > FINER * of => {}
                _ => {
                    best = Some((wrong, tolerance));
                    run.state.progress.begin(wrong);
                }
            }
            let kept = State {
                lambda: run.state.lambda.clone(),
                before: run.state.before.clone(),
                ..state.clone()
            };
            self.note(step, &kept)?;
            if status.broke_down() {
                break;
            }
            if verdict == ActiveSetChange::Solved || !status.converged() {
                return Ok(Some((run, status)));
            }
            let patience = if run.state.progress.wrong() > CLOSE {
                PATIENCE
            } else {
                2 * PATIENCE
            };
            let lost = run.state.progress.wrong() > search.few;
            if lost || run.state.safeguarded || run.state.progress.stalled(patience) {
                break;
            }
        }
        Ok(None)
    }
}
