//! Sides of cells: tractions, pressures, areas and normals.
//!
//! The nodes of a side are in the order of [`CellKind::sides`]: then normals point out of the cell. A side of a plane
//! cell is a segment in the plane, its area is its length.

use super::map::interpolate_position;
use super::quadrature::Purpose;
use super::table::table;
use crate::kind::CellKind;
use base::linalg::vec3::{cross, norm};

/// Areas and normals of a side, by node; the entries of nodes that the side does not have are zero.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ElementSideWeights {
    /// ∫ N_a. At the corners of sides of second order it is zero ([`CellKind::Triangle6`]) or negative
    /// ([`CellKind::Quad8`]).
    pub area: [f64; 9],
    /// ∫ N_a n with the unit normal n.
    pub normal: [[f64; 3]; 9],
}

/// Nodal areas and area-weighted normals of a side.
///
/// The normals are exact, so that those of a closed surface sum to zero; the areas are where the side is flat.
///
/// # Panics
/// When the side is not of dimension `dim` − 1, or has another number of nodes.
pub fn side_weights(kind: CellKind, dim: usize, points: &[[f64; 3]]) -> ElementSideWeights {
    let mut weights = ElementSideWeights::default();
    for_each_point(kind, dim, points, |values, vector, weight| {
        let area = norm(vector);
        for (a, n) in values.iter().enumerate() {
            weights.area[a] += weight * n * area;
            for i in 0..3 {
                weights.normal[a][i] += weight * n * vector[i];
            }
        }
    });
    weights
}

/// The nodal forces ∫ f_i N_a of a force per area on a side, into `out`, of length nodes · `components`.
///
/// `f` gets the point and the unit outer normal. A traction ignores the normal, a pressure p returns −p n. The total of
/// a constant traction is exact on flat sides, and a constant pressure on a closed surface has total zero.
///
/// # Panics
/// When the side is not of dimension `dim` − 1, or a length is wrong.
pub fn side_load<F>(
    kind: CellKind,
    dim: usize,
    points: &[[f64; 3]],
    components: usize,
    mut f: F,
    out: &mut [f64],
) where
    F: FnMut([f64; 3], [f64; 3]) -> [f64; 3],
{
    let n = points.len() * components;
    assert_eq!(out.len(), n, "a side has {n} degrees of freedom");
    out.fill(0.0);
    for_each_point(kind, dim, points, |values, vector, weight| {
        let area = norm(vector);
        let normal = vector.map(|v| v / area);
        let force =
            f(interpolate_position(points, values), normal).map(|value| value * weight * area);
        for (node, n) in out.chunks_exact_mut(components).zip(values) {
            for (entry, value) in node.iter_mut().zip(force) {
                *entry += value * n;
            }
        }
    });
}

/// Calls `f` with shape functions, area-weighted outer normal n |∂x/∂s| and the rule's weight.
fn for_each_point(
    kind: CellKind,
    dim: usize,
    points: &[[f64; 3]],
    mut f: impl FnMut(&[f64], [f64; 3], f64),
) {
    assert!(
        kind.dim() + 1 == dim && (2..=3).contains(&dim),
        "a {} is no side in dimension {dim}",
        kind.name()
    );
    assert_eq!(points.len(), kind.nodes(), "a {}", kind.name());
    let table = table(kind, Purpose::Load);
    for (q, &weight) in table.weights.iter().enumerate() {
        let tangent = |j: usize| {
            let mut sum = [0.0; 3];
            for (point, slope) in points.iter().zip(table.slopes(q, j)) {
                for i in 0..dim {
                    sum[i] += slope * (point[i] - points[0][i]);
                }
            }
            sum
        };
        let vector = if dim == 2 {
            // To the right of the way along the side.
            let [x, y, _] = tangent(0);
            [y, -x, 0.0]
        } else {
            cross(tangent(0), tangent(1))
        };
        f(table.values(q), vector, weight);
    }
}

#[cfg(test)]
#[path = "../../tests/element/sides.rs"]
mod tests;
