//! Contact with friction: the active set of normal rows and of nodes that stick or slip (docs/theory.md, section 9).
//!
//! ```text
//!     stick    B_t u = c_t                        slip    f ← f − B_tᵀ g d
//!     g ← μ λ_n,    d ← s/|s|,    s = λ_t + k w    after every step
//! ```
//!
//! A step solves the equations of these states by the linear method: nothing is factored again, and the operators stay
//! symmetric. Normal rows follow the rule of the active set in the same step.

mod node;
pub(super) mod tuning;

use super::active_set::{ActiveSet, ActiveSetChange};
use super::course::DualCourse;
use super::settings::ContactSettings;
use super::state::{State, Step};
use super::strategy::{Proposal, Strategy};
use crate::feti::jump::operator::Jump;
use crate::feti::krylov::loads::Loads;
use crate::feti::{LinearMethod, LinearSolution};
use crate::status::Status;
use crate::Result;
use node::{Node, NodeState};
use parallel::exchange::{any, max_all, sum_all};

/// Whether a problem has friction, or rows that give way. Collective.
pub fn is_asked_for(method: &LinearMethod) -> bool {
    let soft = !method.dual().stiffness.jump.compliance.is_empty();
    let some = soft || !method.problem.friction.is_empty();
    any(method.session.comm(), some)
}

/// Given multipliers of rows, for as long as friction needs them: a guard that takes them away again.
pub struct GivenMultipliers<'a>(&'a LinearMethod);

impl<'a> GivenMultipliers<'a> {
    /// The rows of `method`, without given multipliers.
    pub fn of(method: &'a LinearMethod) -> GivenMultipliers<'a> {
        GivenMultipliers(method)
    }
}

impl Drop for GivenMultipliers<'_> {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            self.0.system.set_given_multipliers(Vec::new());
        }
    }
}

/// The strategy.
pub struct Friction<'a> {
    method: &'a LinearMethod,
    settings: &'a ContactSettings,
    inner: ActiveSet<'a>,
    /// The loads of the problem.
    loads: Loads,
    nodes: Vec<Node>,
    /// Steps in a row after which nothing but friction beyond its bound held a body.
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
        let nodes = nodes(method, &state.lambda, &state.active)?;
        let mut inner = ActiveSet::new(method, settings, start)?;
        inner.finer = settings.tuning.friction.finer;
        let loads = Loads::new(&method.problem, &method.dual());
        Ok(Friction {
            method,
            settings,
            inner,
            loads,
            nodes,
            slides: 0,
        })
    }

    /// Hands the states of the nodes to the equations.
    fn pose(&mut self) -> Result<()> {
        let (given, active) = (&self.given(), &mut self.inner.state.active);
        for node in &self.nodes {
            let sticks = node.state == NodeState::Stick;
            node.tangential.iter().for_each(|&t| active[t] = sticks);
        }
        self.method.system.set_given_multipliers(given.clone());
        self.inner.at.loads = self.loads_with(given)?;
        self.inner.renewed();
        Ok(())
    }

    /// The given multipliers on the owned rows.
    fn given(&self) -> Vec<f64> {
        let mut given = vec![0.0; self.method.dual().stiffness.jump.n_owned];
        for node in &self.nodes {
            for (&t, f) in node.tangential.iter().zip(node.force()) {
                given[t] = f;
            }
        }
        given
    }

    fn loads_with(&self, given: &[f64]) -> Result<Loads> {
        let local = &self.method.problem.local;
        let f: Vec<&[f64]> = local.iter().map(|s| &s.f[..]).collect();
        self.loads.with_multipliers(&self.method.dual(), &f, given)
    }

    /// Takes the nodes to the states that follow from the step. Returns the number of flips and the largest change of a
    /// force over all ranks, relative to the largest force of a row. Collective.
    fn update(&mut self) -> Result<(usize, f64)> {
        let lambda = self.inner.state.lambda.clone();
        let step = node::Step {
            lambda: &lambda,
            gaps: &self.inner.gaps,
            active: &self.inner.state.active,
        };
        let (mut flips, mut moves) = ([0.0], 0.0f64);
        for node in &mut self.nodes {
            let change = node.update(&step);
            flips[0] += f64::from(u8::from(change.flips));
            moves = moves.max(change.moves);
        }
        let comm = self.method.session.comm();
        sum_all(comm, &mut flips);
        let mut largest = [moves, lambda.iter().fold(0.0, |a, l| a.max(l.abs()))];
        max_all(comm, &mut largest);
        let [moves, force] = largest;
        let moves = if force > 0.0 { moves / force } else { 0.0 };
        Ok((flips[0] as usize, moves))
    }

    /// Lets nodes stick where slipping ones leave a body loose that the load drives. Returns whether some had to.
    ///
    /// # Errors
    /// Bodies that slide or fly away: for some steps nothing but friction beyond its bound has held them.
    fn hold(&mut self) -> Result<bool> {
        let given = self.given();
        let load = self.loads_with(&given)?.kernel;
        let mut active = self.inner.state.active.clone();
        for node in &self.nodes {
            let sticks = node.state == NodeState::Stick;
            node.tangential.iter().for_each(|&t| active[t] = sticks);
        }
        let mut held = active.clone();
        let any_row = |_: usize| true;
        self.inner.hold(&mut held, &load, &any_row)?;
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
        self.slides = if restored { self.slides + 1 } else { 0 };
        if self.slides > self.settings.tuning.friction.slides {
            let law = self.method.dual().stiffness.jump.law.clone();
            let normal = |r: usize| !law[r].is_friction();
            self.inner.hold(&mut active, &load, &normal)?;
        }
        Ok(restored)
    }
}

impl Strategy<DualCourse> for Friction<'_> {
    fn state(&self) -> &State {
        &self.inner.state
    }

    fn step(&mut self) -> Result<(Step, Proposal<Status>)> {
        self.pose()?;
        let (mut step, status, change) = self.inner.try_set()?;
        if !status.converged() {
            return Ok((step, Proposal::End(status)));
        }
        self.inner.state.safeguarded = false;
        let (flips, moves) = self.update()?;
        let restored = self.hold()?;
        step.wrong += flips;
        let settled = flips == 0 && !restored;
        let rtol = self.method.ksp.tolerances()?.0;
        let still = settled && moves <= self.settings.tuning.friction.still * rtol;
        if still && change == ActiveSetChange::Solved {
            return Ok((step, Proposal::End(status)));
        }
        // A step to the end is worth it where the forces of friction have come to rest.
        self.inner.tight &= still;
        Ok((step, Proposal::GoOn))
    }

    fn finish(
        self: Box<Self>,
        steps: &[Step],
        seconds: f64,
        status: Status,
    ) -> Result<LinearSolution> {
        let Friction { inner, .. } = *self;
        inner.end(steps, seconds, status)
    }
}

/// The nodes of this rank in the states that multipliers and a set say. Collective.
fn nodes(method: &LinearMethod, lambda: &[f64], active: &[bool]) -> Result<Vec<Node>> {
    let dual = method.dual();
    let jump = &dual.stiffness.jump;
    let compliance = dual.stiffness.compliance_of_rows(&method.problem)?;
    let place = places(jump);
    let node = |given| Node::new(jump, given, |r| place[r], (lambda, active), &compliance);
    Ok(method.problem.friction.iter().map(node).collect())
}

/// The owned row of each row that this rank provides.
fn places(jump: &Jump) -> Vec<usize> {
    let rows = jump.rows_between_bodies();
    let mut place = vec![0; rows.len()];
    for i in rows {
        place[jump.given(i)] = i;
    }
    place
}

/// The largest distance of a solution from the law of friction, as a force. Collective.
pub fn error(method: &LinearMethod, solution: &LinearSolution) -> Result<f64> {
    let held = &method.dual().stiffness.jump.active.clone();
    let step = node::Step {
        lambda: &solution.lambda,
        gaps: &solution.gaps,
        active: held,
    };
    let nodes = nodes(method, &solution.lambda, held)?;
    let mut largest = [nodes.iter().fold(0.0, |a: f64, n| a.max(n.error(&step)))];
    max_all(method.session.comm(), &mut largest);
    Ok(largest[0])
}
