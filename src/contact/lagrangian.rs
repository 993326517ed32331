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

use super::active_set::{ActiveSet, ActiveSetChange};
use super::course::DualCourse;
use super::semismooth_newton::{NewtonOutcome, SemismoothNewton};
use super::settings::ContactSettings;
use super::state::{ActiveSetProgress, State, Step};
use super::strategy::{Proposal, Strategy};
use super::tuning::Tuning;
use crate::feti::{LinearMethod, LinearSolution};
use crate::status::Status;
use crate::Result;

/// The next step.
enum NextStep<'a> {
    /// A Newton step of the minimisation that goes on.
    Newton,
    /// The first of a new minimisation, or a trial before it: the last one has come to its minimum if it is `minimal`.
    Minimised { minimal: bool, tried: bool },
    /// A step of a trial.
    Trial(Box<Trial<'a>>),
    /// The one after a trial that has failed.
    Failed(AfterTrial),
}

impl NextStep<'_> {
    /// Whether a minimisation has ended, and its multipliers wait for their update.
    fn is_minimised(&self) -> bool {
        let after = match self {
            NextStep::Minimised { .. } => return true,
            NextStep::Newton => return false,
            NextStep::Trial(trial) => trial.after,
            NextStep::Failed(after) => *after,
        };
        matches!(after, AfterTrial::Soften { early: true })
    }
}

/// The way on after a trial that fails.
#[derive(Debug, Clone, Copy)]
enum AfterTrial {
    /// The minimisation goes on, or has ended `early`.
    Soften { early: bool },
    /// The next minimisation. The trial was that of a minimum if it is `minimal`.
    Stiffen { minimal: bool },
}

/// Steps of the active-set method from a set of the search.
struct Trial<'a> {
    run: ActiveSet<'a>,
    /// The fewest wrong rows so far, and the tolerance of the step that saw them.
    best: Option<(usize, f64)>,
    after: AfterTrial,
}

/// Where the strategy has ended.
enum End<'a> {
    /// In the search.
    Search,
    /// In a trial.
    Trial(Box<Trial<'a>>),
}

/// The strategy.
pub(super) struct AugmentedLagrangian<'a> {
    method: &'a LinearMethod,
    settings: &'a ContactSettings,
    rtol: f64,
    search: SemismoothNewton<'a>,
    state: State,
    /// The state during a trial, with the multipliers and the set of its last step.
    trial_state: Option<State>,
    next: NextStep<'a>,
    end: Option<End<'a>>,
    /// Minimisations so far, and Newton steps of the present one.
    round: usize,
    inner: usize,
    progress: ActiveSetProgress,
    /// Steps without progress after which a set is tried.
    patience: usize,
    /// Factor on the tolerance of a trial of a minimum's set.
    digits: f64,
}

impl<'a> AugmentedLagrangian<'a> {
    /// The search from `state`. Collective.
    ///
    /// # Errors
    /// Bodies that the load pushes away for ever; PETSc's own errors.
    pub fn new(
        method: &'a LinearMethod,
        settings: &'a ContactSettings,
        mut state: State,
    ) -> Result<AugmentedLagrangian<'a>> {
        state.safeguarded = true;
        Ok(AugmentedLagrangian {
            rtol: state.accuracy * method.ksp.tolerances()?.0,
            search: SemismoothNewton::new(method, settings, &mut state)?,
            method,
            settings,
            state,
            trial_state: None,
            next: NextStep::Newton,
            end: None,
            round: 0,
            inner: 0,
            progress: ActiveSetProgress::default(),
            patience: settings.tuning.flicker,
            digits: 1.0,
        })
    }

    /// A Newton step, and what follows it. Collective.
    fn newton(&mut self) -> Result<(Step, Proposal<Status>)> {
        let (step, status, came) = self.search.step(&mut self.state)?;
        let wrong = step.wrong;
        self.progress.note(wrong);
        self.inner += 1;
        // A step that is as exact as rounding permits is a step.
        if !status.converged() && !status.broke_down() {
            self.end = Some(End::Search);
            return Ok((step, Proposal::End(status)));
        }
        let minimal = came == NewtonOutcome::Down;
        if minimal || came == NewtonOutcome::Nowhere {
            // Where φ falls no more, rounding may have ended the last minimisation.
            let ended = minimal || self.progress.wrong() == 0;
            if ended && self.search.is_solution(self.rtol)? {
                let status = if status.converged() {
                    status
                } else {
                    Status::Rounding
                };
                self.end = Some(End::Search);
                return Ok((step, Proposal::End(status)));
            }
            let tried = true;
            self.next = NextStep::Minimised { minimal, tried };
            return Ok((step, Proposal::GoOn));
        }
        let early = self.round < self.settings.tuning.early
            && self.inner > 1
            && came == NewtonOutcome::Near;
        if wrong <= self.search.few && self.progress.stalled(self.patience) {
            (self.progress, self.patience) = (ActiveSetProgress::default(), 2 * self.patience);
            let trial = self.trial(false, AfterTrial::Soften { early })?;
            self.next = NextStep::Trial(trial);
        } else if early {
            let tried = wrong <= self.settings.tuning.close;
            self.next = NextStep::Minimised {
                minimal: false,
                tried,
            };
        }
        Ok((step, Proposal::GoOn))
    }

    /// A trial of the set of the state, which is that of a minimum if it is `minimal`. It makes the rows rigid.
    /// Collective.
    fn trial(&self, minimal: bool, after: AfterTrial) -> Result<Box<Trial<'a>>> {
        self.search.rigid();
        let accuracy = if minimal {
            self.digits * self.state.accuracy
        } else {
            self.state.accuracy
        };
        let start = State {
            safeguarded: false,
            progress: ActiveSetProgress::default(),
            accuracy,
            ..self.state.clone()
        };
        let mut run = ActiveSet::new(self.method, self.settings, Some(&start))?;
        let tuning = &self.settings.tuning;
        run.open = (tuning.open_in_trial * self.rtol).max(tuning.rounding);
        run.exact = true;
        // A set that is the minimum's is solved to the end at once.
        run.tight = minimal;
        run.length = self.search.length;
        let best = None;
        Ok(Box::new(Trial { run, best, after }))
    }

    /// A step of a trial, and what follows it. Collective.
    fn try_set(&mut self, mut trial: Box<Trial<'a>>) -> Result<(Step, Proposal<Status>)> {
        let run = &mut trial.run;
        let (step, status, change) = run.try_set()?;
        self.state.steps += 1;
        let (wrong, tolerance) = (step.wrong, step.tolerance);
        let &Tuning {
            finer,
            close,
            trial_patience,
            ..
        } = &self.settings.tuning;
        // A step that is much coarser than the best one does not see all wrong rows: fewer of them are no progress.
        let better = trial.best.is_none_or(|(fewest, of)| {
            tolerance <= finer * of || (wrong < fewest && finer * tolerance <= of)
        });
        if better {
            trial.best = Some((wrong, tolerance));
            run.state.progress.begin(wrong);
        }
        self.trial_state = Some(State {
            lambda: run.state.lambda.clone(),
            before: run.state.before.clone(),
            ..self.state.clone()
        });
        let ends = change == ActiveSetChange::Solved || !status.converged();
        if ends && !status.broke_down() {
            self.end = Some(End::Trial(trial));
            return Ok((step, Proposal::End(status)));
        }
        let progress = &run.state.progress;
        let patience = if progress.wrong() > close {
            trial_patience
        } else {
            2 * trial_patience
        };
        let lost = progress.wrong() > self.search.few || run.state.safeguarded;
        let fails = status.broke_down() || lost || progress.stalled(patience);
        self.next = if fails {
            NextStep::Failed(trial.after)
        } else {
            NextStep::Trial(trial)
        };
        Ok((step, Proposal::GoOn))
    }

    /// Goes on after a trial that has failed. Collective.
    fn go_on(&mut self, after: AfterTrial) {
        match after {
            AfterTrial::Soften { early } => {
                self.search.soften();
                if early {
                    let (minimal, tried) = (false, false);
                    self.next = NextStep::Minimised { minimal, tried };
                }
            }
            AfterTrial::Stiffen { minimal } => {
                if minimal {
                    let tuning = &self.settings.tuning;
                    self.digits = (tuning.finer * self.digits).max(tuning.most_digits);
                }
                self.stiffen();
            }
        }
    }

    /// Begins the next minimisation. Collective.
    fn stiffen(&mut self) {
        self.search.stiffen();
        (self.round, self.inner) = (self.round + 1, 0);
    }
}

impl Strategy<DualCourse> for AugmentedLagrangian<'_> {
    fn state(&self) -> &State {
        self.trial_state.as_ref().unwrap_or(&self.state)
    }

    fn step(&mut self) -> Result<(Step, Proposal<Status>)> {
        loop {
            match std::mem::replace(&mut self.next, NextStep::Newton) {
                NextStep::Trial(trial) => return self.try_set(trial),
                NextStep::Newton => {
                    self.trial_state = None;
                    return self.newton();
                }
                NextStep::Minimised { minimal, tried } => {
                    self.search.update(&mut self.state);
                    if tried {
                        let trial = self.trial(minimal, AfterTrial::Stiffen { minimal })?;
                        self.next = NextStep::Trial(trial);
                    } else {
                        self.stiffen();
                    }
                }
                NextStep::Failed(after) => self.go_on(after),
            }
        }
    }

    fn finish(
        mut self: Box<Self>,
        steps: &[Step],
        seconds: f64,
        status: Status,
    ) -> Result<LinearSolution> {
        match self.end {
            Some(End::Search) => self.search.finish(steps, seconds, status),
            Some(End::Trial(trial)) => trial.run.end(steps, seconds, status),
            // The steps that are allowed have come to an end before the search.
            None => {
                if self.next.is_minimised() {
                    self.search.update(&mut self.state);
                }
                self.search.rigid();
                let run = ActiveSet::new(self.method, self.settings, Some(&self.state))?;
                run.end(steps, seconds, status)
            }
        }
    }
}
