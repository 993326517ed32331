//! The states of nodes in the equations: rows that hold, turns, springs, given forces.

use super::node::Node;
use super::nodes::Nodes;
use super::Friction;
use crate::feti::jump::turn::Turn;
use crate::Result;
use parallel::exchange::any;
use std::collections::HashSet;

impl Friction<'_> {
    /// Hands the states of the nodes to the equations.
    pub(super) fn pose(&mut self) -> Result<()> {
        self.turn()?;
        let given = self.given();
        let mut springs = vec![0.0; given.len()];
        for node in &self.nodes.list {
            for (&t, holds) in node.tangential.iter().zip(node.holds()) {
                self.inner.state.active[t] = holds;
            }
            if let [_, across] = node.tangential[..] {
                springs[across] = node.across();
            }
        }
        self.drop_followers(&mut springs);
        self.soften(springs);
        self.method.system.set_given_multipliers(given.clone());
        self.load(&given)?;
        self.inner.renewed();
        Ok(())
    }

    /// Takes tangential rows out of the set that depend on rigid rows in it, as at an edge where several contacts hold
    /// a node: the normal row of one is a tangential row of another. Nothing slips along them, and without a force
    /// there the equations are the same.
    fn drop_followers(&mut self, springs: &mut [f64]) {
        let dual = self.method.dual();
        let jump = &dual.stiffness.jump;
        let active = &mut self.inner.state.active;
        let across: HashSet<usize> = self
            .nodes
            .list
            .iter()
            .filter_map(Node::slips_beside)
            .collect();
        let own = |i: usize| jump.compliance.get(i).copied().unwrap_or(0.0);
        for block in jump.blocks.iter().filter(|b| b.rows.len() > 3) {
            let (start, n) = (block.rows.start, block.rows.len());
            let friction = |r: usize| jump.law[start + r].is_friction();
            let rigid = |r: usize| own(start + r) + springs[start + r] == 0.0;
            let rigid: Vec<bool> = (0..n).map(rigid).collect();
            let on = |r: usize| active[start + r] && rigid[r] && !friction(r);
            let on: Vec<bool> = (0..n).map(on).collect();
            let held = (0..n).filter(|&r| active[start + r] && friction(r));
            let tuning = &self.settings.tuning.friction;
            let near = |r: usize| match across.contains(&(start + r)) {
                true => tuning.across,
                false => tuning.follows,
            };
            let mut later: Vec<(usize, f64)> = held.map(|r| (r, near(r))).collect();
            if later.is_empty() {
                continue;
            }
            later.sort_by_key(|&(r, near)| (near == tuning.across, !rigid[r]));
            for r in block.followers(&on, &later, &rigid) {
                (active[start + r], springs[start + r]) = (false, 0.0);
            }
        }
    }

    /// Turns the rows of nodes that slip along their slips. Collective.
    pub(super) fn turn(&mut self) -> Result<()> {
        let turns: Vec<Turn> = Nodes::turns(&mut self.nodes.list);
        self.turned.turn(&turns);
        self.inner.at.turn(&turns)
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
    pub(super) fn rest(&mut self) -> Result<()> {
        let method = self.method;
        let mut active = method.dual().stiffness.jump.active.clone();
        let held = active.clone();
        Nodes::sticking(&self.nodes.list, &mut active);
        let in_space = self.nodes.list.iter().any(|n| n.tangential.len() > 1);
        if !any(method.session.comm(), in_space || active != held) {
            return Ok(());
        }
        let turns = self.turned.back();
        self.inner.at.turn(&turns)?;
        self.soften(vec![0.0; active.len()]);
        let lambda = self.inner.at.lambda.to_vec()?;
        let mut given = vec![0.0; active.len()];
        for &t in self.nodes.list.iter().flat_map(|n| &n.tangential) {
            given[t] = if active[t] { 0.0 } else { lambda[t] };
        }
        method.system.set_given_multipliers(given.clone());
        method.set_active(&active)?;
        self.load(&given)?;
        (self.inner.state.active, self.inner.state.lambda) = (active, lambda);
        Ok(())
    }

    /// The given multipliers on the owned rows.
    pub(super) fn given(&self) -> Vec<f64> {
        Nodes::given(&self.nodes.list, self.inner.state.active.len())
    }

    /// Hands the loads with given multipliers to the equations. Collective.
    fn load(&mut self, given: &[f64]) -> Result<()> {
        let (problem, dual) = (&self.method.problem, &self.method.dual());
        let (g, kernel) = self.loads.with_multipliers(problem, dual, given)?;
        let loads = &mut self.inner.at.loads;
        (loads.g, loads.kernel) = (g, kernel);
        Ok(())
    }
}
