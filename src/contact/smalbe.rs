//! SMALBE-M: augmented Lagrangians for the balance of forces on floating bodies, MPRGP for the bounds (Dostál 2009,
//! chapter 7).
//!
//! ```text
//!     min ½ λᵀF λ − λᵀd    subject to   Gᵀ λ = e,  λ_I ≥ 0,     d = B S̃⁺ g − c, all candidate rows
//!     L(λ, μ) = ½ λᵀ(Pᵀ F P + ϱ (I − P)) λ − … + μᵀ Gᵀ λ
//! ```
//!
//! The variables are those of [`Augmented`], shifted by a λ̃ with Gᵀ λ̃ = e. SMALBE finds the rows that hold. Steps of
//! the active-set loop then solve the equations on these rows to the tolerance of the user, and judge the result. If
//! they change the set, SMALBE goes on with a tenth of its tolerance. Where its own steps lead nowhere, the augmented
//! Lagrangian of the rows (`lagrangian`) takes over.

use std::time::Instant;

use mpi::topology::SimpleCommunicator;

use super::active_set::ActiveSet;
use super::augmented::Augmented;
use super::course::DualCourse;
use super::mprgp::{BoundedQuadratic, Setting};
use super::settings::{ContactSettings, ContactType};
use super::state::{changes, ActiveSetProgress, State, Step};
use super::strategy::{Checkpoint, Proposal, Strategy};
use super::tuning::Tuning;
use crate::feti::krylov::loads::Loads;
use crate::feti::krylov::residual::Iterate;
use crate::feti::{LinearMethod, LinearSolution};
use crate::status::Status;
use crate::Result;
use parallel::exchange::{any, total};

/// The strategy.
pub(super) struct Smalbe<'a> {
    method: &'a LinearMethod,
    settings: &'a ContactSettings,
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
    /// The residual when the last row changed, or when it was halved, and the steps since then.
    best: (f64, usize),
    /// Whether the set of the last step is to be tried.
    promises: bool,
    /// A trial, and its steps.
    trial: Option<(ActiveSet<'a>, usize)>,
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
        self.best = match self.best {
            (before, idle) if self.unchanged > 0 && step.residual > 0.5 * before => {
                (before, idle + 1)
            }
            _ => (step.residual, 0),
        };
        // A set that stays is tried even if μ is still far from its limit. The ascent of μ is slow where stiff bodies
        // hang on soft ones.
        self.promises = settled || self.unchanged == self.settings.tuning.smalbe_patience;
        Ok(step)
    }

    /// A trial of the set of the state. Collective.
    fn trial(&mut self) -> Result<ActiveSet<'a>> {
        self.search.a.face.forget();
        let start = State {
            safeguarded: false,
            progress: ActiveSetProgress::default(),
            ..self.state.clone()
        };
        let mut run = ActiveSet::new(self.method, self.settings, Some(&start))?;
        self.state.reference = run.state.reference;
        let tuning = &self.settings.tuning;
        run.open = (tuning.open_in_trial * self.rtol).max(tuning.rounding);
        Ok(run)
    }

    /// Goes on after a trial whose set did not stay. Collective.
    fn go_on(&mut self, run: &ActiveSet) -> Result<()> {
        if self.settled {
            self.accuracy = (0.1 * self.accuracy).max(1e-13);
        }
        if self.jumps < self.settings.tuning.jumps {
            self.jumps += 1;
            self.search.restart(self.method.session.comm(), run)?;
        }
        self.search.lagrangian = f64::NEG_INFINITY;
        Ok(())
    }
}

impl Strategy<DualCourse> for Smalbe<'_> {
    fn state(&self) -> &State {
        self.trial
            .as_ref()
            .map_or(&self.state, |(run, _)| &run.state)
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
        let closing = self.settings.tuning.closing_steps;
        if let Some((run, _)) = self.trial.take_if(|(_, steps)| *steps == closing) {
            self.go_on(&run)?;
        }
        if std::mem::take(&mut self.promises) {
            self.trial = Some((self.trial()?, 0));
        }
        let Some((run, steps)) = &mut self.trial else {
            return Ok((self.advance()?, Proposal::GoOn));
        };
        run.tight = true;
        let (step, proposal) = run.step()?;
        self.state.steps += 1;
        *steps += 1;
        Ok((step, proposal))
    }

    fn finish(
        mut self: Box<Self>,
        steps: &[Step],
        seconds: f64,
        status: Status,
    ) -> Result<LinearSolution> {
        let run = match self.trial.take() {
            Some((run, _)) => run,
            None => {
                self.search.a.face.leave();
                ActiveSet::new(self.method, self.settings, Some(&self.state))?
            }
        };
        run.end(steps, seconds, status)
    }
}

/// The dual problem in shifted and scaled variables, and the state of the search.
struct SmalbeIteration<'a> {
    tuning: &'a Tuning,
    a: Augmented<'a>,
    /// Pᵀ S (d − F λ̃).
    b: Vec<f64>,
    /// ‖b‖, or ‖Pᵀ A x‖ of the bounds l₊ where that is larger; tolerances are relative to it.
    size: f64,
    shift: Vec<f64>,
    lower: Vec<f64>,
    fixed: Vec<bool>,
    contact: std::ops::Range<usize>,
    x: Vec<f64>,
    /// μ, in the columns that this rank knows.
    mu: Vec<f64>,
    /// M relative to ϱ.
    m: f64,
    lagrangian: f64,
}

impl<'a> SmalbeIteration<'a> {
    fn new(
        method: &'a LinearMethod,
        settings: &'a ContactSettings,
        state: &State,
    ) -> Result<SmalbeIteration<'a>> {
        let (session, problem) = (&method.session, &method.problem);
        let comm = session.comm();
        let all: Vec<bool> = {
            let jump = &method.dual().stiffness.jump;
            (0..jump.n_owned).map(|i| jump.is_candidate(i)).collect()
        };
        method.set_active(&all)?;
        let mut a = Augmented::new(method, settings)?;
        let dual = method.dual();
        let jump = &dual.stiffness.jump;
        let loads = Loads::new(problem, &dual);
        let mut c = loads.kernel.e.clone();
        a.balance.solve(&mut c);
        let mut shift = vec![0.0; jump.n_owned];
        a.balance.add(1.0, &c, &mut shift); /*            λ̃ = G N⁺ e      */
        let mut at = Iterate::new(&dual, loads)?;
        at.lambda.array_mut()?.copy_from_slice(&a.unscaled(&shift));
        at.evaluate(&dual)?;
        let mut r = at.residual.r.to_vec()?;
        // With all candidates active, rows may contradict each other and be held to other right-hand sides. The bound
        // constraints need c itself.
        for (r, (held, c)) in r.iter_mut().zip(jump.held.iter().zip(&jump.gap)) {
            *r += held - c;
        }
        let mut b = a.unscaled(&r); /*                    b = S(d − F λ̃)  */
        a.balance.project(comm, &mut b);
        let lower: Vec<f64> = (0..jump.n_owned)
            .map(|i| jump.law[i].least() - shift[i])
            .collect();
        // Without bounds λ̃ may be the solution: b is rounding, and what the bounds add to it has the problem's size.
        let first: Vec<f64> = lower.iter().map(|l| l.max(0.0)).collect();
        let mut of_bounds = vec![0.0; first.len()];
        a.apply(&first, &mut of_bounds)?;
        a.balance.project(comm, &mut of_bounds);
        let square = |v: &[f64]| total(comm, v.iter().map(|v| v * v).sum());
        let size = square(&b).max(square(&of_bounds)).sqrt();
        let warm = state.lambda.iter().any(|l| *l != 0.0);
        let warm = any(comm, warm);
        let start = a.scaled(&state.lambda);
        let x = (0..jump.n_owned).map(|i| {
            if warm {
                (start[i] - shift[i]).max(lower[i])
            } else {
                first[i]
            }
        });
        let known = a.balance.known();
        let mu = if state.mu.is_empty() {
            vec![0.0; known.n()]
        } else {
            known.part_of(&state.mu)
        };
        Ok(SmalbeIteration {
            x: x.collect(),
            mu,
            fixed: all.iter().map(|on| !on).collect(),
            contact: jump.rows_between_bodies(),
            a,
            b,
            size,
            shift,
            lower,
            m: settings.tuning.m_start,
            tuning: &settings.tuning,
            lagrangian: f64::NEG_INFINITY,
        })
    }

    /// Continues from the λ of an active-set step and the μ that belongs to it. With w = S (c − B u) on the rows that
    /// do not hold, the optimality of L reads G μ = (I − P) w. Collective.
    fn restart(&mut self, comm: &SimpleCommunicator, run: &ActiveSet) -> Result<()> {
        let scaled = self.a.scaled(&run.state.lambda);
        for (i, x) in self.x.iter_mut().enumerate() {
            *x = (scaled[i] - self.shift[i]).max(self.lower[i]);
        }
        let w: Vec<f64> = (0..self.x.len())
            .map(|i| {
                if self.fixed[i] || run.held[i] {
                    0.0
                } else {
                    -run.gaps[i] * self.a.scale[i]
                }
            })
            .collect();
        self.mu = self.a.balance.forces(comm, &w);
        self.a.balance.solve(&mut self.mu);
        Ok(())
    }

    /// One inner problem and one ascent of the multipliers μ. Returns the step, and whether all residuals are within
    /// `accuracy`. Collective.
    fn advance(
        &mut self,
        comm: &SimpleCommunicator,
        state: &mut State,
        accuracy: f64,
    ) -> Result<(Step, bool)> {
        let clock = Instant::now();
        let (rho, size, tuning) = (self.a.rho, self.size, self.tuning);
        let mut b = self.b.clone();
        self.a.balance.add(-1.0, &self.mu, &mut b); /*    b − G μ         */
        let balance = self.a.balance.clone();
        let setting = Setting {
            comm,
            lower: &self.lower,
            fixed: &self.fixed,
            length: 1.9 / rho,
            tuning,
        };
        let floor = accuracy * size;
        let m = self.m;
        let mut stop = |x: &[f64], gradient: f64| {
            let allowed = m * rho * balance.violation(comm, x);
            gradient <= allowed.min(tuning.eta * size) || gradient <= 0.5 * floor
        };
        let start = std::mem::take(&mut self.x);
        let run = setting.minimise(&mut self.a, &b, start, &mut stop, tuning.products)?;
        let violation = balance.violation(comm, &run.x);
        let gradient = setting.projected_gradient(&run.x, &run.g);
        // L = ½ xᵀA x − bᵀx with A x = g + b
        let terms = run.x.iter().zip(&run.g).zip(&b);
        let value = total(comm, terms.map(|((x, g), b)| 0.5 * x * (g - b)).sum());
        if value < self.lagrangian + 0.5 * rho * violation * violation {
            self.m *= tuning.m_shrink;
        }
        self.lagrangian = value;
        let mut c = balance.forces(comm, &run.x);
        balance.solve(&mut c);
        self.mu.iter_mut().zip(&c).for_each(|(m, c)| *m += rho * c);
        state.mu = balance.known().whole(comm, &self.mu);

        // Rows on their bound with a gradient that points into the feasible set.
        let wrong = (0..run.x.len())
            .filter(|&i| !self.fixed[i] && run.x[i] <= self.lower[i] && run.g[i] < -floor);
        let wrong = wrong.count();
        self.x = run.x;
        let free: Vec<bool> = (0..self.x.len())
            .map(|i| !self.fixed[i] && self.x[i] > self.lower[i])
            .collect();
        state.steps += 1;
        let sum: Vec<f64> = self.x.iter().zip(&self.shift).map(|(x, s)| x + s).collect();
        state.lambda = self.a.unscaled(&sum);
        state.before = std::mem::replace(&mut state.active, free);
        let (rows, now) = (self.contact.clone(), &state.active);
        let [active, entered, left] = changes(comm, &state.before[rows.clone()], &now[rows]);
        let residual = match size {
            size if size > 0.0 => gradient.max(rho * violation) / size,
            _ => 0.0,
        };
        let step = Step {
            method: ContactType::Smalbe,
            active,
            entered,
            left,
            iterations: run.products,
            estimate: None,
            exact: None,
            residual,
            tolerance: accuracy,
            wrong: total(comm, wrong as f64) as usize,
            seconds: clock.elapsed().as_secs_f64(),
        };
        Ok((step, residual <= accuracy))
    }
}
