//! Node pairs on sides of bodies of any shape: sides that coincide, and sides that face each other.

use super::interface::{BodyInterface, InterfaceShape, Link, SharedNode, TOLERANCE};
use super::normals::{of_side, parameters};
use crate::body::Body;
use crate::model::body::BodySpec;
use crate::model::profile::Limits;
use base::linalg::vec3::{dot, minus, norm};
use mesh::{BoxMesh, Mesh, PointGrid};
use std::collections::HashSet;

/// The interfaces of two bodies with different maps: the coinciding nodes, by pairs of sides. A single common node is a
/// corner. `edge` has the shortest edge of a body's surface.
pub(crate) fn coinciding(
    bodies: &[Body],
    pair: [usize; 2],
    edge: &mut impl FnMut(usize) -> f64,
) -> Vec<BodyInterface> {
    let [a, b] = pair.map(|k| &bodies[k]);
    let apart = (0..3).any(|d| {
        let slack = 1e-6 * (a.bounds[1][d] - a.bounds[0][d]).abs();
        a.bounds[0][d] > b.bounds[1][d] + slack || b.bounds[0][d] > a.bounds[1][d] + slack
    });
    if apart {
        return Vec::new();
    }
    let (of_a, of_b) = (sides_inside(a, b), sides_inside(b, a));
    if of_a.is_empty() || of_b.is_empty() {
        return Vec::new();
    }
    let near = TOLERANCE * edge(pair[0]).min(edge(pair[1]));
    let mut found = Vec::new();
    let mut seen = HashSet::new();
    for (sb, of_b) in &of_b {
        let sb = *sb;
        let grid = PointGrid::new(of_b.iter().map(|p| p.1).enumerate(), 4.0 * near);
        let twin = |x: [f64; 3]| {
            let close = |(_, y): &&LocatedNode| (0..3).all(|d| (x[d] - y[d]).abs() <= near);
            let mut around = grid.around(x, near).map(|k| &of_b[k]);
            around.find(close).map(|p| p.0)
        };
        for (sa, of_a) in &of_a {
            let sa = *sa;
            let pair = |&(node, x): &LocatedNode| Some([node, twin(x)?]);
            let nodes = of_a.iter().filter_map(pair);
            let shared = share(&a.spec, sa, nodes.collect());
            let shape = if is_face([a, b], [sa, sb], &shared) {
                InterfaceShape::Face
            } else {
                InterfaceShape::Corner
            };
            if shape == InterfaceShape::Face {
                seen.extend(shared.iter().map(|s| s.nodes));
            }
            found.push(([sa, sb], shape, shared));
        }
    }
    // Removes nodes of corners and edges that a face, or another corner, already has.
    for (_, _, shared) in found.iter_mut().filter(|f| f.1 == InterfaceShape::Corner) {
        shared.retain(|s| seen.insert(s.nodes));
    }
    let found = found
        .into_iter()
        .filter(|(_, _, shared)| !shared.is_empty());
    found
        .map(|(sides, shape, shared)| interface(bodies, pair, sides, shape, shared))
        .collect()
}

/// A node, and where it is.
type LocatedNode = (usize, [f64; 3]);

/// The outer sides of a body that have nodes in the bounds of another one, with these nodes.
fn sides_inside(body: &Body, other: &Body) -> Vec<(usize, Vec<LocatedNode>)> {
    let [low, high] = other.bounds;
    let size = |b: &Body| norm(minus(b.bounds[1], b.bounds[0]));
    // Nodes coincide that are a fraction of an edge apart.
    let slack = 2.0 * TOLERANCE * size(body).min(size(other));
    let is_inside =
        |(_, x): &LocatedNode| (0..3).all(|d| x[d] >= low[d] - slack && x[d] <= high[d] + slack);
    let inside = |side: usize| {
        let nodes = body.mesh().side_nodes(side).into_iter();
        let placed = nodes.map(|k| (k, body.spec.position(k)));
        let inside: Vec<_> = placed.filter(is_inside).collect();
        (!inside.is_empty()).then_some((side, inside))
    };
    body.mesh().outer_sides().filter_map(inside).collect()
}

/// Pairs of nodes on side `side` of the first body, with their parameters there.
pub(crate) fn share(first: &BodySpec, side: usize, pairs: Vec<[usize; 2]>) -> Vec<SharedNode> {
    let nodes: Vec<usize> = pairs.iter().map(|p| p[0]).collect();
    let t = parameters(first, side, &nodes);
    let shared = pairs.into_iter().zip(t).map(|(nodes, t)| SharedNode {
        nodes,
        t,
        link: Link::Free,
    });
    shared.collect()
}

/// Whether the nodes form a face: on boxes if every parameter varies, on meshes of cells if a face of a cell has all
/// its nodes among them.
pub(crate) fn is_face(bodies: [&Body; 2], sides: [usize; 2], shared: &[SharedNode]) -> bool {
    for k in [0, 1] {
        if bodies[k].mesh().cells().is_some() {
            let nodes: HashSet<usize> = shared.iter().map(|s| s.nodes[k]).collect();
            let mut faces = bodies[k].spec.faces(sides[k]);
            return faces.any(|f| f.nodes.iter().all(|n| nodes.contains(n)));
        }
    }
    let varies = |k: usize| shared.iter().any(|s| s.t[k] != shared[0].t[k]);
    (0..bodies[0].mesh().dim() - 1).all(varies)
}

/// Sides of two boxes that face each other, node opposite node; `None` where their nodes cannot be paired.
pub(crate) fn opposite(
    bodies: &[Body],
    meshes: [&BoxMesh; 2],
    pair: [usize; 2],
    sides: [usize; 2],
) -> Option<BodyInterface> {
    let [a, b] = pair.map(|k| &bodies[k]);
    let lists = [(a, sides[0]), (b, sides[1])].map(|(body, side)| body.mesh().side_nodes(side));
    let counts = [(meshes[0], sides[0]), (meshes[1], sides[1])].map(|(mesh, side)| {
        let n = mesh.nodes();
        let mut along = (0..3).filter(|&d| d != side / 2);
        [along.next(), along.next()].map(|d| d.map_or(1, |d| n[d]))
    });
    if counts[0] != counts[1] {
        return None;
    }
    let [m, n] = counts[0];
    let position = |k: usize, i: usize| [a, b][k].spec.position(lists[k][i]);
    let partner = |i: usize, flip: usize| {
        let (p, q) = (i % m, i / m);
        let p = if flip & 1 == 1 { m - 1 - p } else { p };
        let q = if flip & 2 == 2 { n - 1 - q } else { q };
        q * m + p
    };
    let total = |flip: usize| -> f64 {
        let square = |i: usize| {
            let (x, y) = (position(0, i), position(1, partner(i, flip)));
            let away = minus(x, y);
            dot(away, away)
        };
        (0..m * n).map(square).sum()
    };
    let flip = (0..4).min_by(|&x, &y| total(x).total_cmp(&total(y)))?;
    let pairs = (0..m * n).map(|i| [lists[0][i], lists[1][partner(i, flip)]]);
    // Two sides of one body may have common nodes: these have nothing opposite.
    let pairs = pairs.filter(|nodes| pair[0] != pair[1] || nodes[0] != nodes[1]);
    let shared = share(&a.spec, sides[0], pairs.collect());
    Some(interface(bodies, pair, sides, InterfaceShape::Face, shared))
}

/// The interface of given nodes, with the mean of both bodies' normals and the distance along it.
pub(crate) fn interface(
    bodies: &[Body],
    pair: [usize; 2],
    sides: [usize; 2],
    shape: InterfaceShape,
    shared: Vec<SharedNode>,
) -> BodyInterface {
    let [first, second] = [0, 1].map(|k| {
        let nodes: Vec<usize> = shared.iter().map(|s| s.nodes[k]).collect();
        of_side(&bodies[pair[k]].spec, sides[k], &nodes)
    });
    let normals: Vec<[f64; 3]> = first
        .iter()
        .zip(&second)
        .map(|(n, m)| {
            let sum = minus(*n, *m);
            let length = norm(sum);
            // Sides that do not face each other have no common normal; the first body's normal is used.
            if length > 1e-3 {
                sum.map(|v| v / length)
            } else {
                *n
            }
        })
        .collect();
    let distances = shared
        .iter()
        .zip(&normals)
        .map(|(s, n)| {
            // Rows are about displacements from the undeformed bodies.
            let [x, y] = [0, 1].map(|k| bodies[pair[k]].spec.undeformed(s.nodes[k]));
            let distance = dot(minus(y, x), *n);
            let size = x.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
            if distance.abs() <= 1e-14 * size {
                0.0
            } else {
                distance
            }
        })
        .collect();
    BodyInterface {
        bodies: pair,
        shape,
        sides,
        shared,
        unmatched: Vec::new(),
        order: [0, 1],
        normals,
        entry: None,
        distances,
        limits: Limits::default(),
        adjusted: Default::default(),
        area: None,
        mortar: None,
    }
}

/// Length of the shortest edge between nodes of a side.
pub(crate) fn shortest(body: &BodySpec) -> f64 {
    let length = |a: usize, b: usize| norm(minus(body.position(a), body.position(b)));
    let mut out = f64::INFINITY;
    match &body.mesh {
        Mesh::Grid(grid) => {
            for place in grid.boundary() {
                for d in (0..grid.dim()).filter(|&d| place[d] > 0) {
                    let mut before = place;
                    before[d] -= 1;
                    out = out.min(length(grid.node(place), grid.node(before)));
                }
            }
        }
        Mesh::Cells(mesh) => {
            for face in body.faces(mesh.skin()) {
                let corners = face.outline();
                for (k, &a) in corners.iter().enumerate() {
                    out = out.min(match corners[(k + 1) % corners.len()] {
                        b if a == b => f64::INFINITY,
                        b => length(a, b),
                    });
                }
            }
        }
    }
    out
}
