//! Forces in a cell, its volume and a point inside.

use super::integration::Integration;
use super::map::{by_kind, interpolate_position, jacobian, relative, slopes};
use super::quadrature::Purpose;
use super::table::{table, ShapeTable};
use crate::kind::CellKind;
use base::linalg::small::invert;

/// The nodal forces ∫ f_i N_a of a force per volume `f`, into `out`, of length nodes · `components`. The total of a
/// constant force is exact, also on curved cells.
///
/// # Panics
/// When the cell is not of dimension `dim`, or a length is wrong.
pub fn body_load<F>(
    kind: CellKind,
    dim: usize,
    points: &[[f64; 3]],
    components: usize,
    f: F,
    out: &mut [f64],
) where
    F: FnMut([f64; 3]) -> [f64; 3],
{
    body_load_by(Integration::Full, kind, dim, points, components, f, out);
}

/// As [`body_load`], with the points of the stiffness on cells of second order with reduced integration: CalculiX's
/// forces on C3D20R, C3D15 and CPE8R, exact for constants on affine cells.
///
/// # Panics
/// As [`body_load`].
pub fn body_load_by<F>(
    integration: Integration,
    kind: CellKind,
    dim: usize,
    points: &[[f64; 3]],
    components: usize,
    mut f: F,
    out: &mut [f64],
) where
    F: FnMut([f64; 3]) -> [f64; 3],
{
    check_dim(kind, dim);
    let n = points.len() * components;
    assert_eq!(out.len(), n, "a cell has {n} degrees of freedom");
    out.fill(0.0);
    let reduced = integration == Integration::Reduced && kind.order() == 2;
    let purpose = if reduced {
        Purpose::Reduced
    } else {
        Purpose::Load
    };
    let table = table(kind, purpose);
    for_each_weight(kind, points, table, |index, weight| {
        let values = table.values(index);
        let force = f(interpolate_position(points, values)).map(|value| value * weight);
        for (node, shape) in out.chunks_exact_mut(components).zip(values) {
            for (entry, value) in node.iter_mut().zip(force) {
                *entry += value * shape;
            }
        }
    });
}

/// The volume of a cell, in the plane its area; exact, also of curved cells, and negative where the cell is inverted.
///
/// # Panics
/// When the cell is not of dimension `dim`, or has another number of nodes.
pub fn volume(kind: CellKind, dim: usize, points: &[[f64; 3]]) -> f64 {
    check_dim(kind, dim);
    let mut sum = 0.0;
    for_each_weight(kind, points, table(kind, Purpose::Load), |_, weight| {
        sum += weight;
    });
    sum
}

/// The image of the middle of the reference cell: a point inside.
///
/// # Panics
/// When the cell has another number of nodes.
pub fn middle(kind: CellKind, points: &[[f64; 3]]) -> [f64; 3] {
    assert_eq!(points.len(), kind.nodes(), "a {}", kind.name());
    interpolate_position(points, table(kind, Purpose::Centre).values(0))
}

/// Panics unless a cell is of this dimension.
pub(super) fn check_dim(kind: CellKind, dim: usize) {
    assert_eq!(kind.dim(), dim, "a {} in dimension {dim}", kind.name());
}

/// Calls `f` with every point of the rule and its weight times det J.
pub(super) fn for_each_weight(
    kind: CellKind,
    points: &[[f64; 3]],
    table: &ShapeTable,
    f: impl FnMut(usize, f64),
) {
    by_kind!(kind, weights(points, table, f));
}

fn weights<const D: usize, const N: usize>(
    points: &[[f64; 3]],
    table: &ShapeTable,
    mut f: impl FnMut(usize, f64),
) {
    let at = relative::<D, N>(points);
    for (index, weight) in table.weights.iter().enumerate() {
        let (det, _) = invert(&jacobian(&at, &slopes::<D, N>(table, index)));
        f(index, weight * det);
    }
}

#[cfg(test)]
#[path = "../../tests/element/loads.rs"]
mod tests;
