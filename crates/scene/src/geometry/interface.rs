//! The interface of two bodies: pairs of nodes, and how each pair is joined.

use std::collections::BTreeMap;

use super::mortar_sides::Mortar;
use crate::body::Body;
use crate::model::entry::EntryId;
use crate::model::profile::Limits;

/// Two positions are equal if they differ by less than this fraction of the smaller element.
pub(crate) const TOLERANCE: f64 = 1e-6;

/// How two coinciding nodes are joined.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Link {
    /// Not at all.
    Free,
    /// Not joined to begin with, on a face where the bodies may be joined: candidate contact nodes.
    Open,
    /// u is continuous.
    Tied,
    /// u_first − u_second ≤ gap, in elasticity along the normal.
    Contact {
        /// The gap, at the last load step.
        gap: f64,
    },
}

impl Link {
    /// Whether the nodes are in (unilateral) contact.
    pub fn is_contact(&self) -> bool {
        matches!(self, Link::Contact { .. })
    }
}

/// The shape of the common part of two bodies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InterfaceShape {
    /// A part of their sides: a stretch in the plane, an area in three dimensions.
    Face,
    /// A part of lower dimension: a corner point, or an edge of a solid.
    Corner,
}

/// Nodes of two bodies at the same position, or opposite each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SharedNode {
    /// The node in the first and in the second body.
    pub nodes: [usize; 2],
    /// Parameters along the common face, 0 ≤ t ≤ 1: one in the plane (the other is 0), two in three dimensions; 0 at a
    /// corner.
    pub t: [f64; 2],
    /// How they are joined.
    pub link: Link,
}

/// Two bodies that touch, or have sides that face each other; or two sides of one body.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyInterface {
    /// The bodies, the lower number first; the same twice if the body touches itself.
    pub bodies: [usize; 2],
    /// The shape of the common part.
    pub shape: InterfaceShape,
    /// The sides of the bodies that meet; meaningless at corners.
    pub sides: [usize; 2],
    /// The pairs of nodes, by increasing t.
    pub shared: Vec<SharedNode>,
    /// Nodes of one body on the common face where the other has none, as (t, 0 or 1 for the body that has it, node).
    pub unmatched: Vec<([f64; 2], usize, usize)>,
    /// The bodies in the order of the inequality u_first − u_second ≤ g, as indices into `bodies`: the second lies
    /// above the first.
    pub order: [usize; 2],
    /// The unit normal at each shared node, out of the first of `bodies`.
    pub normals: Vec<[f64; 3]>,
    /// The entry that names the sides: the bodies then need not touch, and no other entry applies. `None`: bodies that
    /// touch.
    pub entry: Option<EntryId>,
    /// The distance of the two nodes along the normal; zero where they coincide.
    pub distances: Vec<f64>,
    /// The lengths that `adjust` adds to the distances at nodes of `shared` that count as touching, by the nodes'
    /// numbers there.
    pub adjusted: BTreeMap<usize, f64>,
    /// The gaps at the nodes in contact.
    pub limits: Limits,
    /// The area that belongs to each of its nodes; `None`: that of their faces.
    pub area: Option<f64>,
    /// Where nodes do not match: `shared` then has the nodes that carry multipliers, each with the nearest node of the
    /// other body. `None`: nodes of `shared` are opposite each other.
    pub mortar: Option<Mortar>,
}

/// Whether more nodes are tied than in contact.
pub(crate) fn mostly_tied(interfaces: &[BodyInterface]) -> bool {
    let links = || interfaces.iter().flat_map(|i| &i.shared).map(|s| s.link);
    let tied = links().filter(|l| *l == Link::Tied).count();
    tied > links().filter(Link::is_contact).count()
}

impl BodyInterface {
    /// Drops what it knows node by node. One bound stays where there are some: it says that there is contact.
    pub(crate) fn forget_nodes(&mut self) {
        (self.shared, self.unmatched) = (Vec::new(), Vec::new());
        (self.normals, self.distances) = (Vec::new(), Vec::new());
        self.adjusted = BTreeMap::new();
        self.limits = Limits::new(self.limits.all().iter().take(1).copied().collect());
    }

    /// Keeps some of its pairs of nodes, before they are joined.
    pub(crate) fn keep(&mut self, meant: impl Fn(&SharedNode) -> bool) {
        let keep: Vec<bool> = self.shared.iter().map(meant).collect();
        let mut all = keep.iter();
        self.shared
            .retain(|_| *all.next().expect("a flag for each"));
        let mut all = keep.iter();
        self.normals
            .retain(|_| *all.next().expect("a flag for each"));
        let mut all = keep.iter();
        self.distances
            .retain(|_| *all.next().expect("a flag for each"));
    }

    /// The nodes that both sides of a body that touches itself have, as at the tip of a crack: they are closed, and
    /// have no row.
    pub(crate) fn common(&self, bodies: &[Body]) -> Vec<usize> {
        let [a, b] = self.bodies;
        if a != b || self.shape == InterfaceShape::Corner {
            return Vec::new();
        }
        let mesh = bodies[a].mesh();
        let other = mesh.side_nodes(self.sides[1]);
        let mut nodes = mesh.side_nodes(self.sides[0]);
        nodes.retain(|node| other.binary_search(node).is_ok());
        nodes
    }

    /// Whether some of its nodes are in contact.
    pub fn has_contact(&self) -> bool {
        !self.limits.all().is_empty()
    }

    /// The unit normal at a shared node, out of the first body of the inequality.
    pub(crate) fn normal_in_order(&self, node: usize) -> [f64; 3] {
        match self.order {
            [0, 1] => self.normals[node],
            _ => self.normals[node].map(|v| 0.0 - v),
        }
    }
}
