//! The states of nodes in the equations: rows that hold, springs, given forces.

use super::{StickAndSlip, STIFFER};
use crate::assembled::equations::Solved;
use crate::assembled::exerted::{ExertedForces, RowSpring};
use crate::assembled::potentials::Potentials;
use fetifeti::inside::node::{Node, NodeState};
use fetifeti::inside::nodes::Nodes;

impl StickAndSlip<'_, '_> {
    /// Hands the states of the nodes to the equations: rows that hold, springs, given forces.
    pub(super) fn pose(&mut self) {
        let rows = self.rows;
        let active = &mut self.state.active;
        let mut sets = Potentials::new(rows.ground() + 1);
        let mut join = |r: usize| {
            let row = rows.rows[r];
            sets.join(row.plus, row.minus, 0.0).is_none()
        };
        for node in &mut self.nodes.list {
            node.turn();
        }
        Nodes::sticking(&self.nodes.list, active);
        let tangential = rows.tangential();
        let rigid = |r: &usize| rows.softness(*r) == 0.0;
        for r in (0..rows.len())
            .filter(rigid)
            .filter(|&r| active[r] && !tangential[r])
        {
            join(r);
        }
        // What follows from other rows, as at an edge, has no force.
        let stuck: Vec<usize> = (0..rows.len())
            .filter(|&r| active[r] && tangential[r])
            .collect();
        for r in stuck.into_iter().filter(rigid) {
            active[r] = join(r);
        }
        let mut apart = |&t: &usize| {
            let row = rows.rows[t];
            sets.find(row.plus).0 != sets.find(row.minus).0
        };
        self.held.clear();
        for node in &self.nodes.list {
            self.held.push(!node.tangential.iter().all(&mut apart));
        }
        self.state.exerted = ExertedForces {
            springs: self.springs(),
            given: self.given(),
        };
        // Normal rows come first.
        self.state.priority.sort_by_key(|&r| tangential[r]);
    }

    /// The springs of the states: of rows that give way, and across slips in space. There are none across a slip that
    /// other rows hold.
    fn springs(&self) -> Vec<RowSpring> {
        let (rows, active) = (self.rows, &self.state.active);
        let compliant = (0..rows.len()).filter(|&r| active[r] && rows.softness(r) > 0.0);
        let mut springs: Vec<RowSpring> = compliant
            .map(|r| RowSpring {
                rows: vec![(r, 1.0)],
                stiffness: 1.0 / rows.softness(r),
                rest: 0.0,
            })
            .collect();
        for (node, &held) in self.nodes.list.iter().zip(&self.held) {
            let Some(across) = self.across(node).filter(|_| !held) else {
                continue;
            };
            let [a, b] = across.map(|(row, _)| row);
            let least = self.tuning.rigid * self.give[a].max(self.give[b]);
            let own = rows.softness(b) * rows.scale_of(b).powi(2);
            springs.push(RowSpring {
                rows: across.to_vec(),
                stiffness: 1.0 / (node.across().max(least) + own),
                rest: 0.0,
            });
        }
        springs
    }

    /// The rows across the slip of a node with their coefficients, where a spring holds them.
    pub(super) fn across(&self, node: &Node) -> Option<[(usize, f64); 2]> {
        let (NodeState::Slip(d), &[a, b]) = (node.state, &node.tangential[..]) else {
            return None;
        };
        let scale = |r: usize| self.rows.scale_of(r);
        node.holds()[1].then(|| [(a, -d[1] * scale(a)), (b, d[0] * scale(b))])
    }

    /// Hands the renewed forces to the equations of the same states. The matrix stays, unless springs have changed
    /// much: one that is kept is at rest at the present slip.
    pub(super) fn renew(&mut self, solved: Solved) {
        self.nodes.list.iter_mut().for_each(|node| {
            node.turn();
        });
        self.state.exerted.given = self.given();
        let fresh = ExertedForces {
            springs: self.springs(),
            given: Vec::new(),
        };
        if fresh.rows_changed(&self.state.exerted, STIFFER) > 0 {
            self.state.exerted.springs = fresh.springs;
            return;
        }
        // A spring acts on differences, those that rows give way included.
        let judged = &solved.judged;
        let pairs = judged.gaps.iter().zip(&judged.lambda).enumerate();
        let differences: Vec<f64> = pairs
            .map(|(r, (gap, l))| gap + self.rows.softness(r) * l)
            .collect();
        let springs = self.state.exerted.springs.iter_mut();
        for spring in springs.filter(|spring| spring.rows.len() > 1) {
            spring.rest = spring.jump(&differences);
        }
        self.equations.borrow_mut().again(solved);
    }

    /// The given forces of nodes that slip, by row.
    pub(super) fn given(&self) -> Vec<f64> {
        let mut given = vec![0.0; self.rows.len()];
        for node in &self.nodes.list {
            for (&t, force) in node.tangential.iter().zip(node.force()) {
                given[t] = self.rows.scale_of(t) * force;
            }
        }
        given
    }
}
