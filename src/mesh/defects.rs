//! What makes a mesh of cells unfit: nodes that are there twice, and nodes that hang on the side of a cell.

use super::cell_mesh::CellMesh;
use super::point_grid::PointGrid;
use crate::linalg::vec3::{cross, dot, minus, norm};

/// Two nodes of a body are one if their distance is at most this fraction of the body's size.
const SAME: f64 = 1e-9;

/// A node lies on a side if its distance is at most this fraction of the side's length.
const ON: f64 = 1e-6;

/// The first defect of a mesh, as the end of a sentence about its body.
pub fn defect(mesh: &CellMesh) -> Option<String> {
    doubled(mesh).or_else(|| hanging(mesh))
}

/// Two nodes at one place: the mesh is torn there.
fn doubled(mesh: &CellMesh) -> Option<String> {
    let range = |d: usize| {
        let of = mesh.points.iter().map(|p| p[d]);
        let low = of.clone().fold(f64::INFINITY, f64::min);
        of.fold(f64::NEG_INFINITY, f64::max) - low
    };
    let near = SAME * (0..3).map(range).fold(0.0, f64::max);
    // Cells much wider than the distance: most searches look into one of them.
    let grid = PointGrid::new(mesh.points.iter().copied().enumerate(), 1e4 * near);
    for (k, point) in mesh.points.iter().enumerate() {
        let same = |&l: &usize| l < k && norm(minus(mesh.points[l], *point)) <= near;
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
fn hanging(mesh: &CellMesh) -> Option<String> {
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
        if !is_straight(mesh, &nodes, &corners, near) {
            continue;
        }
        let bound = |f: fn(f64, f64) -> f64, d: usize| {
            corners.iter().map(|c| c[d]).reduce(f).unwrap_or_default()
        };
        let low = [0, 1, 2].map(|d| bound(f64::min, d) - near);
        let high = [0, 1, 2].map(|d| bound(f64::max, d) + near);
        let hangs = |&k: &usize| !nodes.contains(&(k as u32)) && on(&corners, mesh.points[k], near);
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
