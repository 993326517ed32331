//! Where bodies touch: common faces and corners, and the nodes at which both have one.

use super::profile::Limits;
use super::Body;
use crate::error::{Error, Result};
use crate::mesh::BoxMesh;

/// Relative to the smaller element, how far two positions may lie apart and still be the same.
pub(super) const TOLERANCE: f64 = 1e-6;

/// How two coinciding nodes are joined.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Link {
    /// Not at all.
    Free,
    /// Not now, but the nodes belong to a face on which bodies may be joined: candidate contact nodes.
    Open,
    /// u is continuous.
    Tied,
    /// u_first − u_second ≤ gap.
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

/// What two bodies have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// A stretch of their sides, along x (0) or y (1).
    Face {
        /// The direction of the face.
        along: usize,
    },
    /// One corner point.
    Corner,
}

/// Nodes of two bodies at the same position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SharedNode {
    /// The node in the first and in the second body.
    pub nodes: [usize; 2],
    /// Parameter along the common face, 0 ≤ t ≤ 1; 0 at a corner.
    pub t: f64,
    /// How they are joined.
    pub link: Link,
}

/// Two bodies that touch.
#[derive(Debug, Clone, PartialEq)]
pub struct Interface {
    /// The bodies, the lower number first.
    pub bodies: [usize; 2],
    /// What they have in common.
    pub shape: Shape,
    /// The nodes at which both have one, by increasing t.
    pub shared: Vec<SharedNode>,
    /// Nodes of one body on the common face where the other has none, as (t, 0 or 1 for the body that has it, node).
    pub unmatched: Vec<(f64, usize, usize)>,
    /// Which of `bodies` is the first and which the second in u_first − u_second ≤ g: the second lies above the first.
    pub order: [usize; 2],
    /// The gaps at the nodes in contact.
    pub limits: Limits,
}

impl Interface {
    /// Whether some of its nodes are in contact.
    pub fn has_contact(&self) -> bool {
        !self.limits.all().is_empty()
    }
}

/// Pairs that touch, in order of their numbers, found by a sweep in x.
pub(super) fn touching(bodies: &[Body]) -> Result<Vec<Interface>> {
    let mut order: Vec<usize> = (0..bodies.len()).collect();
    let left = |b: usize| bodies[b].mesh().origin[0];
    order.sort_by(|&a, &b| left(a).total_cmp(&left(b)).then(a.cmp(&b)));
    let mut out = Vec::new();
    for (k, &a) in order.iter().enumerate() {
        let mesh = bodies[a].mesh();
        let reach = mesh.end()[0] + TOLERANCE * mesh.step()[0];
        for &b in &order[k + 1..] {
            if left(b) > reach {
                break;
            }
            if let Some(interface) = common(bodies, a.min(b), a.max(b))? {
                out.push(interface);
            }
        }
    }
    out.sort_by_key(|i| i.bodies);
    Ok(out)
}

/// What bodies `a` and `b` have in common.
fn common(bodies: &[Body], a: usize, b: usize) -> Result<Option<Interface>> {
    let meshes = [bodies[a].mesh(), bodies[b].mesh()];
    let (mut low, mut high, mut state) = ([0.0; 2], [0.0; 2], [0; 2]);
    for d in 0..2 {
        low[d] = meshes[0].origin[d].max(meshes[1].origin[d]);
        high[d] = meshes[0].end()[d].min(meshes[1].end()[d]);
        let tolerance = TOLERANCE * meshes[0].step()[d].min(meshes[1].step()[d]);
        let length = high[d] - low[d];
        // 1: a stretch in common, 0: a point, −1: apart.
        state[d] = i32::from(length > tolerance) - i32::from(length < -tolerance);
    }
    let (shape, along) = match state {
        [1, 1] => {
            return Err(Error::Input(format!(
                "{}bodies `{}` and `{}` overlap in [{}, {}] × [{}, {}] (bodies may only touch)",
                bodies[b].spec.written,
                bodies[a].spec.name,
                bodies[b].spec.name,
                low[0],
                high[0],
                low[1],
                high[1]
            )))
        }
        [1, 0] => (Shape::Face { along: 0 }, 0),
        [0, 1] => (Shape::Face { along: 1 }, 1),
        [0, 0] => (Shape::Corner, 0),
        _ => return Ok(None),
    };
    let mut interface = Interface {
        bodies: [a, b],
        shape,
        shared: Vec::new(),
        unmatched: Vec::new(),
        order: [0, 1],
        limits: Limits::default(),
    };
    // The first body lies below (or left of) the second exactly when its end is where they meet.
    let first_before = |d: usize| meshes[0].origin[d] < meshes[1].origin[d];
    let line = |body: usize, d: usize| {
        if (body == 0) == first_before(d) {
            meshes[body].elements[d]
        } else {
            0
        }
    };
    if shape == Shape::Corner {
        let nodes = [0, 1].map(|k| meshes[k].node([line(k, 0), line(k, 1)]));
        interface.shared.push(SharedNode {
            nodes,
            t: 0.0,
            link: Link::Free,
        });
        return Ok(Some(interface));
    }
    let (low, high) = (low[along], high[along]);
    let across = 1 - along;
    let nodes = [0, 1].map(|k| {
        let place = |i: usize| {
            let mut place = [0; 2];
            place[along] = i;
            place[across] = line(k, across);
            place
        };
        stretch(meshes[k], along, low, high)
            .map(|i| {
                (
                    meshes[k].position(place(i))[along],
                    meshes[k].node(place(i)),
                )
            })
            .collect::<Vec<_>>()
    });
    let near = TOLERANCE * meshes[0].step()[along].min(meshes[1].step()[along]);
    let t = |position: f64| ((position - low) / (high - low)).clamp(0.0, 1.0);
    let (mut i, mut j) = (0, 0);
    loop {
        let first_alone = match (nodes[0].get(i), nodes[1].get(j)) {
            (None, None) => break,
            (Some(p), Some(q)) if (p.0 - q.0).abs() <= near => {
                interface.shared.push(SharedNode {
                    nodes: [p.1, q.1],
                    t: t(p.0),
                    link: Link::Free,
                });
                i += 1;
                j += 1;
                continue;
            }
            (Some(p), Some(q)) => p.0 < q.0,
            (first, _) => first.is_some(),
        };
        if first_alone {
            let (position, node) = nodes[0][i];
            interface.unmatched.push((t(position), 0, node));
            i += 1;
        } else {
            let (position, node) = nodes[1][j];
            interface.unmatched.push((t(position), 1, node));
            j += 1;
        }
    }
    Ok(Some(interface))
}

/// The node columns (or rows) between `low` and `high`.
fn stretch(mesh: &BoxMesh, d: usize, low: f64, high: f64) -> std::ops::RangeInclusive<usize> {
    let place = |v: f64| (v - mesh.origin[d]) / mesh.step()[d];
    let first = (place(low) - TOLERANCE).ceil().max(0.0) as usize;
    let last = (place(high) + TOLERANCE).floor().max(0.0) as usize;
    first..=last.min(mesh.elements[d])
}
