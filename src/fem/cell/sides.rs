//! Sides of cells: tractions, pressures, areas and normals.

use super::map::place;
use super::reference::{for_each, ReferencePoint, Rule};
use super::Element;
use crate::linalg::vec3::{cross, norm};

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

    /// All sides of a cell.
    pub fn all(dim: usize) -> impl Iterator<Item = Side> {
        (0..2 * dim).map(Side::of_index)
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
                f(place(points, &r.shape), normal, &r.shape, r.weight);
            });
        }
        3 => {
            let points = corners::<4>(points);
            for_each::<2, 4>(element, Rule::Load, |r| {
                let [s, t] = tangents(points, r);
                let normal = cross(s, t).map(|v| outward * v);
                f(place(points, &r.shape), normal, &r.shape, r.weight);
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
    reference.slope.map(|slope| place(points, &slope))
}

#[cfg(test)]
mod tests {
    use super::super::testing::{distorted, unit};
    use super::*;

    fn points(cell: &[[f64; 3]], side: Side, dim: usize) -> Vec<[f64; 3]> {
        side.corners(dim).map(|a| cell[a]).collect()
    }

    #[test]
    fn normals_of_the_unit_cell_point_out_of_it() {
        for dim in [2, 3] {
            for side in Side::all(dim) {
                let points = points(&unit(dim), side, dim);
                for element in [Element::Q1, Element::P1] {
                    let weights = side_weights(dim, &points, side.outward(dim), element);
                    assert!((weights.area.iter().sum::<f64>() - 1.0).abs() < 1e-15);
                    for i in 0..3 {
                        let sum: f64 = weights.normal.iter().map(|n| n[i]).sum();
                        let sign = if side.upper { 1.0 } else { -1.0 };
                        let expected = if i == side.axis { sign } else { 0.0 };
                        assert!((sum - expected).abs() < 1e-15, "{side:?} {weights:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn pressure_on_the_surface_of_a_distorted_cell_has_no_force_and_no_moment() {
        for dim in [2, 3] {
            for element in [Element::Q1, Element::P1] {
                for seed in 0..5 {
                    let cell = distorted(dim, seed);
                    let (mut force, mut moment, mut size) = ([0.0; 3], [0.0; 3], 0.0);
                    let mut divergence = 0.0;
                    for side in Side::all(dim) {
                        let points = points(&cell, side, dim);
                        let mut out = vec![0.0; points.len() * dim];
                        let pressure = |_, n: [f64; 3]| n.map(|v| -4.0 * v);
                        let outward = side.outward(dim);
                        side_load(dim, &points, outward, element, dim, pressure, &mut out);
                        for (p, g) in points.iter().zip(out.chunks(dim)) {
                            let g = [g[0], g[1], g.get(2).copied().unwrap_or(0.0)];
                            for i in 0..3 {
                                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                                force[i] += g[i];
                                moment[i] += p[j] * g[k] - p[k] * g[j];
                                size += g[i].abs();
                                divergence -= p[i] * g[i] / (4.0 * dim as f64);
                            }
                        }
                    }
                    assert!(size > 1.0);
                    assert!(force.iter().all(|v| v.abs() < 1e-14), "{force:?}");
                    assert!(moment.iter().all(|v| v.abs() < 1e-14), "{moment:?}");
                    // ∫ x·n = dim · volume: orientation and size are right, too.
                    let mut volume = 0.0;
                    let mut add = |w: f64| volume += w;
                    if dim == 2 {
                        super::super::map::for_each_sample::<2, 4>(
                            &cell,
                            element,
                            Rule::Load,
                            |s| add(s.weight),
                        );
                    } else {
                        super::super::map::for_each_sample::<3, 8>(
                            &cell,
                            element,
                            Rule::Load,
                            |s| add(s.weight),
                        );
                    }
                    assert!((divergence - volume).abs() < 1e-14, "{divergence} {volume}");
                }
            }
        }
    }

    #[test]
    fn tractions_have_their_exact_totals_and_moments() {
        // The edge from (1, 1) to (4, 5) has length 5; q = 2 s along it: total 25, about its start 2·125/3.
        let edge = [[1.0, 1.0, 0.0], [4.0, 5.0, 0.0]];
        let along = |p: [f64; 3]| (p[0] - 1.0) / 3.0 * 5.0;
        let mut out = [0.0; 2];
        let q = |p: [f64; 3], _: [f64; 3]| [2.0 * along(p), 0.0, 0.0];
        side_load(2, &edge, 1.0, Element::Q1, 1, q, &mut out);
        assert!((out[0] + out[1] - 25.0).abs() < 1e-13);
        assert!((5.0 * out[1] - 250.0 / 3.0).abs() < 1e-13);
        // A flat parallelogram of area 6 in space.
        let flat: Vec<_> = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]
            .map(|[s, t]| [3.0 * s, 2.0 * t + s, 1.0])
            .to_vec();
        for element in [Element::Q1, Element::P1] {
            let mut out = [0.0; 12];
            let q = |p: [f64; 3], n: [f64; 3]| [p[0], p[1], 7.0 * n[2]];
            side_load(3, &flat, -1.0, element, 3, q, &mut out);
            let total = |i: usize| out.iter().skip(i).step_by(3).sum::<f64>();
            // The centroid is (1.5, 1.5), and outward = −1 turns the normal down.
            for (i, expected) in [9.0, 9.0, -42.0].into_iter().enumerate() {
                assert!((total(i) - expected).abs() < 1e-13, "{}", total(i));
            }
        }
    }
}
