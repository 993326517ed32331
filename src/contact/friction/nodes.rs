//! All nodes with friction, and what the loop on their states remembers. Whoever solves the equations of the states has
//! this one loop on them.

use super::mixing::Mixing;
use super::node::{Node, NodeState, Step};
use super::tuning::FrictionTuning;
use crate::contact::state::ActiveSetProgress;
use crate::feti::jump::turn::Turn;
use mpi::topology::SimpleCommunicator;
use parallel::exchange::{any, gather_all, highest, max_all, sum_all};
use std::collections::HashMap;

/// The nodes of a rank.
pub struct Nodes {
    /// The nodes.
    pub list: Vec<Node>,
    /// The contact of each node, and its bodies ([`RowLabel::groups`](crate::substructures::RowLabel::groups)).
    groups: Vec<[[usize; 2]; 3]>,
    tuning: FrictionTuning,
    mixing: Mixing,
    progress: ActiveSetProgress,
    /// Steps in a row after which rows had to be put back.
    slides: usize,
}

/// The states that follow from a step, over all ranks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Changes {
    /// Nodes with another state.
    pub flips: usize,
    /// The largest change of a force, relative to the largest force of a row.
    pub moves: f64,
}

impl Nodes {
    /// These nodes, each of which belongs to a contact and to bodies.
    pub fn new(list: Vec<Node>, groups: Vec<[[usize; 2]; 3]>, tuning: FrictionTuning) -> Nodes {
        Nodes {
            list,
            groups,
            tuning,
            mixing: Mixing::default(),
            progress: ActiveSetProgress::default(),
            slides: 0,
        }
    }

    /// Turns that bring rows along slips.
    pub fn turns(list: &mut [Node]) -> Vec<Turn> {
        list.iter_mut().filter_map(Node::turn).collect()
    }

    /// The given forces on `n` rows as they are turned.
    pub fn given(list: &[Node], n: usize) -> Vec<f64> {
        let mut given = vec![0.0; n];
        for node in list {
            let force = node.on_rows(node.force());
            for (&t, f) in node.tangential.iter().zip(force) {
                given[t] = f;
            }
        }
        given
    }

    /// The bounds g of the nodes that slip; 0 for the others, whose forces do not depend on g.
    fn bounds(&self) -> Vec<f64> {
        self.list.iter().map(Node::slipping).collect()
    }

    /// The bounds that follow from the multipliers of a step for the nodes that slip; 0 for the others.
    fn following(&self, lambda: &[f64]) -> Vec<f64> {
        self.list.iter().map(|n| n.following(lambda)).collect()
    }

    /// Whether states wander and the forces have yet to move: they are given, and mislead. Collective.
    pub fn misled(&self, comm: &SimpleCommunicator, lambda: &[f64]) -> bool {
        if !self.progress.stalled(self.tuning.patience) {
            return false;
        }
        let pairs = self.following(lambda).into_iter().zip(self.bounds());
        let moves = pairs.fold(0.0f64, |a, (next, g)| a.max((next - g).abs()));
        highest(comm, moves) > self.tuning.rest * largest(comm, lambda)
    }

    /// Gives slipping nodes the forces that follow from a step; all nodes stay in their states. Collective.
    pub fn renew(&mut self, comm: &SimpleCommunicator, lambda: &[f64]) {
        let mapped = self.following(lambda);
        self.mix(comm, self.bounds(), &mapped);
    }

    /// Mixes bounds and those that follow from them. Collective.
    fn mix(&mut self, comm: &SimpleCommunicator, before: Vec<f64>, mapped: &[f64]) {
        let mixed = self.mixing.mix(comm, self.tuning.mixed, before, mapped);
        for (node, g) in self.list.iter_mut().zip(mixed) {
            node.g = g.max(0.0);
        }
    }

    /// Takes the nodes to the states that follow from a step. `before` and `next` say which rows hold in it and are to
    /// hold after it, `stays` whether the normal rows among them are the same. Where states wander, of each body
    /// only the nodes that are most wrong change, in `next`, too: all of them at once go too far, and back in the next
    /// step. Collective.
    pub fn update(
        &mut self,
        comm: &SimpleCommunicator,
        step: &Step<'_>,
        (before, next, stays): (&[bool], &mut [bool], bool),
    ) -> Changes {
        let bounds = self.bounds();
        let waits = self.waiting(comm, step, before);
        let (mut flips, mut moves) = ([0.0], [0.0f64]);
        for (node, waits) in self.list.iter_mut().zip(waits) {
            let change = node.update(step, waits);
            if waits {
                next[node.normal] = before[node.normal];
            }
            flips[0] += f64::from(u8::from(change.flips));
            moves[0] = moves[0].max(change.moves);
        }
        sum_all(comm, &mut flips);
        max_all(comm, &mut moves);
        if flips[0] == 0.0 && stays {
            let nodes = self.list.iter_mut();
            flips[0] = nodes.map(|n| f64::from(u8::from(n.gives_way(step)))).sum();
            sum_all(comm, &mut flips);
        }
        if flips[0] > 0.0 || !stays {
            self.mixing.restart();
        } else {
            self.mix(comm, bounds, &self.bounds());
        }
        Changes {
            flips: flips[0] as usize,
            moves: moves[0] / largest(comm, step.lambda),
        }
    }

    /// Whether each node waits, because others of its contact or its bodies, on any rank, are far more wrong after a
    /// step. Collective.
    fn waiting(&self, comm: &SimpleCommunicator, step: &Step<'_>, before: &[bool]) -> Vec<bool> {
        if !self.progress.stalled(self.tuning.waits) {
            return vec![false; self.list.len()];
        }
        let nodes = self.list.iter();
        let wrong = nodes.map(|node| node.wrong(step, before[node.normal]));
        let wrong: Vec<f64> = wrong.collect();
        let pairs = self.groups.iter().zip(&wrong);
        let here = worst(pairs.flat_map(|(groups, w)| groups.map(|group| (group, *w))));
        let sent = here
            .iter()
            .map(|([kind, k], w)| [*kind as u64, *k as u64, w.to_bits()]);
        let all = gather_all(comm, &sent.collect::<Vec<_>>()).concat();
        let worst = worst(
            all.iter()
                .map(|[kind, k, w]| ([*kind as usize, *k as usize], f64::from_bits(*w))),
        );
        let least = self.tuning.most_wrong;
        let pairs = self.groups.iter().zip(wrong);
        let waits = pairs.map(|(groups, wrong)| {
            let most = groups
                .iter()
                .fold(0.0f64, |a, g| a.max(worst.get(g).copied().unwrap_or(0.0)));
            wrong > 0.0 && wrong < least * most
        });
        waits.collect()
    }

    /// Which tangential rows hold, into `held`: those of nodes that stick, and springs across slips. A body near its
    /// limit stands although all its nodes slip, because their forces turn with the slips.
    pub fn holding(list: &[Node], held: &mut [bool]) {
        for node in list {
            for (&t, holds) in node.tangential.iter().zip(node.holds()) {
                held[t] = holds;
            }
        }
    }

    /// Which tangential rows hold because their nodes stick, into `held`.
    pub fn sticking(list: &[Node], held: &mut [bool]) {
        for node in list {
            let sticks = node.state == NodeState::Stick;
            node.tangential.iter().for_each(|&t| held[t] = sticks);
        }
    }

    /// The scores of tangential rows where rows have to be put back, into `scores`; the largest displacement is
    /// `length`. Of nodes that slip the one that slips least is first: the others then slip on in their directions.
    /// Where that does not help, rows that push come first: a body that tips comes to rest on them.
    pub fn score(&self, length: f64, scores: &mut [f64]) {
        let late = match self.slides >= self.tuning.tips {
            true => f64::MAX.sqrt(),
            false => 0.0,
        };
        let length = length.max(f64::MIN_POSITIVE);
        for node in &self.list {
            let score = -node.excess - late * (1.0 + node.excess / length);
            node.tangential.iter().for_each(|&t| scores[t] = score);
        }
    }

    /// Lets nodes stick whose rows were put back: they hold in `held`, and did not in `before`. Returns whether there
    /// are some on any rank. Collective.
    pub fn stick(&mut self, comm: &SimpleCommunicator, before: &[bool], held: &[bool]) -> bool {
        let mut some = false;
        for node in &mut self.list {
            if node.tangential.iter().any(|&t| held[t] && !before[t]) {
                node.state = NodeState::Stick;
                some = true;
            }
        }
        any(comm, some)
    }

    /// Notes whether rows had to be put back after a step. Returns whether a body slides away, because they had to for
    /// many steps.
    pub fn slides(&mut self, put_back: bool) -> bool {
        self.slides = if put_back { self.slides + 1 } else { 0 };
        self.slides > self.tuning.slides
    }

    /// Notes the number of wrong rows and nodes after a step. Returns whether states have wandered for so long that
    /// another strategy is to take over.
    pub fn wander(&mut self, wrong: usize) -> bool {
        self.progress.note(wrong);
        self.progress.stalled(self.tuning.wanders)
    }
}

/// The largest value of each group that has a positive one.
fn worst(pairs: impl Iterator<Item = ([usize; 2], f64)>) -> HashMap<[usize; 2], f64> {
    let mut out: HashMap<[usize; 2], f64> = HashMap::new();
    for (group, value) in pairs.filter(|(_, value)| *value > 0.0) {
        let most = out.entry(group).or_default();
        *most = most.max(value);
    }
    out
}

/// The largest force of a row; 1 if there is none. Collective.
fn largest(comm: &SimpleCommunicator, lambda: &[f64]) -> f64 {
    let largest = highest(comm, lambda.iter().fold(0.0f64, |a, l| a.max(l.abs())));
    if largest > 0.0 {
        largest
    } else {
        1.0
    }
}

#[cfg(test)]
#[path = "../../../tests/inside/contact/friction/nodes.rs"]
mod tests;
