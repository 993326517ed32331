//! Where bodies meet: the shared nodes of all interfaces, grouped by position.

use super::reach::Reach;
use crate::body::Body;
use crate::geometry::interface::{BodyInterface, Link};
use base::linalg::union_find::UnionFind;
use fetifeti::problem::BodyNode;

/// Two members of a set that share a node of an interface.
#[derive(Debug, Clone, Copy)]
pub(super) struct CoincidentMembers {
    /// Their places in the set.
    pub members: [usize; 2],
    /// The interface.
    pub interface: usize,
    /// The index into its `shared`.
    pub node: usize,
}

impl CoincidentMembers {
    /// How the interface joins the two.
    pub fn link(&self, interfaces: &[BodyInterface]) -> Link {
        interfaces[self.interface].shared[self.node].link
    }
}

/// Nodes that coincide, set by set, without a list of its own for each.
pub(super) struct Meeting {
    /// The members of all sets; in a set by increasing body and node, sets by increasing first member.
    members: Vec<BodyNode>,
    /// The pairs of all sets, in the order of interfaces.
    pairs: Vec<NodePair>,
    /// The start of each set in `members` and in `pairs`, and the ends.
    starts: Vec<[u32; 2]>,
}

/// A pair of nodes, as numbers of nodes before they are sorted and as places in their set afterwards.
#[derive(Debug, Clone, Copy, Default)]
struct NodePair {
    nodes: [u32; 2],
    interface: u32,
    node: u32,
}

/// The number of a node that has none.
const NONE: u32 = u32::MAX;

impl Meeting {
    /// Groups the shared nodes that are reached, of all interfaces whose nodes match.
    pub fn of(bodies: &[Body], interfaces: &[BodyInterface], reach: &Reach) -> Meeting {
        let (mut nodes, mut sets, found) = number(bodies, interfaces, reach);
        // Sets in the order of their first members.
        let roots: Vec<u32> = (0..nodes.len()).map(|id| sets.find(id) as u32).collect();
        drop(sets);
        let at = |id: u32| (nodes[id as usize].body, nodes[id as usize].node);
        let mut lowest: Vec<u32> = (0..nodes.len() as u32).collect();
        for id in 0..nodes.len() as u32 {
            let low = &mut lowest[roots[id as usize] as usize];
            if at(id) < at(*low) {
                *low = id;
            }
        }
        let is_root = |id: &u32| roots[*id as usize] == *id;
        let mut order: Vec<u32> = (0..nodes.len() as u32).filter(is_root).collect();
        order.sort_unstable_by_key(|&root| at(lowest[root as usize]));
        let mut place = lowest;
        for (k, &root) in order.iter().enumerate() {
            place[root as usize] = k as u32;
        }
        let set_of = |id: u32| place[roots[id as usize] as usize] as usize;

        let mut starts = vec![[0_u32; 2]; order.len() + 1];
        (0..nodes.len() as u32).for_each(|id| starts[set_of(id) + 1][0] += 1);
        found
            .iter()
            .for_each(|pair| starts[set_of(pair.nodes[0]) + 1][1] += 1);
        for k in 0..order.len() {
            let before = starts[k];
            starts[k + 1] = [0, 1].map(|i| starts[k + 1][i] + before[i]);
        }
        let mut next = starts.clone();
        let mut ids = vec![NONE; nodes.len()];
        for id in 0..nodes.len() as u32 {
            let free = &mut next[set_of(id)][0];
            ids[*free as usize] = id;
            *free += 1;
        }
        let mut pairs = vec![NodePair::default(); found.len()];
        for pair in found {
            let free = &mut next[set_of(pair.nodes[0])][1];
            pairs[*free as usize] = pair;
            *free += 1;
        }
        for k in 0..order.len() {
            let [from, to] = [starts[k], starts[k + 1]];
            let ids = &mut ids[from[0] as usize..to[0] as usize];
            ids.sort_unstable_by_key(|&id| at(id));
            for pair in &mut pairs[from[1] as usize..to[1] as usize] {
                pair.nodes = pair.nodes.map(|id| {
                    let place = ids.iter().position(|other| *other == id);
                    place.expect("both nodes of a pair are in its set") as u32
                });
            }
        }
        nodes = ids.iter().map(|&id| nodes[id as usize]).collect();
        Meeting {
            members: nodes,
            pairs,
            starts,
        }
    }

    /// The members and the pairs of each set.
    pub fn sets(
        &self,
    ) -> impl Iterator<Item = (&[BodyNode], impl Iterator<Item = CoincidentMembers> + '_)> {
        self.starts.windows(2).map(|ends| {
            let [from, to] = [ends[0], ends[1]].map(|ends| ends.map(|end| end as usize));
            let pairs = self.pairs[from[1]..to[1]]
                .iter()
                .map(|found| CoincidentMembers {
                    members: found.nodes.map(|place| place as usize),
                    interface: found.interface as usize,
                    node: found.node as usize,
                });
            (&self.members[from[0]..to[0]], pairs)
        })
    }
}

/// Numbers the shared nodes that are reached: the nodes by number, those that coincide in one set, and the pairs.
fn number(
    bodies: &[Body],
    interfaces: &[BodyInterface],
    reach: &Reach,
) -> (Vec<BodyNode>, UnionFind, Vec<NodePair>) {
    let matching = || {
        let all = interfaces.iter().enumerate();
        let all = all.filter(|(_, i)| i.mortar.is_none() && !i.shared.is_empty());
        all.filter(|(_, i)| reach.touches(i))
    };
    // By body the number of each node; empty for bodies without an interface.
    let mut number: Vec<Vec<u32>> = vec![Vec::new(); bodies.len()];
    let mut nodes: Vec<BodyNode> = Vec::new();
    let mut sets = UnionFind::default();
    let mut pairs: Vec<NodePair> =
        Vec::with_capacity(matching().map(|(_, i)| i.shared.len()).sum());
    for (i, interface) in matching() {
        for body in interface.bodies {
            if number[body].is_empty() {
                number[body] = vec![NONE; bodies[body].mesh().n_nodes()];
            }
        }
        let shared = interface.shared.iter().enumerate();
        for (k, shared) in shared.filter(|(_, s)| reach.has(interface.bodies[0], s.nodes[0])) {
            let ids = [0, 1].map(|side| {
                let (body, node) = (interface.bodies[side], shared.nodes[side]);
                let known = &mut number[body][node];
                if *known == NONE {
                    *known = sets.add() as u32;
                    nodes.push(BodyNode { body, node });
                }
                *known
            });
            sets.join(ids[0] as usize, ids[1] as usize);
            pairs.push(NodePair {
                nodes: ids,
                interface: i as u32,
                node: k as u32,
            });
        }
    }
    (nodes, sets, pairs)
}
