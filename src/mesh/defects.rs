//! What makes a mesh of cells unfit: nodes that are there twice, and nodes that hang on the side of a cell.

use std::collections::HashSet;

use super::cell_mesh::CellMesh;
use super::point_grid::PointGrid;
use crate::linalg::vec3::{cross, dot, minus, norm};

/// Two nodes of a body are one if their distance is at most this fraction of the body's size.
const SAME: f64 = 1e-9;

/// A node lies on a side if its distance is at most this fraction of the side's length.
const ON: f64 = 1e-6;

/// A node lies on a curved edge if its distance is at most this fraction of the height of the edge's arc. Where two
/// edges replace one, their nodes are on the true curve. A parabola differs from an arc of 60 degrees by 0.017 of its
/// height.
const ON_ARC: f64 = 0.02;

/// The first defect of a mesh, as the end of a sentence about its body. Equations join the nodes `joined` to others:
/// they may be there twice, and hang.
pub fn defect(mesh: &CellMesh, joined: &HashSet<u32>) -> Option<String> {
    doubled(mesh, joined).or_else(|| hanging(mesh, joined))
}

/// Two nodes at one place: the mesh is torn there.
fn doubled(mesh: &CellMesh, joined: &HashSet<u32>) -> Option<String> {
    let range = |d: usize| {
        let of = mesh.points.iter().map(|p| p[d]);
        let low = of.clone().fold(f64::INFINITY, f64::min);
        of.fold(f64::NEG_INFINITY, f64::max) - low
    };
    let near = SAME * (0..3).map(range).fold(0.0, f64::max);
    // Cells much wider than the distance: most searches look into one of them.
    let grid = PointGrid::new(mesh.points.iter().copied().enumerate(), 1e4 * near);
    for (k, point) in mesh.points.iter().enumerate() {
        let apart = |l: usize| ![l, k].iter().all(|&n| joined.contains(&(n as u32)));
        let same = |&l: &usize| l < k && norm(minus(mesh.points[l], *point)) <= near && apart(l);
        if let Some(other) = grid.around(*point, near).find(same) {
            return Some(format!(
                "nodes {} and {} are both at {point:?} (one node was expected where cells of a body meet)",
                mesh.node_ids[other], mesh.node_ids[k]
            ));
        }
    }
    None
}

/// A node on the side of a cell that does not have it.
fn hanging(mesh: &CellMesh, joined: &HashSet<u32>) -> Option<String> {
    let skin = &mesh.sides[mesh.skin()];
    let outline = |&(cell, side): &(u32, u8)| {
        let (cell, side) = (cell as usize, usize::from(side));
        let n = mesh.cells.kind(cell).sides()[side].kind.corners();
        let nodes: Vec<u32> = mesh.cells.side_nodes(cell, side).collect();
        let corners: Vec<[f64; 3]> = nodes[..n]
            .iter()
            .map(|&k| mesh.points[k as usize])
            .collect();
        (nodes, corners)
    };
    let length = |corners: &[[f64; 3]]| norm(minus(corners[1], corners[0]));
    let mean = skin
        .faces
        .iter()
        .map(|face| length(&outline(face).1))
        .sum::<f64>()
        / skin.faces.len() as f64;
    let nodes = skin.nodes.iter();
    let grid = PointGrid::new(nodes.map(|&k| (k as usize, mesh.points[k as usize])), mean);
    for face in &skin.faces {
        let (nodes, corners) = outline(face);
        let near = ON * length(&corners);
        let straight = is_straight(mesh, &nodes, &corners, near);
        // Curved faces of solids are not looked at.
        if !straight && corners.len() > 2 {
            continue;
        }
        // A curved edge reaches beyond its corners by less than its length.
        let slack = if straight { near } else { length(&corners) };
        let bound = |f: fn(f64, f64) -> f64, d: usize| {
            corners.iter().map(|c| c[d]).reduce(f).unwrap_or_default()
        };
        let low = [0, 1, 2].map(|d| bound(f64::min, d) - slack);
        let high = [0, 1, 2].map(|d| bound(f64::max, d) + slack);
        let hangs = |&k: &usize| {
            let (node, x) = (k as u32, mesh.points[k]);
            !nodes.contains(&node)
                && !joined.contains(&node)
                && match straight {
                    true => on(&corners, x, near),
                    false => on_arc(&corners, mesh.points[nodes[2] as usize], x, near),
                }
        };
        if let Some(k) = grid.within(low, high).find(hangs) {
            return Some(format!(
                "node {} at {:?} hangs on a side of cell {}, which does not have it (neighbours with common nodes \
                 were expected)",
                mesh.node_ids[k], mesh.points[k], mesh.cell_ids[face.0 as usize]
            ));
        }
    }
    None
}

/// Whether the middle nodes of a side are in the middle of its edges: the corners say little of a curved side.
fn is_straight(mesh: &CellMesh, nodes: &[u32], corners: &[[f64; 3]], near: f64) -> bool {
    let n = corners.len();
    let edges = if n == 2 { 1 } else { n };
    let middle = |k: usize| {
        let (a, b) = (corners[k], corners[(k + 1) % n]);
        [0, 1, 2].map(|d| 0.5 * (a[d] + b[d]))
    };
    let at = |k: usize| nodes.get(n + k).map(|&node| mesh.points[node as usize]);
    (0..edges).all(|k| at(k).is_none_or(|x| norm(minus(x, middle(k))) <= near))
}

/// Whether a point is on a curved edge with the middle node m, away from its nodes.
fn on_arc(ends: &[[f64; 3]], m: [f64; 3], x: [f64; 3], near: f64) -> bool {
    let (a, b) = (ends[0], ends[1]);
    // p(t) = (1 - t²) m + ½ t (t - 1) a + ½ t (t + 1) b with -1 ≤ t ≤ 1.
    let bend = [0, 1, 2].map(|d| 0.5 * (a[d] + b[d]) - m[d]);
    let chord = [0, 1, 2].map(|d| 0.5 * (b[d] - a[d]));
    let away = |t: f64| [0, 1, 2].map(|d| m[d] + t * (chord[d] + t * bend[d]) - x[d]);
    // The nearest point: Newton's method for the smallest of the distances at a few points.
    let samples = (-8..=8).map(|k| f64::from(k) / 8.0);
    let Some(mut t) = samples.min_by(|s, t| norm(away(*s)).total_cmp(&norm(away(*t)))) else {
        return false;
    };
    for _ in 0..8 {
        let (p, slope) = (away(t), [0, 1, 2].map(|d| chord[d] + 2.0 * t * bend[d]));
        let curvature = dot(slope, slope) + 2.0 * dot(p, bend);
        if curvature > 0.0 {
            t = (t - dot(p, slope) / curvature).clamp(-1.0, 1.0);
        }
    }
    let reach = near.max(ON_ARC * norm(bend));
    let nodes = [a, b, m];
    norm(away(t)) <= reach && nodes.iter().all(|node| norm(minus(*node, x)) > 2.0 * reach)
}

/// Whether a point is on a segment, or on a triangle or quadrilateral (of two triangles), away from its corners.
fn on(corners: &[[f64; 3]], x: [f64; 3], near: f64) -> bool {
    if corners.iter().any(|c| norm(minus(*c, x)) <= near) {
        return false;
    }
    let segment = |a: [f64; 3], b: [f64; 3]| {
        let (edge, from) = (minus(b, a), minus(x, a));
        let t = dot(edge, from) / dot(edge, edge);
        (0.0..=1.0).contains(&t) && norm(minus(from, edge.map(|v| t * v))) <= near
    };
    let triangle = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
        let normal = cross(minus(b, a), minus(c, a));
        let area = norm(normal);
        if area == 0.0 || dot(minus(x, a), normal).abs() > near * area {
            return false;
        }
        let part = |p: [f64; 3], q: [f64; 3]| dot(cross(minus(p, x), minus(q, x)), normal);
        let least = -1e-9 * area * area;
        part(a, b) >= least && part(b, c) >= least && part(c, a) >= least
    };
    match *corners {
        [a, b] => segment(a, b),
        [a, b, c] => triangle(a, b, c),
        [a, b, c, d] => triangle(a, b, c) || triangle(a, c, d),
        _ => false,
    }
}
