//! A trial: the loop on states from where another strategy is, followed for as long as it comes nearer.

use super::Friction;
use crate::contact::settings::ContactSettings;
use crate::contact::state::{ActiveSetProgress, State, Step};
use crate::contact::strategy::{Proposal, Strategy};
use crate::feti::{LinearMethod, LinearSolution};
use crate::status::Status;
use crate::Result;

/// The trial.
pub struct StatesTrial<'a> {
    run: Box<Friction<'a>>,
    wrong: ActiveSetProgress,
    /// Steps without fewer wrong nodes and rows, after which it is in vain.
    most: usize,
    /// Whether its equations were not solved.
    broken: bool,
}

impl<'a> StatesTrial<'a> {
    /// The trial of the states that `start` has. Collective.
    ///
    /// # Errors
    /// PETSc's own.
    pub fn new(
        method: &'a LinearMethod,
        settings: &'a ContactSettings,
        start: &State,
    ) -> Result<StatesTrial<'a>> {
        Ok(StatesTrial {
            run: Box::new(Friction::new(method, settings, Some(start))?),
            wrong: ActiveSetProgress::default(),
            most: settings.tuning.friction.tried,
            broken: false,
        })
    }

    /// Where it is.
    pub fn state(&self) -> &State {
        self.run.state()
    }

    /// Whether it is to be given up.
    pub fn is_in_vain(&self) -> bool {
        self.broken || self.wrong.stalled(self.most) || self.run.state().safeguarded
    }

    /// A step. It ends with a solution alone. Collective.
    ///
    /// # Errors
    /// Bodies that the load pushes away for ever; PETSc's own errors.
    pub fn step(&mut self) -> Result<(Step, Proposal<Status>)> {
        let (step, proposal) = self.run.step()?;
        self.wrong.note(step.wrong);
        self.broken = matches!(&proposal, Proposal::End(s) if !s.converged());
        match self.broken {
            true => Ok((step, Proposal::GoOn)),
            false => Ok((step, proposal)),
        }
    }

    /// The solution where it is. Collective.
    ///
    /// # Errors
    /// PETSc's own.
    pub fn finish(self, steps: &[Step], seconds: f64, status: Status) -> Result<LinearSolution> {
        self.run.finish(steps, seconds, status)
    }
}
