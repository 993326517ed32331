//! Sides of bodies: the unit normals at their nodes, and the parameters along them.

use super::curves;
use super::sides::Face;
use crate::model::body::BodySpec;
use base::linalg::vec3::unit;
use elements::cell::Element;
use mesh::{BoxMesh, Mesh};

/// The unit normals at nodes of a side, out of the body. A flat side of a box has its exact normal; on other sides the
/// normals of the elements around the node are averaged, weighted by area. On meshes of cells only the faces count that
/// have all their nodes among these.
pub(crate) fn of_side(body: &BodySpec, side: usize, nodes: &[usize]) -> Vec<[f64; 3]> {
    if body.unbent().is_some() {
        let mut normal = [0.0; 3];
        normal[side / 2] = if side % 2 == 0 { -1.0 } else { 1.0 };
        return nodes.iter().map(|_| normal).collect();
    }
    let of_box = body.mesh.grid().is_some();
    // Mostly few, and many faces are asked about.
    let mut meant = nodes.to_vec();
    meant.sort_unstable();
    let is_meant = |n: &usize| meant.binary_search(n).is_ok();
    let around = body.faces_around(side, |n| is_meant(&n));
    let counts = |face: &&Face| of_box || face.nodes.iter().all(is_meant);
    // Q1 is used for P1 too, as the triangles of P1 elements would turn the normals towards their diagonals.
    let mut sums = body.side_normals(side, Element::Q1, around.iter().filter(counts));
    if nodes.iter().any(|n| !sums.contains_key(n)) {
        // Nodes that form no whole face: the faces around them.
        let more = body.side_normals(side, Element::Q1, around.iter());
        for (node, sum) in more {
            sums.entry(node).or_insert(sum);
        }
    }
    let normal = |n: &usize| unit(*sums.get(n)?);
    let normals = nodes.iter().map(normal);
    normals.map(Option::unwrap_or_default).collect()
}

/// Parameters of nodes along a side, 0 ≤ t ≤ 1: one in the plane (the other is 0), two on the sides of solids.
pub(crate) fn parameters(body: &BodySpec, side: usize, nodes: &[usize]) -> Vec<[f64; 2]> {
    match &body.mesh {
        Mesh::Grid(grid) => nodes.iter().map(|&node| on_box(grid, side, node)).collect(),
        Mesh::Cells(mesh) => curves::parameters(mesh, side, nodes),
    }
}

fn on_box(grid: &BoxMesh, side: usize, node: usize) -> [f64; 2] {
    let (elements, place) = (grid.elements, grid.place(node));
    let mut along = (0..3).filter(|&d| d != side / 2 && elements[d] > 0);
    [along.next(), along.next()].map(|d| d.map_or(0.0, |d| place[d] as f64 / elements[d] as f64))
}
