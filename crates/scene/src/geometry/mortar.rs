//! Sides whose nodes do not match: one of them carries the multipliers, and mortar integrals join it to the other.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use super::interface::{BodyInterface, InterfaceShape};
use super::mortar_sides::{Mortar, Surfaces};
use super::nearest::Nearest;
use super::normals::of_side;
use super::sides::Face as BodyFace;
use crate::body::Body;
use crate::geometry::facing::share;
use crate::model::body::BodySpec;
use crate::model::profile::Limits;
use base::linalg::vec3::dot;
use elements::cell::Element;
use elements::form::Form;
use elements::kind::CellKind;
use elements::mortar::{self, MortarFace, MortarSide};

/// The interface of two sides whose nodes do not match; body number `multipliers` of the pair (0 or 1) carries the
/// multipliers. The sides may be `reach` apart, or, where that is infinite, a few edges. `None` if they do not face
/// each other.
pub(crate) fn interface(
    bodies: &[Body],
    form: &Form,
    pair: [usize; 2],
    sides: [usize; 2],
    multipliers: usize,
    reach: f64,
) -> Option<BodyInterface> {
    let order = [multipliers, 1 - multipliers];
    let specs = order.map(|k| &bodies[pair[k]].spec);
    let [own, other] = [0, 1].map(|k| surface(specs[k], sides[order[k]], form.element));
    let reach = mortar::reach(&own.0, &other.0, reach);
    let surfaces = match Surfaces::new([own, other], reach) {
        surfaces if pair[0] == pair[1] => surfaces.of_one_body(),
        surfaces => surfaces,
    };
    of_surfaces(bodies, form, (pair, sides), multipliers, (surfaces, None))
}

/// The interface of two sides, the first of which carries the multipliers; `None` if they do not face each other. The
/// normals at the nodes with multipliers, out of their body, are those of the side if none are given.
pub(super) fn of_surfaces(
    bodies: &[Body],
    form: &Form,
    (pair, sides): ([usize; 2], [usize; 2]),
    multipliers: usize,
    (surfaces, out): (Surfaces, Option<Vec<[f64; 3]>>),
) -> Option<BodyInterface> {
    let order = [multipliers, 1 - multipliers];
    let specs = order.map(|k| &bodies[pair[k]].spec);
    let rows = surfaces.rows(form, &|_| false);
    if rows.is_empty() {
        return None;
    }
    // For reports every node has a partner, the nearest one.
    let places: Vec<[f64; 3]> = surfaces.nodes[1]
        .iter()
        .map(|&k| specs[1].position(k))
        .collect();
    let nearest = Nearest::new(&places);
    let partner = |node: usize| {
        let found = nearest.find(specs[0].position(node));
        surfaces.nodes[1][found.expect("a side has nodes")]
    };
    let nodes: Vec<usize> = rows.iter().map(|r| r.node).collect();
    let out = out.unwrap_or_else(|| of_side(specs[0], sides[multipliers], &nodes));
    let distances = rows.iter().zip(&out);
    let distances = distances
        .map(|(row, n)| row.distance(specs[0], &|k| specs[1].undeformed(k), *n))
        .collect();
    let pairs = nodes.iter().map(|&node| [node, partner(node)]).collect();
    let mut shared = share(specs[0], sides[multipliers], pairs);
    if multipliers == 1 {
        shared.iter_mut().for_each(|s| s.nodes.reverse());
    }
    let sign = if multipliers == 0 { 1.0 } else { -1.0 };
    Some(BodyInterface {
        bodies: pair,
        shape: InterfaceShape::Face,
        sides,
        shared,
        unmatched: Vec::new(),
        order: [0, 1],
        normals: out.into_iter().map(|n| n.map(|v| sign * v + 0.0)).collect(),
        entry: None,
        distances,
        limits: Limits::default(),
        adjusted: Default::default(),
        area: None,
        mortar: Some(Mortar {
            multipliers,
            area: rows.iter().map(|r| r.area).sum(),
            surfaces: Some(Box::new(surfaces)),
        }),
    })
}

/// Whether contact between sides whose nodes match takes mortar rows all the same.
pub(crate) fn is_for_contact(bodies: &[Body], interface: &BodyInterface) -> bool {
    interface.shape == InterfaceShape::Face
        && [0, 1].into_iter().any(|k| {
            let nodes = interface.shared.iter().map(|s| s.nodes[k]);
            lacks_signs(&bodies[interface.bodies[k]], interface.sides[k], nodes)
        })
}

/// Whether forces at nodes of a side say nothing of the sign of pressures: on triangles of 6 and quadrilaterals of 8
/// nodes functions of corners have integrals that are not positive. Faces count that have all their nodes among these.
pub(crate) fn lacks_signs(body: &Body, side: usize, nodes: impl Iterator<Item = usize>) -> bool {
    if body.components == 1 {
        return false;
    }
    let signs = |face: &BodyFace| face.kind.is_none_or(mortar::has_positive_integrals);
    let mut without = body.spec.faces(side).filter(|f| !signs(f)).peekable();
    if without.peek().is_none() {
        return false;
    }
    let meant: HashSet<usize> = nodes.collect();
    without.any(|face| face.nodes.iter().all(|n| meant.contains(n)))
}

/// A side of a body with its faces as the elements see them, and the node of the body for each of its nodes.
pub(crate) fn surface(
    spec: &BodySpec,
    side: usize,
    element: Element,
) -> (Arc<MortarSide>, Vec<usize>) {
    let nodes = spec.mesh.side_nodes(side);
    let place: HashMap<usize, u32> = nodes.iter().copied().zip(0..).collect();
    let points = nodes.iter().map(|&k| spec.position(k)).collect();
    let faces = spec.faces(side).flat_map(|face| {
        let pieces = oriented(spec, side, &face, element).into_iter();
        pieces.map(|(kind, list)| MortarFace {
            kind,
            nodes: list.iter().map(|k| place[k]).collect(),
        })
    });
    let faces = faces.collect();
    (
        Arc::new(MortarSide::new(spec.mesh.dim(), points, faces)),
        nodes,
    )
}

/// The faces of elements that a face consists of: their kinds and their nodes, in the order in which the normal points
/// out of the body.
fn oriented(
    spec: &BodySpec,
    side: usize,
    face: &BodyFace,
    element: Element,
) -> Vec<(CellKind, Vec<usize>)> {
    if let Some(kind) = face.kind {
        return vec![(kind, face.nodes.to_vec())];
    }
    let weights = spec.face_weights(side, face, Element::Q1);
    let outward = weights
        .iter()
        .fold([0.0; 3], |s, w| [0, 1, 2].map(|d| s[d] + w.1[d]));
    let outline = face.outline();
    let pieces = match (&outline[..], element) {
        // The tetrahedra of a box walk from its first to its last corner, and cut its faces along that diagonal.
        (&[a, b, c, d], Element::P1) => vec![vec![a, b, c], vec![a, c, d]],
        _ => vec![outline],
    };
    let upright = |mut nodes: Vec<usize>| {
        let x: Vec<[f64; 3]> = nodes.iter().map(|&k| spec.position(k)).collect();
        if dot(mortar::across(&x), outward) < 0.0 {
            nodes.reverse();
        }
        let kind = match nodes.len() {
            2 => CellKind::Line2,
            3 => CellKind::Triangle3,
            _ => CellKind::Quad4,
        };
        (kind, nodes)
    };
    pieces.into_iter().map(upright).collect()
}
