//! Sides of cells: tractions, pressures, areas and normals.

use super::map::interpolate_vertex_position;
use super::reference::{for_each, ReferencePoint, Rule};
use super::Element;
use base::linalg::vec3::{cross, norm};

/// A side of a cell: where coordinate `axis` of the unit cell is 0 or 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Side {
    /// 0, 1 or 2.
    pub axis: usize,
    /// At 1 instead of 0.
    pub upper: bool,
}

impl Side {
    /// Side number `index` in the order left, right, bottom, top, back, front.
    pub fn of_index(index: usize) -> Side {
        Side {
            axis: index / 2,
            upper: index % 2 == 1,
        }
    }

    /// Place along the axis of the elements on this side of a box of `elements`.
    pub fn level(self, elements: [usize; 3]) -> usize {
        if self.upper {
            elements[self.axis] - 1
        } else {
            0
        }
    }

    /// The cell's corners on the side, 2 or 4, in lexicographic order of the other axes: the order in which the
    /// functions of this module take a side's points.
    pub fn corners(self, dim: usize) -> impl Iterator<Item = usize> {
        (0..1 << dim).filter(move |a| (a >> self.axis & 1 == 1) == self.upper)
    }

    /// The orientation that makes normals point out of the cell when the side's points are in the order of
    /// [`Side::corners`].
    pub fn outward(self, dim: usize) -> f64 {
        // The right-hand side of the edge, or the cross product of the two directions, points along +x, −y, +z; in 2D
        // +x, −y.
        debug_assert!(self.axis < dim);
        if self.upper == (self.axis != 1) {
            1.0
        } else {
            -1.0
        }
    }
}

/// Areas and normals of a side, by corner; in 2D only the first two entries are used, and areas are lengths.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SideWeights {
    /// ∫ N_a.
    pub area: [f64; 4],
    /// ∫ N_a n with the unit normal n.
    pub normal: [[f64; 3]; 4],
}

/// Nodal areas and area-weighted normals of a side with the 2 or 4 `points`, `outward` (±1) being [`Side::outward`].
///
/// Sums over the sides around a node give its averaged normal; a nodal force divided by its area is a pressure. The
/// normals are exact, the areas too where the side is flat.
///
/// # Panics
/// When `dim` is not 2 or 3, or there are not 2^(`dim` − 1) points.
pub fn side_weights(
    dim: usize,
    points: &[[f64; 3]],
    outward: f64,
    element: Element,
) -> SideWeights {
    let mut weights = SideWeights::default();
    for_each_point(dim, points, outward, element, |_, vector, shape, weight| {
        let area = norm(vector);
        for (a, n) in shape.iter().enumerate() {
            weights.area[a] += weight * n * area;
            for i in 0..3 {
                weights.normal[a][i] += weight * n * vector[i];
            }
        }
    });
    weights
}

/// The nodal forces ∫ f_i N_a of a force per area on a side, into `out`, of length 2^(`dim` − 1) · `components`.
///
/// `f` gets the point and the unit normal. A traction ignores the normal, a pressure p returns −p n. The quadrature is
/// the rule for loads of [the table](super) in dimension `dim` − 1: the total of a constant traction is exact, and a
/// constant pressure on a closed surface has total zero.
///
/// # Panics
/// When `dim` is not 2 or 3, or a length is wrong.
pub fn side_load<F>(
    dim: usize,
    points: &[[f64; 3]],
    outward: f64,
    element: Element,
    components: usize,
    mut f: F,
    out: &mut [f64],
) where
    F: FnMut([f64; 3], [f64; 3]) -> [f64; 3],
{
    let n = points.len() * components;
    assert_eq!(out.len(), n, "a side has {n} degrees of freedom");
    out.fill(0.0);
    for_each_point(
        dim,
        points,
        outward,
        element,
        |point, vector, shape, weight| {
            let area = norm(vector);
            let force = f(point, vector.map(|v| v / area)).map(|value| value * weight * area);
            for (node, n) in out.chunks_exact_mut(components).zip(shape) {
                for (entry, value) in node.iter_mut().zip(force) {
                    *entry += value * n;
                }
            }
        },
    );
}

/// Calls `f` with point, area-weighted normal n |∂x/∂s|, shape functions and the rule's weight.
fn for_each_point(
    dim: usize,
    points: &[[f64; 3]],
    outward: f64,
    element: Element,
    mut f: impl FnMut([f64; 3], [f64; 3], &[f64], f64),
) {
    match dim {
        2 => {
            let points = corners::<2>(points);
            for_each::<1, 2>(element, Rule::Load, |r| {
                let [[x, y, _]] = tangents(points, r);
                let normal = [outward * y, -outward * x, 0.0];
                f(
                    interpolate_vertex_position(points, &r.shape),
                    normal,
                    &r.shape,
                    r.weight,
                );
            });
        }
        3 => {
            let points = corners::<4>(points);
            for_each::<2, 4>(element, Rule::Load, |r| {
                let [s, t] = tangents(points, r);
                let normal = cross(s, t).map(|v| outward * v);
                f(
                    interpolate_vertex_position(points, &r.shape),
                    normal,
                    &r.shape,
                    r.weight,
                );
            });
        }
        _ => panic!("cells have dimension 2 or 3, not {dim}"),
    }
}

fn corners<const N: usize>(points: &[[f64; 3]]) -> &[[f64; 3]; N] {
    points
        .try_into()
        .unwrap_or_else(|_| panic!("a side of {N} corners got {} points", points.len()))
}

/// `[j]` = ∂x/∂s_j.
fn tangents<const D: usize, const N: usize>(
    points: &[[f64; 3]; N],
    reference: &ReferencePoint<D, N>,
) -> [[f64; 3]; D] {
    reference
        .slope
        .map(|slope| interpolate_vertex_position(points, &slope))
}

#[cfg(test)]
#[path = "../../tests/cell/sides.rs"]
mod tests;
