//! The shared nodes at whose points some bodies have nodes: a rank groups those alone.

use crate::geometry::interface::BodyInterface;

/// Nodes of some bodies, and all that coincide with one of them, by way of other nodes too.
pub(super) struct Reach {
    /// Whether all nodes are meant.
    everywhere: bool,
    /// Whether all nodes of a body are.
    whole: Vec<bool>,
    /// The nodes of other bodies; empty where there are none.
    nodes: Vec<Vec<bool>>,
}

impl Reach {
    /// The nodes that are reached from the bodies that are `whole`. `sizes` has the number of nodes of a body.
    pub fn of(
        whole: Vec<bool>,
        sizes: impl Fn(usize) -> usize,
        interfaces: &[BodyInterface],
    ) -> Reach {
        let everywhere = whole.iter().all(|w| *w);
        let nodes = vec![Vec::new(); whole.len()];
        let mut reach = Reach {
            everywhere,
            whole,
            nodes,
        };
        let mut more = !everywhere;
        // A pass for each interface that lies between a node and the bodies: two or three as a rule.
        while more {
            more = false;
            for interface in interfaces.iter().filter(|i| i.mortar.is_none()) {
                let [a, b] = interface.bodies;
                if !reach.touches(interface) || (reach.whole[a] && reach.whole[b]) {
                    continue;
                }
                for shared in &interface.shared {
                    let pair = [(a, shared.nodes[0]), (b, shared.nodes[1])];
                    let [first, second] = pair.map(|(body, node)| reach.has(body, node));
                    if first == second {
                        continue;
                    }
                    let (body, node) = pair[usize::from(first)];
                    let nodes = &mut reach.nodes[body];
                    if nodes.is_empty() {
                        *nodes = vec![false; sizes(body)];
                    }
                    nodes[node] = true;
                    more = true;
                }
            }
        }
        reach
    }

    /// Whether it has a node.
    pub fn has(&self, body: usize, node: usize) -> bool {
        let known = &self.nodes[body];
        self.everywhere || self.whole[body] || known.get(node).is_some_and(|n| *n)
    }

    /// Whether it may have nodes of an interface.
    pub fn touches(&self, interface: &BodyInterface) -> bool {
        let some = |body: usize| self.whole[body] || !self.nodes[body].is_empty();
        self.everywhere || interface.bodies.into_iter().any(some)
    }
}
