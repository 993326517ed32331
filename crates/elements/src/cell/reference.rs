//! Shape functions and quadrature on the unit cell \[0,1\]^D, for D = 1 (sides of 2D cells), 2 and 3.

use crate::q1::{GAUSS2, GAUSS4};

/// The shape functions on a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Element {
    /// Bilinear or trilinear, mapped.
    #[default]
    Q1,
    /// Linear on simplices: a quadrilateral is two triangles along its diagonal 0–3, a hexahedron is six tetrahedra
    /// around its diagonal 0–7 (Kuhn), a side two triangles along its diagonal 0–3. Equally oriented neighbours match.
    P1,
}

/// The purpose of an integral, which determines the order of the quadrature.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rule {
    Stiffness,
    Load,
    Error,
}

/// A quadrature point of the unit cell.
pub(super) struct ReferencePoint<const D: usize, const N: usize> {
    /// N_a.
    pub shape: [f64; N],
    /// `[j][a]` = ∂N_a/∂s_j.
    pub slope: [[f64; N]; D],
    /// The weights of a rule sum to 1, the volume of the unit cell.
    pub weight: f64,
}

/// Calls `f` with every point of the rule.
#[inline]
pub(super) fn for_each<const D: usize, const N: usize>(
    element: Element,
    rule: Rule,
    mut f: impl FnMut(&ReferencePoint<D, N>),
) {
    match element {
        Element::Q1 => {
            let line: &[(f64, f64)] = match rule {
                Rule::Stiffness | Rule::Load => &GAUSS2,
                Rule::Error => &GAUSS4,
            };
            tensor::<D>(line, |at, weight| f(&q1_point(at, weight)));
        }
        Element::P1 => {
            for order in orders(D) {
                simplex::<D>(rule, |falling, weight| f(&p1_point(order, falling, weight)));
            }
        }
    }
}

/// The tensor product of a rule on \[0,1\].
#[inline]
fn tensor<const D: usize>(line: &[(f64, f64)], mut f: impl FnMut([f64; D], f64)) {
    let n = line.len();
    for k in 0..n.pow(D as u32) {
        let (mut at, mut weight, mut rest) = ([0.0; D], 1.0, k);
        for s in &mut at {
            let (point, w) = line[rest % n];
            *s = point;
            weight *= w;
            rest /= n;
        }
        f(at, weight);
    }
}

/// The multilinear shape functions: N_a is a product of s_i or 1 − s_i.
#[inline]
pub(super) fn q1_point<const D: usize, const N: usize>(
    at: [f64; D],
    weight: f64,
) -> ReferencePoint<D, N> {
    let (mut shape, mut slope) = ([1.0; N], [[1.0; N]; D]);
    for a in 0..N {
        for (i, &s) in at.iter().enumerate() {
            let upper = a >> i & 1 == 1;
            let factor = if upper { s } else { 1.0 - s };
            shape[a] *= factor;
            for (j, row) in slope.iter_mut().enumerate() {
                row[a] *= match (i == j, upper) {
                    (false, _) => factor,
                    (true, true) => 1.0,
                    (true, false) => -1.0,
                };
            }
        }
    }
    ReferencePoint {
        shape,
        slope,
        weight,
    }
}

/// The simplices of the unit cell. The simplex of `order` has coordinates s_order\[0\] ≥ s_order\[1\] ≥ …; its vertices
/// lie on the walk from corner 0 to the last corner along the axes in this order.
fn orders(dim: usize) -> &'static [[usize; 3]] {
    match dim {
        1 => &[[0, 1, 2]],
        2 => &[[0, 1, 2], [1, 0, 2]],
        _ => &[
            [0, 1, 2],
            [0, 2, 1],
            [1, 0, 2],
            [1, 2, 0],
            [2, 0, 1],
            [2, 1, 0],
        ],
    }
}

/// A rule on one simplex, given by the falling coordinates of its points; the weights sum to 1/D!.
#[inline]
fn simplex<const D: usize>(rule: Rule, mut f: impl FnMut([f64; D], f64)) {
    let volume = 1.0 / (1..=D).product::<usize>() as f64;
    let vertices = (D + 1) as f64;
    match rule {
        Rule::Stiffness => {
            let centroid = std::array::from_fn(|k| (D - k) as f64 / vertices);
            f(centroid, volume);
        }
        // D + 1 points with the same value of all barycentric coordinates but one: exact for quadratic functions.
        Rule::Load => {
            let beta = (vertices + 1.0 - (vertices + 1.0).sqrt()) / (vertices * (vertices + 1.0));
            let peak = 1.0 - (D + 1) as f64 * beta;
            for near in 0..=D {
                // Coordinate k is the sum of the barycentric coordinates of the vertices after k.
                let falling = std::array::from_fn(|k| {
                    (D - k) as f64 * beta + if near > k { peak } else { 0.0 }
                });
                f(falling, volume / vertices);
            }
        }
        // Collapsed coordinates a, ab, abc: exact for degree 8 − D.
        Rule::Error => tensor::<D>(&GAUSS4, |at, mut weight| {
            let (mut falling, mut product) = ([0.0; D], 1.0);
            for (k, s) in at.into_iter().enumerate() {
                weight *= s.powi((D - 1 - k) as i32);
                product *= s;
                falling[k] = product;
            }
            f(falling, weight);
        }),
    }
}

/// The barycentric coordinates of a simplex are the differences of its falling coordinates.
#[inline]
fn p1_point<const D: usize, const N: usize>(
    order: &[usize; 3],
    falling: [f64; D],
    weight: f64,
) -> ReferencePoint<D, N> {
    let (mut shape, mut slope) = ([0.0; N], [[0.0; N]; D]);
    let mut vertex = 0;
    let mut before = 1.0;
    for (&axis, s) in order.iter().zip(falling) {
        shape[vertex] = before - s;
        slope[axis][vertex] = -1.0;
        vertex |= 1 << axis;
        slope[axis][vertex] = 1.0;
        before = s;
    }
    shape[vertex] = before;
    ReferencePoint {
        shape,
        slope,
        weight,
    }
}

#[cfg(test)]
#[path = "../../tests/cell/reference.rs"]
mod tests;
