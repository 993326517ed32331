//! The map from the unit cell to a cell: gradients and volumes at quadrature points.

use super::reference::{for_each, q1_point, Element, ReferencePoint, Rule};
use base::linalg::small::invert;

/// A quadrature point of a cell; what a cell of the plane does not have is zero.
pub(super) struct CellSample {
    pub point: [f64; 3],
    /// N_a.
    pub shape: [f64; 8],
    /// `[i][a]` = ∂N_a/∂x_i.
    pub gradient: [[f64; 8]; 3],
    /// Weight of the rule times det J: the weights sum to the volume.
    pub weight: f64,
}

/// Calls `f` with every quadrature point of the cell.
#[inline]
pub(super) fn for_each_sample<const D: usize, const N: usize>(
    points: &[[f64; 3]],
    element: Element,
    rule: Rule,
    mut f: impl FnMut(&CellSample),
) {
    let points = corners::<N>(points);
    for_each::<D, N>(element, rule, |reference| {
        f(&sample(points, reference));
    });
}

/// Calls `f` with every quadrature point of a cell whose dimension is known at run time.
///
/// # Panics
/// When `dim` is not 2 or 3, or there are not 2^`dim` points.
pub(super) fn for_each_sample_of(
    dim: usize,
    points: &[[f64; 3]],
    element: Element,
    rule: Rule,
    f: impl FnMut(&CellSample),
) {
    match dim {
        2 => for_each_sample::<2, 4>(points, element, rule, f),
        3 => for_each_sample::<3, 8>(points, element, rule, f),
        _ => panic!("cells have dimension 2 or 3, not {dim}"),
    }
}

/// The middle of the unit cell, for Q1.
pub(super) fn centre_sample(dim: usize, points: &[[f64; 3]]) -> CellSample {
    match dim {
        2 => sample(corners::<4>(points), &q1_point([0.5; 2], 1.0)),
        _ => sample(corners::<8>(points), &q1_point([0.5; 3], 1.0)),
    }
}

fn corners<const N: usize>(points: &[[f64; 3]]) -> &[[f64; 3]; N] {
    points
        .try_into()
        .unwrap_or_else(|_| panic!("a cell of {N} corners got {} points", points.len()))
}

#[inline]
fn sample<const D: usize, const N: usize>(
    points: &[[f64; 3]; N],
    reference: &ReferencePoint<D, N>,
) -> CellSample {
    let (det, inverse) = invert(&jacobian(points, reference));
    let (mut shape, mut gradient) = ([0.0; 8], [[0.0; 8]; 3]);
    shape[..N].copy_from_slice(&reference.shape);
    for i in 0..D {
        for (j, slope) in reference.slope.iter().enumerate() {
            for a in 0..N {
                gradient[i][a] += inverse[j][i] * slope[a]; // ∇N = J⁻ᵀ ∇̂N
            }
        }
    }
    CellSample {
        point: interpolate_vertex_position(points, &reference.shape),
        shape,
        gradient,
        weight: reference.weight * det,
    }
}

/// Σ N_a x_a.
#[inline]
pub(super) fn interpolate_vertex_position<const N: usize>(
    points: &[[f64; 3]; N],
    shape: &[f64; N],
) -> [f64; 3] {
    let mut out = [0.0; 3];
    for (point, n) in points.iter().zip(shape) {
        for i in 0..3 {
            out[i] += n * point[i];
        }
    }
    out
}

/// `[i][j]` = ∂x_i/∂s_j.
#[inline]
fn jacobian<const D: usize, const N: usize>(
    points: &[[f64; 3]; N],
    reference: &ReferencePoint<D, N>,
) -> [[f64; D]; D] {
    let mut j = [[0.0; D]; D];
    for (i, row) in j.iter_mut().enumerate() {
        for (entry, slope) in row.iter_mut().zip(&reference.slope) {
            for a in 0..N {
                *entry += points[a][i] * slope[a];
            }
        }
    }
    j
}

/// Whether det J is positive (and finite) wherever it is evaluated, and at the corners: a cell that fails is folded,
/// flat or numbered the wrong way round. For P1 all simplices must have positive volume.
///
/// # Panics
/// When `dim` is not 2 or 3, or there are not 2^`dim` points.
pub fn jacobian_is_positive(dim: usize, points: &[[f64; 3]], element: Element) -> bool {
    match dim {
        2 => is_positive::<2, 4>(points, element),
        3 => is_positive::<3, 8>(points, element),
        _ => panic!("cells have dimension 2 or 3, not {dim}"),
    }
}

fn is_positive<const D: usize, const N: usize>(points: &[[f64; 3]], element: Element) -> bool {
    let points = corners::<N>(points);
    let mut good = true;
    let mut look = |reference: &ReferencePoint<D, N>| {
        let (det, _) = invert(&jacobian(points, reference));
        good &= det > 0.0 && det.is_finite();
    };
    match element {
        Element::P1 => for_each(element, Rule::Stiffness, look),
        Element::Q1 => {
            for a in 0..N {
                let corner = std::array::from_fn(|i| (a >> i & 1) as f64);
                look(&q1_point(corner, 1.0));
            }
            for_each(element, Rule::Stiffness, &mut look);
            for_each(element, Rule::Error, &mut look);
        }
    }
    good
}

#[cfg(test)]
#[path = "../../tests/cell/map.rs"]
mod tests;
