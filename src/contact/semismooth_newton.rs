//! Semismooth Newton steps on the augmented Lagrangian φ, with a line search.
//!
//! ```text
//!     A = { s > 0 }        K u⁺ + Bᵀ λ⁺ = f,   B u⁺ − C λ⁺ = c − C μ on A        u ← u + t (u⁺ − u)
//! ```
//!
//! u is never formed: the rows see it as gaps B u − c and as multipliers λ with K u = f − Bᵀλ, and both are
//! interpolated along a step ([`LineSearchPoint`]).

use std::time::Instant;

use super::anchored::{Arrival, Begin};
use super::anchors::Anchors;
use super::existence::Existence;
use super::line_search::{LineSearchPoint, Penalty};
use super::mean_compliance::mean_compliance;
use super::modes::CompliantRows;
use super::repairs::Repairs;
use super::settings::{ContactSettings, ContactType};
use super::state::{changes, State, Step};
use super::tuning::Tuning;
use crate::feti::krylov::iterate::{IterationControl, KrylovRun};
use crate::feti::krylov::loads::Loads;
use crate::feti::krylov::residual::Iterate;
use crate::feti::krylov::target::target;
use crate::feti::LinearMethod;
use crate::status::Status;
use crate::substructures::Law;
use crate::Result;
use parallel::exchange::total;

/// Where a Newton step came to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NewtonOutcome {
    /// To the minimum of φ.
    Down,
    /// Close to it: few rows change.
    Near,
    /// Some way.
    Somewhere,
    /// φ does not fall along a step that is as exact as it can be made.
    Nowhere,
}

/// The data of the search.
pub struct SemismoothNewton<'a> {
    pub(super) method: &'a LinearMethod,
    pub(super) tuning: &'a Tuning,
    repairs: Repairs<'a>,
    pub(super) springs: CompliantRows<'a>,
    pub(super) at: Iterate,
    /// The law of each owned row.
    pub(super) law: Vec<Law>,
    /// The compliance of the nodes on the owned rows.
    pub(super) nodes: Vec<f64>,
    pub(super) stiffness: f64,
    /// C and μ.
    pub(super) compliance: Vec<f64>,
    pub(super) multiplier: Vec<f64>,
    /// Where the loop is; `None` before the first step.
    pub(super) point: Option<LineSearchPoint>,
    /// Springs on rigid motions, where bodies bend.
    pub(super) anchors: Option<Anchors>,
    /// The begin of the search, for a second one with anchors.
    pub(super) begin: Option<Begin>,
    /// The largest residual of a step with anchors.
    pub(super) largest: f64,
    /// Whether the next step is the first of a minimisation.
    begins: bool,
    /// The largest displacement in the last step.
    pub length: f64,
    n_rows: usize,
    /// Number of rows that are few.
    pub few: usize,
    /// No tolerance is below this: rounding of the problem's scale.
    least: f64,
    pub(super) last: Option<KrylovRun>,
}

impl<'a> SemismoothNewton<'a> {
    /// The search on the set of `state`, with μ = 0. Collective.
    pub fn new(
        method: &'a LinearMethod,
        settings: &'a ContactSettings,
        state: &mut State,
    ) -> Result<SemismoothNewton<'a>> {
        let tuning = &settings.tuning;
        let comm = method.session.comm();
        let dual = method.dual();
        let stiffness = &dual.stiffness;
        let nodes = stiffness.compliance_of_rows(&method.problem)?;
        let law = stiffness.jump.law.clone();
        let mine = law.iter().filter(|law| law.is_inequality()).count();
        let loads = Loads::new(&method.problem, &dual);
        let mut at = Iterate::new(&dual, loads)?;
        if state.reference == 0.0 {
            let existence = Existence::new(method, &dual, settings);
            existence.if_few(&at.loads.kernel)?;
            state.reference = existence.reference(&mut at)?;
        }
        at.lambda.array_mut()?.copy_from_slice(&state.lambda);
        // Whole minimisations earlier, so that about the same softness gives the same springs.
        let softer =
            mean_compliance(method, &nodes, tuning.compact_samples as u64)? / tuning.compact;
        let minimisations = softer.max(1.0).log(tuning.stiffer).round();
        let first = tuning.stiffness / tuning.stiffer.powf(minimisations);
        let mut search = SemismoothNewton {
            at,
            stiffness: first / tuning.stiffer,
            compliance: Vec::new(),
            multiplier: vec![0.0; law.len()],
            law,
            nodes,
            point: None,
            anchors: None,
            begin: (softer > 1.0).then(|| Begin::new(first, &state.active)),
            largest: 0.0,
            begins: true,
            length: 0.0,
            n_rows: stiffness.jump.n_global,
            few: tuning.few.max(tuning.few_of_all * total(comm, mine as f64)) as usize,
            last: None,
            least: method.least_residual(),
            springs: CompliantRows::of(method),
            repairs: Repairs::new(method, settings),
            tuning,
            method,
        };
        drop(dual);
        search.stiffen();
        Ok(search)
    }

    pub(super) fn penalty(&self) -> Penalty<'_> {
        Penalty {
            law: &self.law,
            multiplier: &self.multiplier,
            compliance: &self.compliance,
            discs: &[],
            anchors: self.anchors.as_ref(),
            tuning: self.tuning,
        }
    }

    /// Makes the rows rigid again, for the active-set method.
    pub fn rigid(&self) {
        self.springs.rigid();
    }

    /// Makes the rows springs again, as stiff as before.
    pub fn soften(&self) {
        self.springs.soften(&self.compliance);
    }

    /// μ ← (s)₊, and the set of the rows with μ > 0. Anchors go along and become softer. Ends a minimisation.
    pub fn update(&mut self, state: &mut State) {
        let Some(point) = &self.point else {
            return;
        };
        let s = self.penalty().pull(point);
        if let Some(anchors) = &mut self.anchors {
            anchors.follow(&point.motion[0]);
            anchors.soften(self.tuning.softer);
        }
        self.multiplier = s
            .iter()
            .zip(&self.law)
            .map(|(s, law)| law.project(*s))
            .collect();
        self.repairs.agree(&mut self.multiplier);
        state.active = self.set(&self.multiplier);
    }

    /// Makes the springs stiffer. The next minimisation goes on from where the loop is, with a step on the set of
    /// `state`.
    pub fn stiffen(&mut self) {
        self.begins = true;
        self.stiffness = (self.tuning.stiffer * self.stiffness).min(self.tuning.stiffest);
        let of = |(law, node): (&Law, &f64)| {
            if law.is_inequality() {
                node / self.stiffness
            } else {
                0.0
            }
        };
        self.compliance = self.law.iter().zip(&self.nodes).map(of).collect();
        self.soften();
    }

    /// The rows that hold: inequalities that bear s, and the equations.
    fn set(&self, s: &[f64]) -> Vec<bool> {
        let dual = self.method.dual();
        let jump = &dual.stiffness.jump;
        let on = |i: usize| match self.law[i] {
            law if law.is_inequality() => law.bears(s[i]),
            _ => jump.initial[i],
        };
        (0..s.len()).map(on).collect()
    }

    /// Puts rows into the set so that the load drives no body away; returns their number. Collective.
    fn hold(&self, active: &mut [bool]) -> Result<usize> {
        let dual = self.method.dual();
        let score = |i: usize| match &self.point {
            Some(point) => point.gap[i],
            None => -self.compliance[i],
        };
        let load = &self.at.loads.kernel;
        self.repairs.hold(&dual, active, &score, load)
    }

    /// The right-hand side of the rows: c − C μ. Rows that hold without a force of their own, s ≤ 0, are springs from
    /// the present gap with `centred`.
    fn jumps(&self, active: &[bool], centred: bool) -> Vec<f64> {
        let dual = self.method.dual();
        let c = &dual.stiffness.jump.gap;
        let apart = |i: usize| {
            let point = self
                .point
                .as_ref()
                .filter(|_| centred && self.law[i].is_inequality());
            let s = |p: &LineSearchPoint| self.multiplier[i] + p.gap[i] / self.compliance[i];
            point.filter(|p| active[i] && s(p) <= 0.0).map(|p| p.gap[i])
        };
        let of = |i: usize| match apart(i) {
            Some(gap) => c[i] + gap,
            None => c[i] - self.compliance[i] * self.multiplier[i],
        };
        (0..c.len()).map(of).collect()
    }

    /// One Newton step on the set of `state`. Collective.
    pub fn step(&mut self, state: &mut State) -> Result<(Step, Status, NewtonOutcome)> {
        let clock = Instant::now();
        let (method, comm) = (self.method, self.method.session.comm());
        let mut active = state.active.clone();
        let restored = match self.anchors {
            // They hold all bodies.
            Some(_) => 0,
            None => self.hold(&mut active)?,
        };
        method.set_active(&active)?;
        self.at.loads.jumps = Some(self.jumps(&active, false));
        let dual = method.dual();
        let jump = &dual.stiffness.jump;
        let rows = jump.rows_between_bodies();
        let mut lambda = self.at.lambda.array_mut()?;
        jump.release(&active, &mut lambda);
        drop(lambda);
        drop(dual);
        let begins = std::mem::take(&mut self.begins);
        let arrival = match self.anchors.take() {
            Some(anchors) => self.anchored(anchors, begins)?,
            None => self.held(state, (&active, restored), begins)?,
        };
        let (run, end, t) = (arrival.run, arrival.end, arrival.length.unwrap_or(0.0));
        let point = match &self.point {
            Some(point) => point.towards(&end, t),
            None => end,
        };
        let s = self.penalty().pull(&point);
        self.point = Some(point);
        let next = self.anchor().unwrap_or_else(|| self.set(&s));
        let (was, now) = (&active, &next);
        let [_, entering, leaving] = changes(comm, &was[rows.clone()], &now[rows.clone()]);
        let [n_active, entered, left] = changes(comm, &state.before[rows.clone()], &active[rows]);
        let wrong = entering + leaving;
        state.steps += 1;
        state.lambda = self.at.lambda.to_vec()?;
        state.before = active;
        state.active = next;
        let step = Step {
            method: ContactType::AugmentedLagrangian,
            active: n_active,
            entered,
            left,
            iterations: run.iterations,
            estimate: run.estimate,
            exact: if method.settings.spectrum {
                method.spectrum()?
            } else {
                None
            },
            residual: arrival.residual,
            tolerance: arrival.tolerance,
            wrong,
            seconds: clock.elapsed().as_secs_f64(),
        };
        let came = match t {
            _ if self.point.is_none() => NewtonOutcome::Somewhere,
            0.0 if begins => NewtonOutcome::Somewhere,
            0.0 => NewtonOutcome::Nowhere,
            1.0 if wrong == 0 => NewtonOutcome::Down,
            t if t > 0.99 && wrong <= self.few => NewtonOutcome::Near,
            _ => NewtonOutcome::Somewhere,
        };
        let status = run.status.clone();
        self.last = Some(run);
        Ok((step, status, came))
    }

    /// The end of a Newton step without anchors, as exact as it has to be to lead downwards. Collective.
    fn held(
        &mut self,
        state: &State,
        (active, restored): (&[bool], usize),
        begins: bool,
    ) -> Result<Arrival> {
        let (method, tuning) = (self.method, self.tuning);
        let first = {
            let dual = method.dual();
            self.at.begin(&dual)?;
            self.at.evaluate_projected(&dual)?
        };
        let mut run: Option<KrylovRun> = None;
        let softer = (tuning.stiffness / self.stiffness).min(1.0);
        let mut reduction = tuning.reduction * softer;
        let mut length = None;
        let mut tolerance = first;
        let (mut end, mut centred) = (None, false);
        for _ in 0..tuning.attempts + usize::from(restored > 0) {
            let least = target(&method.ksp, state.reference, self.length, self.n_rows)?;
            let least = state.accuracy * least;
            tolerance = (reduction * first).max(tuning.reduced_again * softer * least);
            tolerance = tolerance.max(self.least);
            let control = IterationControl::to(tolerance, self.at.residual.size);
            let more = method.reach(&mut self.at, control, None)?;
            run = Some(more.after(run.take()));
            let here = self.evaluate_point()?;
            length = self.length_to(&here, centred);
            end = Some(here);
            // The set of μ is a guess: from a point where φ falls not, the set of that point is next.
            if length.is_some() || begins {
                break;
            }
            // Rows that were put back may pull uphill. Springs from the present gaps cannot.
            if restored > 0 && !centred {
                centred = true;
                self.at.loads.jumps = Some(self.jumps(active, true));
                self.at.begin(&method.dual())?;
            } else {
                reduction *= tuning.reduced_again;
            }
            self.at.evaluate_projected(&method.dual())?;
        }
        let run = run.expect("there is an attempt");
        let relative = |r: f64| match state.reference {
            reference if reference > 0.0 => r / reference,
            _ => r,
        };
        Ok(Arrival {
            end: end.expect("it ended"),
            length,
            residual: relative(*run.residuals.last().unwrap_or(&first)),
            tolerance: relative(tolerance),
            run,
        })
    }

    /// How far to go to a point from where the loop is; `None` if φ does not fall. Collective.
    pub(super) fn length_to(&self, end: &LineSearchPoint, beyond: bool) -> Option<f64> {
        match &self.point {
            Some(point) => {
                let comm = self.method.session.comm();
                self.penalty().length(comm, [point, end], beyond)
            }
            None => Some(1.0),
        }
    }

    /// The displacements of the present λ as the rows see them. Collective.
    pub(super) fn evaluate_point(&mut self) -> Result<LineSearchPoint> {
        let dual = self.method.dual();
        let residual = &mut self.at.residual;
        residual.evaluate(&dual, &self.at.loads, &self.at.lambda)?;
        residual.add_rigid_motion(&dual)?;
        let gap = self.repairs.place(&dual, residual, &self.at.lambda)?;
        self.length = residual.length(&dual);
        Ok(LineSearchPoint {
            gap,
            force: self.at.lambda.to_vec()?,
            motion: Default::default(),
        })
    }
}
