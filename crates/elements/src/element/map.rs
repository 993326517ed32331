//! The map from the reference cell to a cell: gradients and volumes at the points of a rule.

use super::table::ShapeTable;
use base::linalg::small::invert;

/// A point of a rule on a cell.
pub(super) struct ElementSample<const D: usize, const N: usize> {
    /// Which of the rule's points it is.
    pub index: usize,
    /// `[i][a]` = ∂N_a/∂x_i.
    pub gradient: [[f64; N]; D],
    /// Weight of the rule times det J: the weights sum to the volume.
    pub weight: f64,
}

/// a b + c, in one operation where the processor has one.
#[inline(always)]
pub(super) fn fma(a: f64, b: f64, c: f64) -> f64 {
    if cfg!(target_feature = "fma") {
        a.mul_add(b, c)
    } else {
        a * b + c
    }
}

/// Calls `f` with the dimension and the number of nodes of a plane or solid cell as constants.
macro_rules! by_kind {
    ($kind:expr, $f:ident($($argument:expr),* $(,)?)) => {
        match $kind {
            CellKind::Triangle3 => $f::<2, 3>($($argument),*),
            CellKind::Triangle6 => $f::<2, 6>($($argument),*),
            CellKind::Quad4 => $f::<2, 4>($($argument),*),
            CellKind::Quad8 => $f::<2, 8>($($argument),*),
            CellKind::Quad9 => $f::<2, 9>($($argument),*),
            CellKind::Tet4 => $f::<3, 4>($($argument),*),
            CellKind::Tet10 => $f::<3, 10>($($argument),*),
            CellKind::Pyramid5 => $f::<3, 5>($($argument),*),
            CellKind::Wedge6 => $f::<3, 6>($($argument),*),
            CellKind::Wedge15 => $f::<3, 15>($($argument),*),
            CellKind::Hex8 => $f::<3, 8>($($argument),*),
            CellKind::Hex20 => $f::<3, 20>($($argument),*),
            CellKind::Hex27 => $f::<3, 27>($($argument),*),
            kind => panic!("a {} is no plane or solid cell", kind.name()),
        }
    };
}
pub(super) use by_kind;

/// `[i][a]` = coordinate i of node a, from node 0: small numbers wherever the cell lies.
#[inline]
pub(super) fn relative<const D: usize, const N: usize>(points: &[[f64; 3]]) -> [[f64; N]; D] {
    let points: &[[f64; 3]; N] = points
        .try_into()
        .unwrap_or_else(|_| panic!("a cell of {N} nodes got {} points", points.len()));
    let mut out = [[0.0; N]; D];
    for (i, row) in out.iter_mut().enumerate() {
        for (x, point) in row.iter_mut().zip(points) {
            *x = point[i] - points[0][i];
        }
    }
    out
}

/// Calls `f` with every point of the rule; `at` are the nodes as [`relative`] has them.
#[inline]
pub(super) fn for_each_sample<const D: usize, const N: usize>(
    at: &[[f64; N]; D],
    table: &ShapeTable,
    mut f: impl FnMut(&ElementSample<D, N>),
) {
    for (index, weight) in table.weights.iter().enumerate() {
        let slopes = slopes::<D, N>(table, index);
        let (det, inverse) = invert(&jacobian(at, &slopes));
        let mut gradient = [[0.0; N]; D];
        for (i, row) in gradient.iter_mut().enumerate() {
            for (j, slope) in slopes.iter().enumerate() {
                for (g, s) in row.iter_mut().zip(*slope) {
                    *g = fma(inverse[j][i], *s, *g); // ∇N = J⁻ᵀ ∇̂N
                }
            }
        }
        f(&ElementSample {
            index,
            gradient,
            weight: weight * det,
        });
    }
}

/// The slopes at a point of the rule, as arrays.
#[inline]
pub(super) fn slopes<const D: usize, const N: usize>(
    table: &ShapeTable,
    index: usize,
) -> [&[f64; N]; D] {
    std::array::from_fn(|j| table.slopes(index, j).try_into().expect("a slope per node"))
}

/// `[i][j]` = ∂x_i/∂s_j.
#[inline]
pub(super) fn jacobian<const D: usize, const N: usize>(
    at: &[[f64; N]; D],
    slopes: &[&[f64; N]; D],
) -> [[f64; D]; D] {
    let mut jacobian = [[0.0; D]; D];
    for (row, x) in jacobian.iter_mut().zip(at) {
        for (entry, slope) in row.iter_mut().zip(slopes) {
            let mut sum = 0.0;
            for a in 0..N {
                sum = fma(x[a], slope[a], sum);
            }
            *entry = sum;
        }
    }
    jacobian
}

/// Σ N_a x_a with any number of nodes.
#[inline]
pub(super) fn interpolate_position(points: &[[f64; 3]], values: &[f64]) -> [f64; 3] {
    let mut out = [0.0; 3];
    for (point, n) in points.iter().zip(values) {
        for i in 0..3 {
            out[i] += n * point[i];
        }
    }
    out
}
