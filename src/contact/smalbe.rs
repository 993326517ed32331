//! SMALBE-M: augmented Lagrangians for the balance of forces on floating bodies, MPRGP for the bounds (Dostál 2009,
//! chapter 7; with friction Dostál, Kozubek, Markopoulos, Brzobohatý, Vondrák and Horyl 2012).
//!
//! ```text
//!     min ½ λᵀF λ − λᵀd    subject to   Gᵀ λ = e,  λ_I ≥ 0,  |λ_t| ≤ g,     d = B S̃⁺ g − c, all candidate rows
//!     L(λ, μ) = ½ λᵀ(Pᵀ F P + ϱ (I − P)) λ − … + μᵀ Gᵀ λ
//! ```
//!
//! The variables are those of [`Augmented`], shifted by a λ̃ with Gᵀ λ̃ = e. SMALBE finds the rows that hold. Steps of
//! the active-set loop then solve the equations on these rows to the tolerance of the user, and judge the result. If
//! they change the set, SMALBE goes on with a tenth of its tolerance. Where its own steps lead nowhere, the augmented
//! Lagrangian of the rows (`lagrangian`) takes over.
//!
//! With friction g is that of Tresca's law, or follows from λ_n after each step (Coulomb). The loop on states
//! ([`Friction`](super::friction::Friction)) then takes the place of the active set. It may find no end where states
//! hang on rounding: SMALBE ends by itself where its residuals and the changes of g are within the tolerance.

use super::active_set::ActiveSet;
use super::course::DualCourse;
use super::friction;
use super::settings::ContactSettings;
use super::smalbe_iteration::SmalbeIteration;
use super::smalbe_trial::SmalbeTrial;
use super::state::{ActiveSetProgress, State, Step};
use super::strategy::{Checkpoint, Proposal, Strategy};
use crate::feti::krylov::iterate::KrylovRun;
use crate::feti::krylov::loads::Loads;
use crate::feti::{LinearMethod, LinearSolution};
use crate::status::Status;
use crate::Result;
use petsc::ConvergedReason;

/// The strategy.
pub(super) struct Smalbe<'a> {
    method: &'a LinearMethod,
    settings: &'a ContactSettings,
    /// Whether there is friction, or soft contact.
    friction: bool,
    rtol: f64,
    search: SmalbeIteration<'a>,
    state: State,
    /// The accuracy of SMALBE itself. It is tightened if the set that was found does not stay.
    accuracy: f64,
    /// Whether the last step was that accurate.
    settled: bool,
    /// Steps without a change of the set.
    unchanged: usize,
    /// How often the search went on from the end of a trial.
    jumps: usize,
    /// The residual when it was halved, or without friction when the last row changed, and the steps since then.
    best: (f64, usize),
    /// Whether the set of the last step is to be tried.
    promises: bool,
    trial: Option<SmalbeTrial<'a>>,
}

impl<'a> Smalbe<'a> {
    /// The search from `state`. Collective.
    ///
    /// # Errors
    /// PETSc's own.
    pub fn new(
        method: &'a LinearMethod,
        settings: &'a ContactSettings,
        state: State,
    ) -> Result<Smalbe<'a>> {
        let rtol = method.ksp.tolerances()?.0;
        Ok(Smalbe {
            method,
            settings,
            friction: friction::is_asked_for(method),
            rtol,
            search: SmalbeIteration::new(method, settings, &state)?,
            state,
            accuracy: rtol.sqrt().clamp(1e-6, 1e-2),
            settled: false,
            unchanged: 0,
            jumps: 0,
            best: (f64::INFINITY, 0),
            promises: false,
            trial: None,
        })
    }

    /// One step of SMALBE. Collective.
    fn advance(&mut self) -> Result<Step> {
        let comm = self.method.session.comm();
        let (step, settled) = self.search.advance(comm, &mut self.state, self.accuracy)?;
        self.settled = settled;
        self.unchanged = match step.entered + step.left {
            0 => self.unchanged + 1,
            _ => 0,
        };
        // Where several contacts hold a node, forces can go two ways, and states change for ever.
        let stays = self.friction || self.unchanged > 0;
        self.best = match self.best {
            (before, idle) if stays && step.residual > 0.5 * before => (before, idle + 1),
            _ => (step.residual, 0),
        };
        // A set that stays is tried even if μ is still far from its limit. The ascent of μ is slow where stiff bodies
        // hang on soft ones.
        self.promises = settled || self.unchanged == self.settings.tuning.smalbe_patience;
        Ok(step)
    }

    /// A trial of the set of the state. Collective.
    fn trial(&mut self) -> Result<SmalbeTrial<'a>> {
        self.search.a.face.forget();
        let start = State {
            safeguarded: false,
            progress: ActiveSetProgress::default(),
            ..self.state.clone()
        };
        let trial = SmalbeTrial::new(self.method, self.settings, &start, self.friction)?;
        self.state.reference = trial.state().reference;
        Ok(trial)
    }

    /// Goes on after a trial whose set did not stay. Collective.
    fn go_on(&mut self, trial: &SmalbeTrial) -> Result<()> {
        if self.settled {
            self.accuracy = (0.1 * self.accuracy).max(1e-13);
        }
        match trial {
            SmalbeTrial::Set(run, _) if self.jumps < self.settings.tuning.jumps => {
                self.jumps += 1;
                self.search.restart(self.method.session.comm(), run)?;
            }
            _ => {}
        }
        self.search.lagrangian = f64::NEG_INFINITY;
        Ok(())
    }
}

impl Strategy<DualCourse> for Smalbe<'_> {
    fn state(&self) -> &State {
        self.trial.as_ref().map_or(&self.state, SmalbeTrial::state)
    }

    fn asks_first(&self) -> bool {
        true
    }

    fn checkpoint(&self) -> Checkpoint {
        if self.trial.is_none() && self.best.1 >= self.settings.tuning.stalled {
            Checkpoint::HandOver
        } else {
            Checkpoint::Update
        }
    }

    fn step(&mut self) -> Result<(Step, Proposal<Status>)> {
        if let Some(trial) = self.trial.take_if(|t| t.is_in_vain(self.settings)) {
            self.go_on(&trial)?;
        }
        if std::mem::take(&mut self.promises) {
            self.trial = Some(self.trial()?);
        }
        let Some(trial) = &mut self.trial else {
            let step = self.advance()?;
            let ends = self.friction && self.settled && self.accuracy < 2.0 * self.rtol;
            return Ok((
                step,
                match ends {
                    true => Proposal::End(Status::Krylov(ConvergedReason::rtol())),
                    false => Proposal::GoOn,
                },
            ));
        };
        let (step, proposal) = trial.step()?;
        self.state.steps += 1;
        Ok((step, proposal))
    }

    fn finish(
        mut self: Box<Self>,
        steps: &[Step],
        seconds: f64,
        status: Status,
    ) -> Result<LinearSolution> {
        if let Some(trial) = self.trial.take() {
            return trial.finish(steps, seconds, status);
        }
        self.search.a.face.leave();
        if self.friction {
            let iterations = steps.iter().map(|s| s.iterations).sum();
            let run = KrylovRun::of_loop(iterations, status, Default::default());
            let loads = Loads::new(&self.method.problem, &self.method.dual());
            let tuning = &self.settings.tuning.friction;
            return friction::recovered(self.method, tuning, loads, &self.state, run, seconds);
        }
        let run = ActiveSet::new(self.method, self.settings, Some(&self.state))?;
        run.end(steps, seconds, status)
    }
}
