//! Newton steps on the augmented functional φ with discs, for given bounds g.
//!
//! ```text
//!     p = Π(s),  s = μ + (B u − c)/C          the forces at u: λ_n = (s_n)₊, λ_t = Π_g s_t
//!     rows with a stiffness:   B u⁺ − C λ⁺ = B u − C p           across a slip: C |s|/g in place of C
//! ```
//!
//! The forces of all other rows are given: zero where sides are apart, g d along a slip. Every row that has a force is
//! a spring, so that rows which depend on each other do no harm, and a row that has to be put back to hold a body is a
//! spring from where the body is. φ falls along each step, because the springs are symmetric and semidefinite.

use super::lagrangian::FrictionLagrangian;
use super::node::NodeState;
use super::nodes::Nodes;
use crate::contact::line_search::{LineSearchPoint, Penalty};
use crate::contact::settings::ContactType;
use crate::contact::state::{changes, Step};
use crate::feti::krylov::iterate::{IterationControl, KrylovRun};
use crate::feti::krylov::target::target;
use crate::status::Status;
use crate::Result;
use base::ErrorKind;
use parallel::exchange::any;
use std::collections::BTreeMap;
use std::time::Instant;

/// A Newton step.
pub struct NewtonStep {
    /// Its record.
    pub step: Step,
    /// The end of its iteration.
    pub status: Status,
    /// How far it went; 0 if φ does not fall.
    pub length: f64,
}

impl FrictionLagrangian<'_> {
    pub(super) fn penalty(&self) -> Penalty<'_> {
        Penalty {
            law: &self.law,
            multiplier: &self.shifted,
            compliance: &self.compliance,
            discs: &self.discs,
            anchors: None,
            tuning: &self.settings.tuning,
        }
    }

    /// One step for the present springs and bounds. Collective.
    pub(super) fn newton(&mut self) -> Result<NewtonStep> {
        let clock = Instant::now();
        let (method, tuning) = (self.method, &self.settings.tuning);
        let comm = method.session.comm();
        let softest = tuning.friction.softest;
        let posed = self.pose(softest);
        let posed = posed.and_then(|restored| Ok((restored, self.begin()?)));
        // A body that little but rows across slips holds may be too loose for the natural coarse problem.
        let (restored, first) = match posed {
            Err(e) if e.kind() == ErrorKind::NotConverged => (self.pose(0.0)?, self.begin()?),
            other => other?,
        };
        let active = method.dual().stiffness.jump.active.clone();
        let least = target(&method.ksp, self.state.reference, self.length, self.n_rows)?;
        let softer = (tuning.stiffness / self.stiffness).min(1.0);
        let least = (tuning.friction.digits * softer * least).max(self.least);
        let mut reduction = tuning.friction.reduction * softer;
        let mut run: Option<KrylovRun> = None;
        let mut arrived = None;
        for _ in 0..tuning.attempts {
            let tolerance = (reduction * first).max(least);
            let control = IterationControl::to(tolerance, self.at.residual.size);
            let more = method.reach(&mut self.at, control, None)?;
            run = Some(more.after(run.take()));
            let end = self.evaluate_point()?;
            let length = match &self.point {
                Some(point) => self.penalty().length(comm, [point, &end], restored),
                None => Some(1.0),
            };
            arrived = Some((end, length, tolerance));
            // A step that is loose may lead uphill.
            if length.is_some() || tolerance <= least {
                break;
            }
            reduction *= tuning.reduced_again;
            self.begin()?;
        }
        let (end, length, tolerance) = arrived.expect("there is an attempt");
        let run = run.expect("there is an attempt");
        let length = length.unwrap_or(0.0);
        self.point = Some(match &self.point {
            Some(point) => point.towards(&end, length),
            None => end,
        });
        let rows = method.dual().stiffness.jump.rows_between_bodies();
        let state = &mut self.state;
        let [n_active, entered, left] = changes(comm, &state.before[rows.clone()], &active[rows]);
        state.steps += 1;
        state.before = active;
        let relative = |r: f64| match self.state.reference {
            reference if reference > 0.0 => r / reference,
            _ => r,
        };
        let step = Step {
            method: ContactType::AugmentedLagrangian,
            active: n_active,
            entered,
            left,
            iterations: run.iterations,
            estimate: run.estimate,
            exact: match method.settings.spectrum {
                true => method.spectrum()?,
                false => None,
            },
            residual: relative(*run.residuals.last().unwrap_or(&first)),
            tolerance: relative(tolerance),
            wrong: 0,
            seconds: clock.elapsed().as_secs_f64(),
        };
        let status = run.status.clone();
        self.last = Some(run);
        Ok(NewtonStep {
            step,
            status,
            length,
        })
    }

    /// Balances λ for the equations as they are, and computes its residual. Collective.
    fn begin(&mut self) -> Result<f64> {
        let dual = self.method.dual();
        self.at.begin(&dual)?;
        self.at.evaluate_projected(&dual)
    }

    /// Hands the equations at the present point to the method. Springs across slips are at most `softest` times softer
    /// than others, but for those without which the load drives a body; with 0 there are none. Returns whether other
    /// rows had to be put back, because what holds leaves a body loose that the load drives. Collective.
    fn pose(&mut self, softest: f64) -> Result<bool> {
        let (method, comm) = (self.method, self.method.session.comm());
        let pull = self.point.as_ref().map(|p| self.penalty().pull(p));
        for (node, disc) in self.nodes.iter_mut().zip(&self.discs) {
            node.g = disc.radius;
            let slips = pull.as_ref().and_then(|s| disc.direction(disc.of(s)));
            node.state = match slips {
                None => NodeState::Stick,
                Some(_) if node.g == 0.0 => NodeState::Apart,
                Some(d) => NodeState::Slip(d),
            };
        }
        let mut restored = false;
        let active = loop {
            self.turn()?;
            let given = Nodes::given(&self.nodes, self.law.len());
            let dual = method.dual();
            let (g, kernel) = self
                .loads
                .with_multipliers(&method.problem, &dual, &given)?;
            let mut active: Vec<bool> = (0..self.law.len())
                .map(|i| match &pull {
                    Some(s) if self.law[i].is_inequality() => self.law[i].bears(s[i]),
                    _ => dual.stiffness.jump.initial[i],
                })
                .collect();
            Nodes::sticking(&self.nodes, &mut active);
            // Springs across slips hold, too: forces turn with the slips. Very soft ones do where nothing else does.
            let softer = self.softer(&pull).filter(|_| softest > 0.0);
            let softer: BTreeMap<usize, f64> = softer.collect();
            for (&across, softer) in &softer {
                active[across] = *softer < softest;
            }
            let score = |i: usize| match &self.point {
                Some(_) if softer.contains_key(&i) => 1.0 / softer[&i],
                Some(point) if self.law[i].is_friction() => -point.gap[i].abs(),
                Some(point) => point.gap[i],
                None => -self.compliance[i],
            };
            if !restored && self.slides > self.settings.tuning.friction.slides {
                // Which body slides away, and its motion: that of the load beside all given forces of friction. That
                // some forces of friction balance the load was asked before.
                let score = |i: usize| match self.law[i].is_friction() {
                    true => f64::NEG_INFINITY,
                    false => score(i),
                };
                let mut held = active.clone();
                let loads = (&kernel, &self.loads.kernel);
                self.repairs.sliding(&dual, &mut held, &score, loads)?;
            }
            let free = active.clone();
            self.repairs.hold(&dual, &mut active, &score, &kernel)?;
            drop(dual);
            let back = |i: &usize| active[*i] && !free[*i] && !softer.contains_key(i);
            restored |= any(comm, (0..active.len()).any(|i| back(&i)));
            let mut sticks = false;
            for node in &mut self.nodes {
                if node.state != NodeState::Stick && node.tangential.iter().any(back) {
                    node.state = NodeState::Stick;
                    sticks = true;
                }
            }
            if !any(comm, sticks) {
                method.system.set_given_multipliers(given);
                (self.at.loads.g, self.at.loads.kernel) = (g, kernel);
                break active;
            }
        };
        self.slides = if restored { self.slides + 1 } else { 0 };
        let compliance = self.soften(&pull);
        let jumps = self.jumps(&compliance, &pull);
        self.springs.soften(&compliance);
        method.set_active(&active)?;
        let dual = method.dual();
        let mut lambda = self.at.lambda.array_mut()?;
        dual.stiffness.jump.release(&active, &mut lambda);
        drop(lambda);
        drop(dual);
        self.at.loads.jumps = Some(jumps);
        Ok(restored)
    }

    /// How much softer than others the spring across each slip is, by its row.
    fn softer<'b>(&'b self, pull: &'b Option<Vec<f64>>) -> impl Iterator<Item = (usize, f64)> + 'b {
        let nodes = self.nodes.iter().zip(&self.discs);
        nodes.filter_map(move |(node, disc)| {
            let [a, b] = disc.of(pull.as_ref()?);
            Some((node.slips_beside()?, a.hypot(b) / disc.radius))
        })
    }

    /// The compliance of the rows in the equations.
    fn soften(&self, pull: &Option<Vec<f64>>) -> Vec<f64> {
        let mut compliance = self.compliance.clone();
        for (i, law) in self.law.iter().enumerate() {
            if !law.is_inequality() && !law.is_friction() {
                compliance[i] = 0.0;
            }
        }
        for (across, softer) in self.softer(pull) {
            compliance[across] *= softer;
        }
        compliance
    }

    /// B u − C p + c on the rows as they are turned, with the compliance of the equations.
    fn jumps(&self, compliance: &[f64], pull: &Option<Vec<f64>>) -> Vec<f64> {
        let mut jumps = self.method.dual().stiffness.jump.gap.clone();
        let (Some(point), Some(pull)) = (&self.point, pull) else {
            return jumps;
        };
        let mut gap = point.gap.clone();
        let mut force = self.penalty().forces(pull);
        for values in [&mut gap, &mut force] {
            self.onto_rows(values);
        }
        for (i, law) in self.law.iter().enumerate() {
            if law.is_inequality() || law.is_friction() {
                jumps[i] += gap[i] - compliance[i] * force[i];
            }
        }
        jumps
    }

    /// Turns the rows of nodes that slip along their slips. Collective.
    fn turn(&mut self) -> Result<()> {
        let turns = Nodes::turns(&mut self.nodes);
        self.turned.turn(&turns);
        self.at.turn(&turns)
    }

    /// Values in the directions that were given, on the rows as they are turned.
    fn onto_rows(&self, values: &mut [f64]) {
        for (node, disc) in self.nodes.iter().zip(&self.discs) {
            let on = node.on_rows(disc.of(values));
            disc.rows.iter().zip(on).for_each(|(&i, v)| values[i] = v);
        }
    }

    /// The reverse of `onto_rows`.
    fn off_rows(&self, values: &mut [f64]) {
        for (node, disc) in self.nodes.iter().zip(&self.discs) {
            let given = node.given(disc.of(values));
            let pairs = disc.rows.iter().zip(given);
            pairs.for_each(|(&i, v)| values[i] = v);
        }
    }

    /// The displacements of the present λ as the rows see them, in the directions that were given. Collective.
    pub(super) fn evaluate_point(&mut self) -> Result<LineSearchPoint> {
        let dual = self.method.dual();
        let residual = &mut self.at.residual;
        residual.evaluate(&dual, &self.at.loads, &self.at.lambda)?;
        residual.add_rigid_motion(&dual)?;
        let mut gap = self.repairs.place(&dual, residual, &self.at.lambda)?;
        self.length = residual.length(&dual);
        let mut force = self.at.lambda.to_vec()?;
        for (i, own) in dual.stiffness.jump.compliance.iter().enumerate() {
            gap[i] += own * force[i];
        }
        drop(dual);
        for values in [&mut gap, &mut force] {
            self.off_rows(values);
        }
        Ok(LineSearchPoint {
            gap,
            force,
            motion: Default::default(),
        })
    }
}
