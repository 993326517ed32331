//! Contact with friction: the active set of normal rows and of nodes that stick or slip (docs/theory.md, section 9).
//!
//! ```text
//!     stick    B_t u = c_t                        slip    f ← f − B_tᵀ g d
//!     g ← μ λ_n    after every solve              d ← s/|s|,    s = λ_t + k w    where states change
//! ```
//!
//! A step solves the equations of one set of states by the linear method, until the forces are at rest: nothing is
//! factored again, and the operators stay symmetric. Normal rows follow the rule of the active set in the same step.

mod judged;
mod lagrangian;
pub mod mixing;
mod newton;
pub mod node;
mod pose;
pub(super) mod tuning;
mod waiting;

use super::active_set::{ActiveSet, ActiveSetChange};
use super::course::DualCourse;
use super::modes::{CompliantRows, TurnedRows};
use super::settings::ContactSettings;
use super::state::{ActiveSetProgress, State, Step};
use super::strategy::{Checkpoint, Proposal, Strategy};
use crate::feti::krylov::loads::Loads;
use crate::feti::{LinearMethod, LinearSolution};
use crate::status::Status;
use crate::Result;
pub use judged::error;
use judged::nodes;
pub use lagrangian::FrictionLagrangian;
use mixing::Mixing;
use node::{Node, NodeState};
use parallel::exchange::{any, max_all, sum_all};

/// Whether a problem has friction, or rows that give way. Collective.
pub fn is_asked_for(method: &LinearMethod) -> bool {
    let soft = method.dual().stiffness.jump.is_soft;
    soft || any(method.session.comm(), !method.problem.friction.is_empty())
}

/// The strategy.
pub struct Friction<'a> {
    method: &'a LinearMethod,
    settings: &'a ContactSettings,
    inner: ActiveSet<'a>,
    /// The loads of the problem.
    loads: Loads,
    nodes: Vec<Node>,
    mixing: Mixing,
    progress: ActiveSetProgress,
    /// The factor on the tolerance of the user.
    accuracy: f64,
    /// Springs across slips in space, and rows along them.
    springs: CompliantRows<'a>,
    turned: TurnedRows<'a>,
    /// Steps in a row after which rows had to be put back.
    slides: usize,
}

impl<'a> Friction<'a> {
    /// The loop from a state, or with all nodes sticking.
    pub fn new(
        method: &'a LinearMethod,
        settings: &'a ContactSettings,
        start: Option<&State>,
    ) -> Result<Friction<'a>> {
        let cold = State::cold(&method.dual().stiffness.jump);
        let state = start.unwrap_or(&cold);
        let nodes = nodes(
            method,
            &settings.tuning.friction,
            &state.lambda,
            &state.active,
        )?;
        let mut inner = ActiveSet::new(method, settings, start)?;
        let accuracy = inner.state.accuracy;
        // Where sides stood at the end of a load step is known to its tolerance. What sticks there may seem to violate
        // a row that holds it, too.
        if any(method.session.comm(), !state.slid.is_empty()) {
            let even = settings.tuning.friction.even * method.ksp.tolerances()?.0;
            inner.open = inner.open.max(even);
        }
        let loads = Loads::new(&method.problem, &method.dual());
        Ok(Friction {
            method,
            settings,
            inner,
            loads,
            nodes,
            mixing: Mixing::default(),
            progress: ActiveSetProgress::default(),
            accuracy,
            springs: CompliantRows::of(method),
            turned: TurnedRows::of(method),
            slides: 0,
        })
    }

    /// The bounds g of the nodes that slip; 0 for the others, whose forces do not depend on g.
    fn bounds(&self) -> Vec<f64> {
        self.nodes.iter().map(Node::slipping).collect()
    }

    /// The size of slips that say nothing: that of jumps which the step has left on rows that hold. Collective.
    fn nothing(&self) -> Result<f64> {
        let dual = self.method.dual();
        let jump = &dual.stiffness.jump;
        let rows = jump.rows_between_bodies().filter(|&r| self.inner.held[r]);
        let left = rows.map(|r| (self.inner.gaps[r] + jump.gap[r] - jump.held[r]).abs());
        let mut largest = [left.fold(0.0, f64::max)];
        max_all(self.method.session.comm(), &mut largest);
        let (tuning, rtol) = (&self.settings.tuning, self.method.ksp.tolerances()?.0);
        Ok(tuning.friction.nothing * largest[0] + tuning.friction.even * rtol * self.inner.length)
    }

    /// Takes the nodes to the states that follow from the step, in which the normal rows stay or not. Returns the
    /// number of flips and the largest change of a force over all ranks, relative to the largest force of a row.
    /// Collective.
    fn update(&mut self, stays: bool) -> Result<(usize, f64)> {
        let nothing = self.nothing()?;
        let comm = self.method.session.comm();
        let (before, force) = (self.bounds(), self.largest_force());
        let step = node::Step {
            lambda: &self.inner.state.lambda,
            gaps: &self.inner.gaps,
            active: &self.inner.state.active,
            nothing,
        };
        let (mut flips, mut moves) = ([0.0], [0.0f64]);
        let waits = match self.progress.stalled(self.settings.tuning.friction.waits) {
            true => self.waiting(&step),
            false => vec![false; self.nodes.len()],
        };
        let mut active = self.inner.state.active.clone();
        for (node, waits) in self.nodes.iter_mut().zip(waits) {
            let change = node.update(&step, waits);
            if waits {
                active[node.normal] = self.inner.state.before[node.normal];
            }
            flips[0] += f64::from(u8::from(change.flips));
            moves[0] = moves[0].max(change.moves);
        }
        sum_all(comm, &mut flips);
        max_all(comm, &mut moves);
        if flips[0] == 0.0 && stays {
            let given_way = self
                .nodes
                .iter_mut()
                .filter_map(|n| n.gives_way(&step).then_some(1.0));
            flips[0] = given_way.sum();
            sum_all(comm, &mut flips);
        }
        self.inner.state.active = active;
        if flips[0] > 0.0 || !stays {
            self.mixing.restart();
        } else {
            self.mix(before, self.bounds());
        }
        Ok((flips[0] as usize, moves[0] / force))
    }

    /// The bounds that follow from the step for the nodes that slip; 0 for the others.
    fn following(&self) -> Vec<f64> {
        let lambda = &self.inner.state.lambda;
        self.nodes.iter().map(|n| n.following(lambda)).collect()
    }

    /// The largest change of a force that slipping nodes have yet to make, relative to the largest force of a row.
    /// Collective.
    fn unrest(&self) -> f64 {
        let pairs = self.following().into_iter().zip(self.bounds());
        let mut moves = [pairs.fold(0.0f64, |a, (next, g)| a.max((next - g).abs()))];
        max_all(self.method.session.comm(), &mut moves);
        moves[0] / self.largest_force()
    }

    /// Gives slipping nodes the forces that follow from the step, and lets all nodes and rows stay in their states.
    /// Collective.
    fn renew(&mut self) {
        let mapped = self.following();
        self.mix(self.bounds(), mapped);
        self.inner.state.active.clone_from(&self.inner.state.before);
        self.inner.tight = false;
    }

    /// Mixes bounds and those that follow from them. Collective.
    fn mix(&mut self, before: Vec<f64>, mapped: Vec<f64>) {
        let (comm, depth) = (
            self.method.session.comm(),
            self.settings.tuning.friction.mixed,
        );
        let mixed = self.mixing.mix(comm, depth, before, &mapped);
        for (node, g) in self.nodes.iter_mut().zip(mixed) {
            node.g = g.max(0.0);
        }
    }

    /// Whether the step has numbers for all rows: equations without digits may have none. Collective.
    fn is_finite(&self) -> bool {
        let mut numbers = self.inner.state.lambda.iter().chain(&self.inner.gaps);
        !any(self.method.session.comm(), numbers.any(|v| !v.is_finite()))
    }

    /// The largest force of a row; 1 if there is none. Collective.
    fn largest_force(&self) -> f64 {
        let lambda = self.inner.state.lambda.iter();
        let mut largest = [lambda.fold(0.0f64, |a, l| a.max(l.abs()))];
        max_all(self.method.session.comm(), &mut largest);
        if largest[0] > 0.0 {
            largest[0]
        } else {
            1.0
        }
    }

    /// Lets nodes stick where slipping ones leave a body loose that the load drives. Returns whether some had to.
    ///
    /// # Errors
    /// Bodies that slide or fly away: for some steps nothing but friction beyond its bound has held them.
    fn hold(&mut self) -> Result<bool> {
        self.turn()?;
        let given = self.given();
        let (problem, dual) = (&self.method.problem, self.method.dual());
        let (_, load) = self.loads.with_multipliers(problem, &dual, &given)?;
        drop(dual);
        let mut active = self.inner.state.active.clone();
        for node in &self.nodes {
            // The springs across slips give way as far as a body slides.
            let sticks = node.state == NodeState::Stick;
            node.tangential.iter().for_each(|&t| active[t] = sticks);
        }
        // Of nodes that slip the one that slips least: the others then slip on in their directions. Where that does not
        // help, rows that push come first: a body that tips comes to rest on them.
        let tuning = &self.settings.tuning.friction;
        let last = if self.slides >= tuning.tips {
            f64::MAX.sqrt()
        } else {
            0.0
        };
        let length = self.inner.length.max(f64::MIN_POSITIVE);
        let mut scores = vec![0.0; active.len()];
        for node in &self.nodes {
            let score = -node.excess - last * (1.0 + node.excess / length);
            node.tangential.iter().for_each(|&t| scores[t] = score);
        }
        let mut held = active.clone();
        let put_back = self.inner.hold(&mut held, &load, Some(&scores))?;
        let mut restored = false;
        for node in &mut self.nodes {
            let back = node.tangential.iter().any(|&t| held[t] && !active[t]);
            if back {
                node.state = NodeState::Stick;
                restored = true;
            }
        }
        for node in &self.nodes {
            self.inner.state.active[node.normal] = held[node.normal];
        }
        let comm = self.method.session.comm();
        let restored = any(comm, restored);
        self.slides = if put_back > 0 { self.slides + 1 } else { 0 };
        if self.slides > tuning.slides {
            // Which body it is, and its motion: that of the load beside all forces of friction that are given.
            self.inner.hold(&mut active, &load, None)?;
        }
        Ok(restored)
    }
}

impl Strategy<DualCourse> for Friction<'_> {
    fn state(&self) -> &State {
        &self.inner.state
    }

    fn checkpoint(&self) -> Checkpoint {
        match self.inner.state.safeguarded {
            true => Checkpoint::HandOver,
            false => Checkpoint::Update,
        }
    }

    /// The equations of one set of states, again with the forces of friction that follow from their multipliers until
    /// those are at rest, or a state changes.
    fn step(&mut self) -> Result<(Step, Proposal<Status>)> {
        let tuning = &self.settings.tuning.friction;
        let mut whole: Option<Step> = None;
        for renewal in 0.. {
            self.pose()?;
            self.inner.finer = if renewal == 0 {
                tuning.finer
            } else {
                tuning.renewed
            };
            // States ask for more digits than the user.
            let digits = if self.inner.tight { 1.0 } else { tuning.digits };
            self.inner.state.accuracy = digits * self.accuracy;
            let (mut step, status, change) = self.inner.try_set()?;
            self.inner.state.accuracy = self.accuracy;
            if let Some(before) = whole {
                step = step.continuing(&before);
                self.inner.state.steps -= 1;
            }
            // Equations of states on the way may have no solution, or one without digits. Springs have one.
            if status.broke_down() || !self.is_finite() {
                self.inner.state.safeguarded = true;
                return Ok((step, Proposal::GoOn));
            }
            if !status.converged() {
                return Ok((step, Proposal::End(status)));
            }
            let state = &mut self.inner.state;
            state.safeguarded = false;
            let is_last = renewal == tuning.renewals;
            // Where states wander, they are asked only once the forces are at rest: they are given, and mislead.
            if self.progress.stalled(tuning.patience) && !is_last && self.unrest() > tuning.rest {
                self.renew();
                whole = Some(step);
                continue;
            }
            let stays = !any(
                self.method.session.comm(),
                self.inner.state.active != self.inner.state.before,
            );
            let (flips, moves) = self.update(stays)?;
            let restored = self.hold()?;
            step.wrong += flips;
            let settled = flips == 0 && !restored;
            let rtol = self.method.ksp.tolerances()?.0;
            let still = settled && moves <= tuning.still * rtol;
            if still && change == ActiveSetChange::Solved {
                return Ok((step, Proposal::End(status)));
            }
            // A step to the end is worth it where the forces of friction have come to rest.
            self.inner.tight &= still;
            if !(settled && stays) || is_last {
                self.progress.note(step.wrong);
                self.inner.state.safeguarded = self.progress.stalled(tuning.wanders);
                return Ok((step, Proposal::GoOn));
            }
            whole = Some(step);
        }
        unreachable!("the last renewal ends a step")
    }

    fn finish(
        mut self: Box<Self>,
        steps: &[Step],
        seconds: f64,
        status: Status,
    ) -> Result<LinearSolution> {
        self.rest()?;
        self.inner.end(steps, seconds, status)
    }
}
