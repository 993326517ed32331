//! The primal-dual active set method (docs/theory.md, section 9).
//!
//! ```text
//!     solve the equations on A_k,    A_{k+1} = { j : λ_j + ρ (B u − c)_j > 0 }
//! ```
//!
//! On A_k the gap B u − c vanishes and off it λ vanishes, so that ρ plays no part. The loop starts from all candidates,
//! because a smaller set is singular if only contact holds a body. While the set changes, the inner problem is solved
//! loosely, starting from the last λ. A set that stays is solved to the end; it is the solution if it stays then, too.
//! A row whose multiplier turns out to pull ends that solve early.
//! Nothing makes the sets converge. Where the number of wrong rows does not fall for some steps, the loop hands over to
//! the augmented Lagrangian.

mod next_set;

use std::time::Instant;

use super::course::DualCourse;
use super::existence::Existence;
use super::judge::JudgeSizes;
use super::pull_monitor::PullMonitor;
use super::repairs::Repairs;
use super::settings::{ContactSettings, ContactType};
use super::state::{changes, State, Step};
use super::strategy::{Checkpoint, Proposal, Strategy};
use crate::feti::krylov::iterate::{IterateMonitor, IterationControl, KrylovRun};
use crate::feti::krylov::loads::Loads;
use crate::feti::krylov::residual::{Iterate, ROUNDING};
use crate::feti::krylov::target::{target, to_the_end};
use crate::feti::projector::balance::KernelLoad;
use crate::feti::{LinearMethod, LinearSolution, Spectrum};
use crate::status::Status;
use crate::Result;
use petsc::{Stopped, Vec as PetscVec};

/// The verdict after a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ActiveSetChange {
    /// The set stays at the tolerance of the user.
    Solved,
    /// The loop must go on.
    GoOn,
}

/// The data of the loop.
pub(super) struct ActiveSet<'a> {
    method: &'a LinearMethod,
    settings: &'a ContactSettings,
    repairs: Repairs<'a>,
    pub state: State,
    pub at: Iterate,
    /// Whether the residual of `at` belongs to its λ and the set that holds.
    fresh: bool,
    /// The largest displacement in the last step.
    pub length: f64,
    /// Whether inner problems are solved more exactly than the settings say.
    pub exact: bool,
    /// Whether the next step is solved to the end.
    pub tight: bool,
    /// Factor on the reduction of the residual while the set changes.
    pub finer: f64,
    /// Whether rows that pull end that solve early.
    watched: bool,
    /// A row that does not hold is violated only if its gap is above this, relative to the largest displacement.
    pub open: f64,
    /// Whether `at` has the displacements that belong to its λ, rigid motions included.
    placed: bool,
    /// Number of rows over all ranks, m.
    n_rows: usize,
    /// No tolerance is below this: rounding of the problem's scale.
    least: f64,
    /// Sizes of the problem beside which multipliers and gaps are rounding.
    sizes: JudgeSizes,
    /// The compliance of springs in the owned rows, beside that of the rows themselves; empty without springs.
    pub springs: Vec<f64>,
    /// B u − c on the owned rows after the last step, and whether each of them held in it.
    pub gaps: Vec<f64>,
    pub held: Vec<bool>,
    /// Krylov residuals and spectrum of the last step that iterated.
    last: (Vec<f64>, Option<Spectrum>),
}

impl<'a> ActiveSet<'a> {
    pub fn new(
        method: &'a LinearMethod,
        settings: &'a ContactSettings,
        start: Option<&State>,
    ) -> Result<ActiveSet<'a>> {
        let (problem, dual) = (&method.problem, method.dual());
        let jump = &dual.stiffness.jump;
        let loads = Loads::new(problem, &dual);
        let state = start.cloned().unwrap_or_else(|| State::cold(jump));
        // Who gives a reference has asked for these loads before.
        if state.reference == 0.0 {
            Existence::new(method, &dual, settings).if_few(&loads.kernel)?;
        }
        let n_rows = jump.n_global;
        let sizes = JudgeSizes::of(&dual, problem);
        let at = Iterate::new(&dual, loads)?;
        drop(dual);
        let mut run = ActiveSet {
            method,
            settings,
            repairs: Repairs::new(method, settings),
            fresh: false,
            tight: false,
            watched: true,
            exact: false,
            finer: 1.0,
            open: settings.tuning.rounding,
            length: 0.0,
            state,
            at,
            n_rows,
            least: method.least_residual(),
            sizes,
            placed: false,
            springs: Vec::new(),
            gaps: Vec::new(),
            held: Vec::new(),
            last: (Vec::new(), None),
        };
        if start.is_some() {
            let dual = method.dual();
            let (active, lambda) = (&mut run.state.active, &run.state.lambda);
            let load = &run.at.loads.kernel;
            run.repairs.hold(&dual, active, &|r| lambda[r], load)?;
        }
        if run.state.reference == 0.0 {
            run.state.reference = run.reference()?;
            // A cold start begins at the λ for which the reference was computed.
            run.fresh = start.is_none();
        }
        if !run.fresh {
            let mut lambda = run.at.lambda.array_mut()?;
            lambda.copy_from_slice(&run.state.lambda);
        }
        Ok(run)
    }

    /// ‖Pᵀ r‖ at λ₀ with all candidates active. Tolerances are relative to it, whatever λ the loop starts from.
    fn reference(&mut self) -> Result<f64> {
        let method = self.method;
        let all = State::cold(&method.dual().stiffness.jump).active;
        method.set_active(&all)?;
        let dual = method.dual();
        self.at.lambda.set(0.0)?;
        Existence::new(method, &dual, self.settings).reference(&mut self.at)
    }

    /// Reduction of the residual while the set changes.
    fn reduction(&self) -> f64 {
        let (progress, tuning) = (&self.state.progress, &self.settings.tuning);
        let misled = progress.stalled(tuning.misled_after) && progress.wrong() > tuning.misled_rows;
        let factor = match (self.exact, misled) {
            (true, _) => tuning.exact_reduction,
            (false, true) => tuning.misled_reduction,
            (false, false) => 1.0,
        };
        factor * self.finer * self.settings.inner_rtol
    }

    /// The tolerance of the residual, from the displacements of the last step.
    fn target(&self) -> Result<f64> {
        let ksp = &self.method.ksp;
        let target = target(ksp, self.state.reference, self.length, self.n_rows)?;
        Ok((self.state.accuracy * target).max(self.rounding()))
    }

    /// No residual falls below this.
    fn rounding(&self) -> f64 {
        self.least.max(ROUNDING * self.at.residual.size)
    }

    /// One outer step: solves the equations on the set, then determines the next set.
    pub fn try_set(&mut self) -> Result<(Step, Status, ActiveSetChange)> {
        let clock = Instant::now();
        let (session, method) = (&self.method.session, self.method);
        let changed = method.set_active(&self.state.active)?;
        let dual = method.dual();
        if changed > 0 || !self.fresh {
            let mut lambda = self.at.lambda.array_mut()?;
            dual.stiffness.jump.release(&self.state.active, &mut lambda);
            drop(lambda);
            self.at.begin(&dual)?;
            self.at.evaluate(&dual)?;
        }
        dual.p_transpose(&self.at.residual.r)?;
        drop(dual);

        let first = self.at.residual.r.norm2()?;
        let target = self.target()?;
        let reduced = self.reduction() * first;
        // A last reduction is taken in one go: to begin anew in its middle costs more than it may save.
        let tight = self.tight || target >= self.settings.tuning.near * first;
        let tolerance = match (tight, self.exact) {
            (true, false) => target,
            // Multipliers of springs are those of the rows only up to the compliance. Between stiff bodies the
            // difference is a large force and a small residual.
            (true, true) => target.min(reduced).max(self.rounding()),
            (false, _) => target.max(reduced),
        };
        let control = IterationControl::to(tolerance, self.at.residual.size);
        let mut pulling = PullMonitor::new(
            session.comm(),
            &method.dual().stiffness.jump,
            &self.at,
            self.settings.tuning.rounding,
            self.sizes.load,
        )?;
        let mut look = |lambda: &PetscVec| pulling.lasts(lambda);
        let watched = tight && !self.exact && self.watched;
        let look: Option<&mut IterateMonitor> = if watched { Some(&mut look) } else { None };
        let inner = method.reach(&mut self.at, control, look)?;
        let ended_early = inner.stopped == Stopped::Look;
        let tolerance = match inner.residuals.last() {
            Some(&reached) if ended_early => reached.max(tolerance),
            _ => tolerance,
        };
        let dual = method.dual();
        self.at.evaluate(&dual)?;
        let next = self.next(&dual)?;
        drop(dual);

        let comm = session.comm();
        let rows = method.dual().stiffness.jump.rows_between_bodies();
        let (was, now) = (&self.state.before, &self.state.active);
        let [active, entered, left] = changes(comm, &was[rows.clone()], &now[rows]);
        let exact = if method.settings.spectrum {
            method.spectrum()?
        } else {
            None
        };
        let relative = |r: f64| match self.state.reference {
            reference if reference > 0.0 => r / reference,
            _ => r,
        };
        let step = Step {
            method: ContactType::ActiveSet,
            active,
            entered,
            left,
            iterations: inner.iterations,
            estimate: inner.estimate,
            exact,
            residual: relative(*inner.residuals.last().unwrap_or(&first)),
            tolerance: relative(tolerance),
            wrong: next.wrong,
            seconds: clock.elapsed().as_secs_f64(),
        };
        if inner.iterations > 0 || self.last.0.is_empty() {
            self.last = (inner.residuals.clone(), inner.estimate);
        }
        // The tolerance from the new displacements.
        let target = self.target()?;
        let to_the_end = to_the_end(tolerance, target);
        let closed = self.closed(next.jump_left, target);
        let verdict = self.advance(next, to_the_end, closed)?;
        // The same set once more: the rows that pull cannot be spared.
        self.watched = !(ended_early && self.tight);
        Ok((step, inner.status, verdict))
    }

    /// Whether the jumps that rigid motions leave are as small as the residual, or rounding. The interface of a soft
    /// body on a stiff one hardly moves, but its forces are rounded like those inside. Collective.
    fn closed(&self, jump_left: f64, target: f64) -> bool {
        let (give, tuning) = (self.sizes.give, &self.settings.tuning);
        let beyond = |length: f64| {
            jump_left > tuning.closed * target + 1e3 * tuning.rounding * length.max(give)
        };
        // It takes a solve to know how far the inside moves: only where the interface does not settle it.
        !beyond(self.length) || {
            let inside = self.at.loads.largest_inside(&self.method.dual());
            !beyond(inside.max(self.length))
        }
    }

    /// Notes that the loads are others than those of the last step.
    pub fn renewed(&mut self) {
        self.fresh = false;
    }

    /// Puts rows into `active` so that the load drives no body away, tangential ones with these scores. Collective.
    ///
    /// # Errors
    /// Bodies that the load pushes away for ever.
    pub fn hold(&self, active: &mut [bool], load: &KernelLoad, friction: &[f64]) -> Result<usize> {
        let dual = self.method.dual();
        let (gaps, law) = (&self.gaps, &dual.stiffness.jump.law);
        let score = |r: usize| match law[r].is_friction() {
            true => friction[r],
            false => self.state.lambda[r] + gaps[r],
        };
        self.repairs.hold(&dual, active, &score, load)
    }

    /// Says which bodies slide away where tangential rows hold none but those in `active`: `load` has given forces of
    /// friction, and `alone` none. Collective.
    ///
    /// # Errors
    /// Such bodies.
    pub fn sliding(
        &self,
        active: &mut [bool],
        (load, alone): (&KernelLoad, &KernelLoad),
    ) -> Result<()> {
        let dual = self.method.dual();
        let (gaps, law) = (&self.gaps, &dual.stiffness.jump.law);
        let score = |r: usize| match law[r].is_friction() {
            true => f64::NEG_INFINITY,
            false => self.state.lambda[r] + gaps[r],
        };
        self.repairs.sliding(&dual, active, &score, (load, alone))
    }

    /// The solution at the present state of the loop, after these steps. Collective.
    pub fn end(
        mut self,
        steps: &[Step],
        solve_seconds: f64,
        status: Status,
    ) -> Result<LinearSolution> {
        let method = self.method;
        if !self.placed {
            self.at.place(&method.dual())?;
        }
        let iterations = steps.iter().map(|s| s.iterations).sum();
        let run = KrylovRun::of_loop(iterations, status, self.last);
        method.recover(self.at, run, solve_seconds)
    }
}

impl Strategy<DualCourse> for ActiveSet<'_> {
    fn state(&self) -> &State {
        &self.state
    }

    fn checkpoint(&self) -> Checkpoint {
        if self.state.safeguarded {
            Checkpoint::HandOver
        } else {
            Checkpoint::Update
        }
    }

    fn step(&mut self) -> Result<(Step, Proposal<Status>)> {
        let is_last = self.tight;
        let (step, status, change) = self.try_set()?;
        // The equations of a set on the way may contradict each other, and then have no solution. Springs have one.
        if status.broke_down() && !is_last {
            let cold = State::cold(&self.method.dual().stiffness.jump);
            self.state = State {
                reference: self.state.reference,
                steps: self.state.steps,
                accuracy: self.state.accuracy,
                safeguarded: true,
                ..cold
            };
            return Ok((step, Proposal::GoOn));
        }
        let ends = !status.converged() || change == ActiveSetChange::Solved;
        let proposal = if ends {
            Proposal::End(status)
        } else {
            Proposal::GoOn
        };
        Ok((step, proposal))
    }

    fn finish(
        self: Box<Self>,
        steps: &[Step],
        seconds: f64,
        status: Status,
    ) -> Result<LinearSolution> {
        self.end(steps, seconds, status)
    }
}
