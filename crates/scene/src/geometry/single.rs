//! Nodes that a tie with a tolerance holds one by one, each at the nearest point of a face opposite.
//!
//! Mortar rows say what holds in the mean over faces. Where some nodes of a face are to be tied and others are not, the
//! mean would tie them all: each node that is within the tolerance then has a row of its own, as in CalculiX.

use std::collections::{HashMap, HashSet};

use super::interface::BodyInterface;
use super::mortar::{of_surfaces, surface};
use super::mortar_sides::{BodyRow, Surfaces};
use super::surface::OPPOSITE;
use crate::body::Body;
use crate::model::body::BodySpec;
use base::linalg::vec3::{dot, minus};
use elements::form::Form;
use elements::mortar::{self, Feet};

/// The nodes of the side with the multipliers, as a tolerance divides them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ReachedNodes {
    /// The nodes within the tolerance, with their rows, by increasing node.
    rows: Vec<BodyRow>,
    /// The normals of the faces opposite.
    normals: Vec<[f64; 3]>,
    /// The nodes that lie opposite the other side, but farther away, increasing.
    pub far: Vec<usize>,
    /// Whether some of the nodes that are held belong to no face of the side.
    pub alone: bool,
}

/// Two bodies, and a side of each.
type TwoSides = ([usize; 2], [usize; 2]);

impl ReachedNodes {
    /// The nodes of side `sides[which]` that lie within `tolerance` of the other one, for a tie.
    pub fn new(
        bodies: &[Body],
        form: &Form,
        both: TwoSides,
        which: usize,
        tolerance: f64,
    ) -> ReachedNodes {
        ReachedNodes::find(bodies, form, both, which, (tolerance, false))
    }

    /// The nodes of side `sides[which]` that lie opposite the other one at `reach` at most, for a contact: they face
    /// it, and do not lie behind its body.
    pub fn touching(
        bodies: &[Body],
        form: &Form,
        both: TwoSides,
        which: usize,
        reach: f64,
    ) -> ReachedNodes {
        ReachedNodes::find(bodies, form, both, which, (reach, true))
    }

    fn find(
        bodies: &[Body],
        form: &Form,
        (pair, sides): TwoSides,
        which: usize,
        (tolerance, contact): (f64, bool),
    ) -> ReachedNodes {
        let order = [which, 1 - which];
        let specs = order.map(|k| &bodies[pair[k]].spec);
        let [(own, nodes), (other, theirs)] =
            [0, 1].map(|k| surface(specs[k], sides[order[k]], form.element));
        let feet = Feet::new(&other);
        let far_away = mortar::reach(&own, &other, f64::INFINITY);
        let tolerance = if contact {
            tolerance.min(far_away)
        } else {
            tolerance
        };
        let normals = own.normals();
        let mut areas = areas(&bodies[pair[which]], form, sides[which], &nodes);
        let has_face = |i: usize| normals[i] != [0.0; 3];
        let mut out = ReachedNodes {
            rows: Vec::new(),
            normals: Vec::new(),
            far: Vec::new(),
            alone: false,
        };
        for (i, &node) in nodes.iter().enumerate() {
            let x = own.points()[i];
            let facing = |n: [f64; 3]| !has_face(i) || dot(n, normals[i]) < OPPOSITE;
            let foot = feet.of(x, tolerance, &|n| !contact || facing(n));
            let foot = foot.filter(|foot| {
                !contact || dot(minus(x, foot.point), foot.normal) >= -other.longest()
            });
            if let Some(foot) = foot {
                let list = foot.values.iter();
                let mut list: Vec<(usize, f64)> =
                    list.map(|&(k, v)| (theirs[k as usize], v)).collect();
                list.sort_unstable_by_key(|t| t.0);
                out.alone |= !has_face(i);
                out.normals.push(foot.normal);
                out.rows.push(BodyRow {
                    node,
                    own: vec![(node, 1.0)],
                    other: list,
                    area: areas.remove(&node).unwrap_or(1.0),
                });
            } else if feet.of(x, far_away.max(tolerance), &facing).is_some() {
                out.far.push(node);
            }
        }
        out
    }

    /// Whether no node is within the tolerance.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The nodes within the tolerance.
    pub fn nodes(&self) -> HashSet<usize> {
        self.rows.iter().map(|r| r.node).collect()
    }

    /// The interface in which these nodes carry multipliers; `None` if there are none.
    pub fn interface(
        &self,
        bodies: &[Body],
        form: &Form,
        (pair, sides): TwoSides,
        which: usize,
    ) -> Option<BodyInterface> {
        let order = [which, 1 - which];
        let both = order.map(|k| surface(&bodies[pair[k]].spec, sides[k], form.element));
        let surfaces = Surfaces::single(both, self.rows.clone());
        // Nodes of no face have no normal of their own.
        let out = self.normals.iter().map(|n| n.map(|v| 0.0 - v)).collect();
        of_surfaces(bodies, form, (pair, sides), which, (surfaces, Some(out)))
    }
}

/// Whether a side of a mesh has nodes that belong to none of its faces.
pub(crate) fn has_lonely_nodes(spec: &BodySpec, side: usize) -> bool {
    let mut nodes: HashSet<usize> = spec.mesh.side_nodes(side).into_iter().collect();
    for face in spec.faces(side) {
        for node in &face.nodes {
            nodes.remove(node);
        }
    }
    !nodes.is_empty()
}

/// The area that belongs to each node of a side: that of the faces of the side around it, or of those of the body.
fn areas(body: &Body, form: &Form, side: usize, nodes: &[usize]) -> HashMap<usize, f64> {
    let mut out = HashMap::new();
    let spec = &body.spec;
    let sides = [Some(side), spec.mesh.cells().map(|mesh| mesh.skin())];
    for side in sides.into_iter().flatten() {
        let lacking: HashSet<usize> = nodes
            .iter()
            .copied()
            .filter(|k| !out.contains_key(k))
            .collect();
        for face in spec.faces_around(side, |n| lacking.contains(&n)) {
            let mut of_face = [0.0; 9];
            for (to, area) in of_face.iter_mut().zip(spec.face_areas(side, &face, form)) {
                *to = area;
            }
            if let Some(kind) = face.kind {
                of_face = mortar::positive(kind, of_face);
            }
            for (&node, area) in face.nodes.iter().zip(of_face) {
                if lacking.contains(&node) {
                    *out.entry(node).or_insert(0.0) += area;
                }
            }
        }
    }
    out
}
