//! Friction at rows of the host: the nodes go to the ranks that take their rows.

use std::collections::HashMap;

use crate::substructures::{FrictionBound, FrictionNode};
use bytemuck::{Pod, Zeroable};
use parallel::exchange::exchange_by_rank;
use petsc::Session;

/// A node on its way to another rank, with the numbers of its rows among those that its rank gave.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct SentNode {
    normal: usize,
    /// The largest number where there is no second one.
    tangential: [usize; 2],
    /// 1 for Tresca's law, which has a bound alone, 0 for Coulomb's.
    given: u64,
    coefficient: f64,
    /// The limit, or the given bound.
    limit: f64,
}

impl SentNode {
    fn new(normal: usize, tangential: &[usize], bound: FrictionBound) -> SentNode {
        let (given, coefficient, limit) = match bound {
            FrictionBound::Coulomb { coefficient, limit } => (0, coefficient, limit),
            FrictionBound::Tresca(bound) => (1, 0.0, bound),
        };
        let second = tangential.get(1).copied();
        SentNode {
            normal,
            tangential: [tangential[0], second.unwrap_or(usize::MAX)],
            given,
            coefficient,
            limit,
        }
    }

    /// The node, if the row with a number has this place.
    fn node(self, place: impl Fn(usize) -> usize) -> FrictionNode {
        let tangential = self.tangential.into_iter().filter(|t| *t != usize::MAX);
        let bound = match self.given {
            0 => FrictionBound::Coulomb {
                coefficient: self.coefficient,
                limit: self.limit,
            },
            _ => FrictionBound::Tresca(self.limit),
        };
        FrictionNode::new(place(self.normal), tangential.map(&place).collect(), bound)
    }
}

/// Leaves out the tangential rows of nodes whose normal row is left out, as it has no unknowns.
pub fn leave_out<T>(nodes: &[FrictionNode], rows: &mut [Option<T>]) {
    for node in nodes {
        if rows[node.normal].is_none() {
            node.tangential.iter().for_each(|&t| rows[t] = None);
        }
    }
}

/// The nodes whose rows this rank takes, by the places of their rows there. `homes` has the rank that takes each row
/// that this rank gave: a tangential row without unknowns has none, and its node does without it. `places` has the
/// place of each row that this rank takes, by the rank that gave it and its number there. Collective.
pub fn forth(
    session: &Session,
    given: &[FrictionNode],
    homes: &[Option<usize>],
    places: &HashMap<(usize, usize), usize>,
) -> Vec<FrictionNode> {
    let mut outgoing = vec![Vec::new(); session.size()];
    for node in given {
        let taken = node.tangential.iter().copied();
        let taken: Vec<usize> = taken.filter(|&t| homes[t].is_some()).collect();
        if let (Some(home), false) = (homes[node.normal], taken.is_empty()) {
            outgoing[home].push(SentNode::new(node.normal, &taken, node.bound));
        }
    }
    let received = exchange_by_rank(session.comm(), outgoing);
    let by_rank = received.into_iter().enumerate();
    let nodes = by_rank.flat_map(|(rank, nodes)| {
        let here = move |node: SentNode| node.node(|number| places[&(rank, number)]);
        nodes.into_iter().map(here)
    });
    nodes.collect()
}
