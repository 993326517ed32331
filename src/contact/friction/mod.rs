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
use super::modes::{CompliantRows, TurnedRows};
use super::settings::ContactSettings;
use super::state::{State, Step};
use super::strategy::{Proposal, Strategy};
use crate::feti::jump::operator::Jump;
use crate::feti::jump::turn::Turn;
use crate::feti::krylov::loads::Loads;
use crate::feti::{LinearMethod, LinearSolution};
use crate::status::Status;
use crate::{Error, Result};
use node::{Node, NodeState};
use parallel::exchange::{any, max_all, sum_all};

/// Whether a problem has friction, or rows that give way. Collective.
pub fn is_asked_for(method: &LinearMethod) -> bool {
    let soft = method.dual().stiffness.jump.soft;
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
    /// Springs across slips in space, and rows along them.
    springs: CompliantRows<'a>,
    turned: TurnedRows<'a>,
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
        let dual = method.dual();
        let jump = &dual.stiffness.jump;
        let turns = |node: &Node| node.tangential.len() < 2 || jump.can_turn(node.normal);
        if any(method.session.comm(), !nodes.iter().all(turns)) {
            return Err(Error::input(
                "friction in space at nodes that equations or rows of other nodes lead to, expected nodes with rows of \
                 their own",
            ));
        }
        drop(dual);
        let mut inner = ActiveSet::new(method, settings, start)?;
        inner.finer = settings.tuning.friction.finer;
        let loads = Loads::new(&method.problem, &method.dual());
        Ok(Friction {
            method,
            settings,
            inner,
            loads,
            nodes,
            springs: CompliantRows::of(method),
            turned: TurnedRows::of(method),
            slides: 0,
        })
    }

    /// Hands the states of the nodes to the equations.
    fn pose(&mut self) -> Result<()> {
        self.turn()?;
        let given = self.given();
        let mut springs = vec![0.0; given.len()];
        for node in &self.nodes {
            for (&t, holds) in node.tangential.iter().zip(node.holds()) {
                self.inner.state.active[t] = holds;
            }
            if let [_, across] = node.tangential[..] {
                springs[across] = node.across();
            }
        }
        self.soften(springs);
        self.method.system.set_given_multipliers(given.clone());
        self.load(&given)?;
        self.inner.renewed();
        Ok(())
    }

    /// Turns the rows of nodes that slip along their slips. Collective.
    fn turn(&mut self) -> Result<()> {
        let turns: Vec<Turn> = self.nodes.iter_mut().filter_map(Node::turn).collect();
        self.turned.turn(&turns);
        self.follow(&turns)
    }

    /// Turns the multipliers of the loop along with the rows.
    fn follow(&self, turns: &[Turn]) -> Result<()> {
        let mut lambda = self.inner.at.lambda.array_mut()?;
        for turn in turns {
            let [a, b] = turn.rows;
            [lambda[a], lambda[b]] = turn.of([lambda[a], lambda[b]]);
        }
        Ok(())
    }

    /// Puts springs into rows, beside the compliance that they have of themselves. Collective.
    fn soften(&mut self, springs: Vec<f64>) {
        let comm = self.method.session.comm();
        let some = any(comm, springs.iter().any(|s| *s > 0.0));
        // A rank without rows has an empty list in either case.
        let was = any(comm, !self.inner.springs.is_empty());
        if !some && !was {
            return;
        }
        let own = self.method.dual().stiffness.jump.compliance.clone();
        if some {
            let own = own.iter().chain(std::iter::repeat(&0.0));
            let all: Vec<f64> = springs.iter().zip(own).map(|(s, c)| s + c).collect();
            self.springs.soften(&all);
            self.inner.springs = springs;
        } else {
            self.springs.rigid();
            self.inner.springs = Vec::new();
        }
    }

    /// In space, turns the rows back. Nodes that slip then have given forces alone, those across their slips included.
    /// Collective.
    fn rest(&mut self) -> Result<()> {
        let method = self.method;
        let in_space = self.nodes.iter().any(|n| n.tangential.len() > 1);
        if !any(method.session.comm(), in_space) {
            return Ok(());
        }
        let mut active = method.dual().stiffness.jump.active.clone();
        for node in &self.nodes {
            let sticks = node.tangential.iter().all(|&t| active[t]);
            node.tangential.iter().for_each(|&t| active[t] = sticks);
        }
        let turns = self.turned.back();
        self.follow(&turns)?;
        self.soften(vec![0.0; active.len()]);
        let lambda = self.inner.at.lambda.to_vec()?;
        let mut given = vec![0.0; active.len()];
        for &t in self.nodes.iter().flat_map(|n| &n.tangential) {
            given[t] = if active[t] { 0.0 } else { lambda[t] };
        }
        method.system.set_given_multipliers(given.clone());
        method.set_active(&active)?;
        self.load(&given)?;
        (self.inner.state.active, self.inner.state.lambda) = (active, lambda);
        Ok(())
    }

    /// The given multipliers on the owned rows.
    fn given(&self) -> Vec<f64> {
        let mut given = vec![0.0; self.method.dual().stiffness.jump.n_owned];
        for node in &self.nodes {
            let force = node.on_rows(node.force());
            for (&t, f) in node.tangential.iter().zip(force) {
                given[t] = f;
            }
        }
        given
    }

    /// Hands the loads with given multipliers to the equations. Collective.
    fn load(&mut self, given: &[f64]) -> Result<()> {
        let (problem, dual) = (&self.method.problem, &self.method.dual());
        let (g, kernel) = self.loads.with_multipliers(problem, dual, given)?;
        let loads = &mut self.inner.at.loads;
        (loads.g, loads.kernel) = (g, kernel);
        Ok(())
    }

    /// Takes the nodes to the states that follow from the step. Returns the number of flips and the largest change of a
    /// force over all ranks, relative to the largest force of a row. Collective.
    fn update(&mut self) -> Result<(usize, f64)> {
        let lambda = &self.inner.state.lambda;
        let step = node::Step {
            lambda,
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
        let mut held = active.clone();
        self.inner.hold(&mut held, &load, true)?;
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
            // Which body it is, and its motion: that of the load beside all forces of friction that are given.
            let law = self.method.dual().stiffness.jump.law.clone();
            for (on, law) in active.iter_mut().zip(&law) {
                *on &= !law.is_friction();
            }
            self.inner.hold(&mut active, &load, false)?;
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
        mut self: Box<Self>,
        steps: &[Step],
        seconds: f64,
        status: Status,
    ) -> Result<LinearSolution> {
        self.rest()?;
        self.inner.end(steps, seconds, status)
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
