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
mod mixing;
mod newton;
pub mod node;
pub mod nodes;
mod pose;
mod recovered;
mod trial;
pub(super) mod tuning;

use super::active_set::{ActiveSet, ActiveSetChange};
use super::course::DualCourse;
use super::existence::Existence;
use super::modes::{CompliantRows, TurnedRows};
use super::settings::{ContactSettings, ContactType};
use super::state::{State, Step};
use super::strategy::{Checkpoint, Proposal, Strategy};
use crate::feti::krylov::loads::Loads;
use crate::feti::{LinearMethod, LinearSolution};
use crate::status::Status;
use crate::Result;
use base::ErrorKind;
pub use judged::{error, nodes_at};
pub use lagrangian::FrictionLagrangian;
use nodes::{Changes, Nodes};
use parallel::exchange::{any, max_all};
pub use recovered::recovered;
pub use trial::StatesTrial;

/// Whether a problem has friction, or rows that give way. Collective.
pub fn is_asked_for(method: &LinearMethod) -> bool {
    let soft = method.dual().stiffness.jump.is_soft;
    soft || any(method.session.comm(), !method.problem.friction.is_empty())
}

/// Whether forces of friction within their bounds can balance the load. Collective.
///
/// # Errors
/// Bodies that slide, tip or fly away for ever.
fn carried(method: &LinearMethod, settings: &ContactSettings, loads: &Loads) -> Result<()> {
    let dual = method.dual();
    Existence::new(method, &dual, settings).in_cones(&loads.kernel)
}

/// The strategy.
pub struct Friction<'a> {
    method: &'a LinearMethod,
    settings: &'a ContactSettings,
    inner: ActiveSet<'a>,
    /// The loads of the problem.
    loads: Loads,
    nodes: Nodes,
    /// The factor on the tolerance of the user.
    accuracy: f64,
    /// Springs across slips in space, and rows along them.
    springs: CompliantRows<'a>,
    turned: TurnedRows<'a>,
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
        let tuning = &settings.tuning.friction;
        let nodes = nodes_at(method, tuning, &state.lambda, &state.active)?;
        let (rows, dual) = (&method.problem.rows, method.dual());
        let groups = nodes.iter().map(|node| {
            let row = dual.stiffness.jump.given(node.normal);
            rows[row].label.groups()
        });
        let nodes = Nodes::new(nodes.clone(), groups.collect(), *tuning);
        drop(dual);
        let mut inner = ActiveSet::new(method, settings, start)?;
        let accuracy = inner.state.accuracy;
        // Where sides stood at the end of a load step is known to its tolerance. What sticks there may seem to violate
        // a row that holds it, too.
        if any(method.session.comm(), !state.slid.is_empty()) {
            let even = settings.tuning.friction.even * method.ksp.tolerances()?.0;
            inner.open = inner.open.max(even);
        }
        let loads = inner.at.loads.clone();
        Ok(Friction {
            method,
            settings,
            inner,
            loads,
            nodes,
            accuracy,
            springs: CompliantRows::of(method),
            turned: TurnedRows::of(method),
        })
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

    /// Takes the nodes to the states that follow from the step, in which the normal rows stay or not. Collective.
    fn update(&mut self, stays: bool) -> Result<Changes> {
        let nothing = self.nothing()?;
        let state = &mut self.inner.state;
        let active = state.active.clone();
        let step = node::Step {
            lambda: &state.lambda,
            gaps: &self.inner.gaps,
            active: &active,
            nothing,
        };
        let comm = self.method.session.comm();
        let rows = (&state.before[..], &mut state.active[..], stays);
        Ok(self.nodes.update(comm, &step, rows))
    }

    /// Solves the equations of the present states, for the first time or with renewed forces. Collective.
    fn solve(&mut self, is_first: bool) -> Result<(Step, Status, ActiveSetChange)> {
        let tuning = &self.settings.tuning.friction;
        self.pose()?;
        self.inner.finer = match is_first {
            true => tuning.finer,
            false => tuning.renewed,
        };
        // States ask for more digits than the user.
        let digits = if self.inner.tight { 1.0 } else { tuning.digits };
        self.inner.state.accuracy = digits * self.accuracy;
        let solved = self.inner.try_set();
        self.inner.state.accuracy = self.accuracy;
        solved
    }

    /// Hands over to the safeguard, which begins from nothing. Collective.
    ///
    /// # Errors
    /// Bodies that slide, tip or fly away for ever.
    fn give_up(&mut self) -> Result<()> {
        self.inner.state.lambda.fill(0.0);
        self.hand_over()
    }

    /// Hands over to the safeguard, if forces of friction can balance the load at all. Collective.
    ///
    /// # Errors
    /// Bodies that slide, tip or fly away for ever.
    fn hand_over(&mut self) -> Result<()> {
        self.inner.state.safeguarded = true;
        self.carried()
    }

    /// Whether forces of friction can balance the load. Collective.
    ///
    /// # Errors
    /// Bodies that slide, tip or fly away for ever.
    fn carried(&self) -> Result<()> {
        carried(self.method, self.settings, &self.loads)
    }

    /// Whether the step has numbers for all rows: equations without digits may have none. Collective.
    fn is_finite(&self) -> bool {
        let mut numbers = self.inner.state.lambda.iter().chain(&self.inner.gaps);
        !any(self.method.session.comm(), numbers.any(|v| !v.is_finite()))
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
        Nodes::holding(&self.nodes.list, &mut active);
        let mut scores = vec![0.0; active.len()];
        self.nodes.score(self.inner.length, &mut scores);
        let mut held = active.clone();
        let put_back = self.inner.hold(&mut held, &load, &scores)?;
        let comm = self.method.session.comm();
        let restored = self.nodes.stick(comm, &active, &held);
        let law = &self.method.dual().stiffness.jump.law;
        let pairs = self.inner.state.active.iter_mut().zip(held).zip(law);
        let others = pairs.filter(|(_, law)| !law.is_friction());
        others.for_each(|((active, held), _)| *active = held);
        if self.nodes.slides(put_back > 0) {
            // The load drives a body beside all forces of friction that are given.
            let loads = (&load, &self.loads.kernel);
            if let Err(error) = self.inner.sliding(&mut active, loads) {
                // Its motion has a better name where no forces of friction at all balance the load. They do in a press
                // fit, whose forces the shape of bodies bounds.
                self.carried()?;
                return Err(error);
            }
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
            let (mut step, status, change) = match self.solve(renewal == 0) {
                // States on the way may leave bodies too loose for the natural coarse problem. Springs hold them.
                Err(e) if e.kind() == ErrorKind::NotConverged => {
                    self.give_up()?;
                    let none = Step::without(ContactType::ActiveSet);
                    return Ok((whole.unwrap_or(none), Proposal::GoOn));
                }
                other => other?,
            };
            if let Some(before) = whole {
                step = step.continuing(&before);
                self.inner.state.steps -= 1;
            }
            // Equations of states on the way may have no solution, or one without digits. Springs have one.
            if status.broke_down() || !self.is_finite() {
                self.give_up()?;
                return Ok((step, Proposal::GoOn));
            }
            if !status.converged() {
                return Ok((step, Proposal::End(status)));
            }
            let state = &mut self.inner.state;
            state.safeguarded = false;
            let is_last = renewal == tuning.renewals;
            // Where states wander, they are asked only once the forces are at rest.
            let comm = self.method.session.comm();
            if !is_last && self.nodes.misled(comm, &state.lambda) {
                self.nodes.renew(comm, &state.lambda);
                state.active.clone_from(&state.before);
                self.inner.tight = false;
                whole = Some(step);
                continue;
            }
            let stays = !any(comm, state.active != state.before);
            let Changes { flips, moves } = self.update(stays)?;
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
                if self.nodes.wander(step.wrong) {
                    self.hand_over()?;
                    self.rest()?;
                }
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
        let free = self.method.dual().natural.unheld().to_vec();
        self.rest()?;
        // Springs across slips have said where bodies are. The rows that stay may not hold them.
        if status.converged() {
            self.method.system.settle(free);
        }
        self.inner.end(steps, seconds, status)
    }
}
