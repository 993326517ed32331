//! A trial of what SMALBE has found: the loop on sets or, with friction, that on states, from where SMALBE is. It
//! solves the equations to the tolerance of the user, and judges the result.

use super::active_set::ActiveSet;
use super::friction::StatesTrial;
use super::settings::ContactSettings;
use super::state::{State, Step};
use super::strategy::{Proposal, Strategy};
use crate::feti::{LinearMethod, LinearSolution};
use crate::status::Status;
use crate::Result;

/// A trial.
pub(super) enum SmalbeTrial<'a> {
    /// Of a set, with the steps so far.
    Set(Box<ActiveSet<'a>>, usize),
    /// Of states of nodes.
    States(StatesTrial<'a>),
}

impl<'a> SmalbeTrial<'a> {
    /// The trial of the set, or with `friction` of the states, that `start` has. Collective.
    ///
    /// # Errors
    /// PETSc's own.
    pub fn new(
        method: &'a LinearMethod,
        settings: &'a ContactSettings,
        start: &State,
        friction: bool,
    ) -> Result<SmalbeTrial<'a>> {
        if friction {
            let run = StatesTrial::new(method, settings, start)?;
            return Ok(SmalbeTrial::States(run));
        }
        let mut run = ActiveSet::new(method, settings, Some(start))?;
        let (tuning, rtol) = (&settings.tuning, method.ksp.tolerances()?.0);
        run.open = (tuning.open_in_trial * rtol).max(tuning.rounding);
        Ok(SmalbeTrial::Set(run.into(), 0))
    }

    /// Where it is.
    pub fn state(&self) -> &State {
        match self {
            SmalbeTrial::Set(run, _) => &run.state,
            SmalbeTrial::States(run) => run.state(),
        }
    }

    /// Whether it has not come to an end and is given up: a set after a few steps, states once they come no nearer.
    pub fn is_in_vain(&self, settings: &ContactSettings) -> bool {
        match self {
            SmalbeTrial::Set(_, steps) => *steps == settings.tuning.closing_steps,
            SmalbeTrial::States(run) => run.is_in_vain(),
        }
    }

    /// A step. Collective.
    ///
    /// # Errors
    /// Bodies that the load pushes away for ever; PETSc's own errors.
    pub fn step(&mut self) -> Result<(Step, Proposal<Status>)> {
        match self {
            SmalbeTrial::Set(run, steps) => {
                run.tight = true;
                *steps += 1;
                run.step()
            }
            SmalbeTrial::States(run) => run.step(),
        }
    }

    /// The solution where it is. Collective.
    ///
    /// # Errors
    /// PETSc's own.
    pub fn finish(self, steps: &[Step], seconds: f64, status: Status) -> Result<LinearSolution> {
        match self {
            SmalbeTrial::Set(run, _) => run.end(steps, seconds, status),
            SmalbeTrial::States(run) => run.finish(steps, seconds, status),
        }
    }
}
