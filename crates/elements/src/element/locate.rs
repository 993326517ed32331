//! Where a point lies in a cell.

use super::shape_functions::shape;
use crate::kind::CellKind;
use base::linalg::vec3::{minus, norm};

/// A point is in a cell if it is not farther outside than this fraction of the reference cell.
const OUTSIDE: f64 = 1e-6;

/// Most steps of Newton's method; it needs one on affine cells.
const STEPS: usize = 30;

/// The values of the shape functions of a cell at the point `x`; `None` if the point is outside the cell.
pub fn locate(kind: CellKind, points: &[[f64; 3]], x: [f64; 3]) -> Option<Vec<f64>> {
    let (dim, n) = (kind.dim(), kind.nodes());
    // The centre of the reference cell, for a start.
    let mut at = match kind.linear() {
        CellKind::Triangle3 => [1.0 / 3.0, 1.0 / 3.0, 0.0],
        CellKind::Tet4 => [0.25; 3],
        CellKind::Wedge6 => [1.0 / 3.0, 1.0 / 3.0, 0.0],
        CellKind::Pyramid5 => [0.0, 0.0, 0.25],
        _ => [0.0; 3],
    };
    let size = points
        .iter()
        .map(|p| norm(minus(*p, points[0])))
        .fold(0.0, f64::max);
    for _ in 0..STEPS {
        let here = shape(kind, at);
        let mut place = [0.0; 3];
        let mut jacobian = [[0.0; 3]; 3];
        for (a, point) in points.iter().enumerate() {
            for i in 0..dim {
                place[i] += here.value[a] * point[i];
                for j in 0..dim {
                    jacobian[i][j] += here.slope[j][a] * point[i];
                }
            }
        }
        let mut away = [0.0; 3];
        (0..dim).for_each(|i| away[i] = x[i] - place[i]);
        if norm(away) <= 1e-13 * size {
            break;
        }
        let step = solve(jacobian, away, dim)?;
        // Far steps leave the region in which the map is regular.
        let long = norm(step).max(1.0);
        (0..dim).for_each(|i| at[i] += step[i] / long);
    }
    let last = shape(kind, at);
    let mut place = [0.0; 3];
    for (a, point) in points.iter().enumerate() {
        (0..dim).for_each(|i| place[i] += last.value[a] * point[i]);
    }
    let missed = (0..dim).any(|i| (place[i] - x[i]).abs() > OUTSIDE * size);
    (!missed && inside(kind, at)).then(|| last.value[..n].to_vec())
}

/// Whether a point of the reference space is in the reference cell.
fn inside(kind: CellKind, [r, s, t]: [f64; 3]) -> bool {
    let (low, high) = (-OUTSIDE, 1.0 + OUTSIDE);
    let flat = |v: f64| v.abs() <= high;
    match kind.linear() {
        CellKind::Point1 => true,
        CellKind::Line2 => flat(r),
        CellKind::Quad4 => flat(r) && flat(s),
        CellKind::Hex8 => flat(r) && flat(s) && flat(t),
        CellKind::Triangle3 => r >= low && s >= low && r + s <= high,
        CellKind::Tet4 => r >= low && s >= low && t >= low && r + s + t <= high,
        CellKind::Wedge6 => r >= low && s >= low && r + s <= high && flat(t),
        _ => t >= low && r.abs().max(s.abs()) <= high - t,
    }
}

/// The solution of a 2 × 2 or 3 × 3 system by Cramer's rule; `None` if the matrix is singular.
fn solve(m: [[f64; 3]; 3], b: [f64; 3], dim: usize) -> Option<[f64; 3]> {
    let mut m = m;
    if dim == 2 {
        m[2] = [0.0, 0.0, 1.0];
        (m[0][2], m[1][2]) = (0.0, 0.0);
    }
    let det = |m: &[[f64; 3]; 3]| -> f64 {
        (0..3)
            .map(|i| {
                m[0][i]
                    * (m[1][(i + 1) % 3] * m[2][(i + 2) % 3]
                        - m[1][(i + 2) % 3] * m[2][(i + 1) % 3])
            })
            .sum()
    };
    let whole = det(&m);
    if whole == 0.0 || !whole.is_finite() {
        return None;
    }
    let column = |j: usize| {
        let mut with = m;
        (0..3).for_each(|i| with[i][j] = b[i]);
        det(&with) / whole
    };
    Some([0, 1, 2].map(column))
}
