//! Displacements of the sides that may touch, of all bodies or of those that a rank needs.

use std::collections::BTreeSet;
use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::checked::Scene;
use bytemuck::{Pod, Zeroable};
use fetifeti::problem::{BodyNode, RowSource};
use fetifeti::Subdomain;
use parallel::exchange::{exchange, gather_all};
use petsc::Session;

/// The displacements of all nodes of the sides that may touch: what [`Scene::renew`] needs.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Displaced {
    /// By body.
    nodes: FxHashMap<usize, Arc<FxHashMap<usize, [f64; 3]>>>,
}

/// The displacement of a node of a body.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct NodeDisplacement {
    body: usize,
    node: usize,
    u: [f64; 3],
}

/// Adds the displacements of the `wanted` nodes of which a subdomain is the owner.
fn nodes_of(
    scene: &Scene,
    sub: &Subdomain,
    u: &[f64],
    scale: f64,
    wanted: &dyn Fn(usize) -> bool,
    out: &mut Vec<NodeDisplacement>,
) {
    let (body, inside) = scene.place(sub.index);
    let c = body.components;
    let mut free = u.iter();
    for node in body.mesh().subdomain_nodes(inside) {
        let mut at = [0.0; 3];
        for (component, value) in at[..c].iter_mut().enumerate() {
            *value = match body.prescribed_at(node * c + component) {
                Some(given) => given * scale,
                None => *free.next().expect("a value for every free dof"),
            };
        }
        if wanted(node) && body.mesh().owner(node) == inside {
            out.push(NodeDisplacement {
                body: sub.body,
                node,
                u: at,
            });
        }
    }
}

impl Displaced {
    /// All of them, on every rank, from the displacements `u` of each rank's subdomains at load step `step`.
    /// Collective.
    ///
    /// # Panics
    /// For a step that the scene does not have.
    pub fn gather(
        session: &Session,
        scene: &Scene,
        local: &[Subdomain],
        u: &[Vec<f64>],
        step: usize,
    ) -> Displaced {
        let scale = scene.prescribed_factor(step);
        let wanted = scene.nodes_that_may_touch(|_| true);
        let mut mine = Vec::new();
        for (sub, u) in local.iter().zip(u) {
            if let Some(nodes) = wanted.get(&sub.body) {
                nodes_of(scene, sub, u, scale, &|n| nodes.contains(&n), &mut mine);
            }
        }
        Displaced::received(gather_all(session.comm(), &mine).concat())
    }

    /// The displacements of the sides of some bodies, which need not be the same on all ranks. Collective.
    ///
    /// # Panics
    /// As [`gather`](Self::gather).
    pub fn near(
        session: &Session,
        scene: &Scene,
        local: &[Subdomain],
        u: &[Vec<f64>],
        step: usize,
        bodies: &BTreeSet<usize>,
    ) -> Displaced {
        let comm = session.comm();
        let scale = scene.prescribed_factor(step);
        let mut parts: FxHashMap<usize, usize> = FxHashMap::default();
        local
            .iter()
            .for_each(|sub| *parts.entry(sub.body).or_default() += 1);
        let is_whole = |b: usize| parts.get(&b) == Some(&scene.bodies[b].mesh().n_subdomains());
        let ask = bodies.iter().copied().filter(|&b| !is_whole(b));
        let ask: Vec<usize> = ask.collect();
        // Who wants a body, by body: this rank, and others.
        let mut askers: FxHashMap<usize, Vec<usize>> = FxHashMap::default();
        for &body in bodies {
            askers.entry(body).or_default().push(session.rank());
        }
        for (rank, list) in gather_all(comm, &ask).into_iter().enumerate() {
            for body in list.into_iter().filter(|_| rank != session.rank()) {
                askers.entry(body).or_default().push(rank);
            }
        }
        let wanted = scene.nodes_that_may_touch(|b| askers.contains_key(&b));
        let mut outgoing = vec![Vec::new(); session.size()];
        for (sub, u) in local.iter().zip(u) {
            let (Some(nodes), Some(ranks)) = (wanted.get(&sub.body), askers.get(&sub.body)) else {
                continue;
            };
            let mut known = Vec::new();
            nodes_of(scene, sub, u, scale, &|n| nodes.contains(&n), &mut known);
            ranks.iter().for_each(|&r| outgoing[r].extend(&known));
        }
        Displaced::received(exchange(comm, outgoing))
    }

    fn received(list: Vec<NodeDisplacement>) -> Displaced {
        let mut nodes: FxHashMap<usize, FxHashMap<usize, [f64; 3]>> = FxHashMap::default();
        for at in list {
            nodes.entry(at.body).or_default().insert(at.node, at.u);
        }
        Displaced::new(nodes)
    }

    fn new(nodes: FxHashMap<usize, FxHashMap<usize, [f64; 3]>>) -> Displaced {
        let shared = nodes.into_iter().map(|(body, u)| (body, Arc::new(u)));
        Displaced {
            nodes: shared.collect(),
        }
    }

    /// From the displacements by body and node.
    pub fn of_nodes(list: &[(usize, usize, [f64; 3])]) -> Displaced {
        let mut nodes: FxHashMap<usize, FxHashMap<usize, [f64; 3]>> = FxHashMap::default();
        for &(body, node, u) in list {
            nodes.entry(body).or_default().insert(node, u);
        }
        Displaced::new(nodes)
    }

    /// The displacements by body and node, in their order.
    pub fn nodes(&self) -> Vec<(usize, usize, [f64; 3])> {
        let bodies = self.nodes.iter();
        let each = bodies.flat_map(|(&body, u)| u.iter().map(move |(&node, &u)| (body, node, u)));
        let mut list: Vec<(usize, usize, [f64; 3])> = each.collect();
        list.sort_unstable_by_key(|e| (e.0, e.1));
        list
    }

    /// The displacement of a node; zero where it is not known.
    pub fn at(&self, at: BodyNode) -> [f64; 3] {
        let of_body = self.nodes.get(&at.body);
        let found = of_body.and_then(|u| u.get(&at.node));
        found.copied().unwrap_or_default()
    }

    /// The displacements of a body by node.
    pub fn of(&self, body: usize) -> Option<Arc<FxHashMap<usize, [f64; 3]>>> {
        self.nodes.get(&body).cloned()
    }

    /// These displacements, counted from earlier ones.
    pub fn since(&self, before: &Displaced) -> Displaced {
        let of_body = |(&body, u): (&usize, &Arc<FxHashMap<usize, [f64; 3]>>)| {
            let each = u.iter().map(|(&node, u)| {
                let from = before.at(BodyNode { body, node });
                (node, [0, 1, 2].map(|d| u[d] - from[d]))
            });
            (body, each.collect())
        };
        Displaced::new(self.nodes.iter().map(of_body).collect())
    }
}

impl Scene {
    /// The displacements of all nodes of a body after load step `step`, C components each, on every rank; `u` has those
    /// of each rank's subdomains. Collective.
    ///
    /// # Panics
    /// For a body or a step that the scene does not have.
    pub fn displacements(
        &self,
        session: &Session,
        local: &[Subdomain],
        u: &[Vec<f64>],
        step: usize,
        body: usize,
    ) -> Vec<f64> {
        let (scale, c) = (self.prescribed_factor(step), self.components());
        let mut mine = Vec::new();
        let own = local.iter().zip(u).filter(|(sub, _)| sub.body == body);
        own.for_each(|(sub, u)| nodes_of(self, sub, u, scale, &|_| true, &mut mine));
        let mut out = vec![0.0; c * self.bodies[body].mesh().n_nodes()];
        for at in gather_all(session.comm(), &mine).concat() {
            out[c * at.node..c * (at.node + 1)].copy_from_slice(&at.u[..c]);
        }
        out
    }

    /// The sides that may touch of some bodies, as (body, side).
    pub(crate) fn sides_that_may_touch(
        &self,
        of: impl Fn(usize) -> bool,
    ) -> BTreeSet<(usize, usize)> {
        let mut out = BTreeSet::new();
        for (k, interface) in self.interfaces.numbered() {
            if interface.has_contact() {
                let sides = self.sides_of(RowSource::Interface(k)).into_iter();
                out.extend(sides.filter(|(body, _)| of(*body)));
            }
        }
        let obstacles = self.obstacles.iter().filter(|o| of(o.body));
        out.extend(obstacles.map(|o| (o.body, o.side)));
        out
    }

    /// The nodes that may touch of some bodies, by body.
    fn nodes_that_may_touch(
        &self,
        of: impl Fn(usize) -> bool,
    ) -> FxHashMap<usize, BTreeSet<usize>> {
        let mut out: FxHashMap<usize, BTreeSet<usize>> = FxHashMap::default();
        if self.is_renewed() {
            // Any of their sides may come to touch.
            let all = self.bodies.iter().enumerate().filter(|(b, _)| of(*b));
            return all
                .map(|(b, body)| (b, body.mesh().boundary().into_iter().collect()))
                .collect();
        }
        for (body, side) in self.sides_that_may_touch(&of) {
            let nodes = self.bodies[body].mesh().side_nodes(side);
            out.entry(body).or_default().extend(nodes);
        }
        for interface in self.interfaces.iter().filter(|i| i.has_contact()) {
            for (k, &body) in interface.bodies.iter().enumerate().filter(|(_, b)| of(**b)) {
                let nodes = interface.shared.iter().map(|s| s.nodes[k]);
                out.entry(body).or_default().extend(nodes);
            }
        }
        out
    }
}
