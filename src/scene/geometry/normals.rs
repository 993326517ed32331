//! Sides of bodies: the unit normals at their nodes, and the parameters along them.

use crate::fem::cell::Element;
use crate::linalg::vec3::norm;
use crate::scene::model::spec::BodySpec;

/// The unit normals at nodes of a side, out of the body. A flat side has its exact normal; on other sides the normals
/// of the elements around the node are averaged, weighted by area.
pub(crate) fn of_side(
    body: &BodySpec,
    side: usize,
    nodes: impl Iterator<Item = usize>,
) -> Vec<[f64; 3]> {
    if body.map.is_none() {
        let mut normal = [0.0; 3];
        normal[side / 2] = if side % 2 == 0 { -1.0 } else { 1.0 };
        return nodes.map(|_| normal).collect();
    }
    // Q1 is used for P1 too, as the triangles of P1 elements would turn the normals towards their diagonals.
    let sums = body.side_normals(side, Element::Q1);
    let unit = |sum: [f64; 3]| {
        let length = norm(sum);
        sum.map(|v| v / length)
    };
    nodes.map(|node| unit(sums[&node])).collect()
}

/// Parameters of a node along its side.
pub(crate) fn parameters(body: &BodySpec, side: usize, place: [usize; 3]) -> [f64; 2] {
    let elements = body.mesh.elements;
    let mut along = (0..3).filter(|&d| d != side / 2 && elements[d] > 0);
    [along.next(), along.next()].map(|d| d.map_or(0.0, |d| place[d] as f64 / elements[d] as f64))
}
