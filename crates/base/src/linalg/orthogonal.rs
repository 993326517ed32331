//! The rotation or reflection that takes one set of points to another.

use super::small::invert;
use super::vec3::{dot, minus, norm};

/// A matrix of three rows.
pub type Matrix = [[f64; 3]; 3];

/// The identity.
pub const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Points count as flat if the determinant of their scaled moments is below this: the fourth power of a ratio of axes
/// of a thousand.
const FLAT: f64 = 1e-12;

/// Steps of Newton's iteration. The start is within the distances of the points from a congruent set.
const NEWTON: usize = 5;

/// Rounds in which Q is corrected by what it leaves.
const ROUNDS: usize = 2;

/// Entries this near to 0, 1 and −1 are these numbers: a turn by a right angle, or none.
const EXACT: f64 = 1e-12;

/// An orthogonal fit y = Q x + t of points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fit {
    /// The orthogonal matrix Q, which may mirror.
    pub q: Matrix,
    /// The largest |y − Q x − t|, relative to the extent of the points.
    pub far: f64,
}

/// Fits y = Q x + t to `n` pairs of points by least squares; `pair(k)` is (x_k, y_k). In the plane (`dim` 2) the third
/// coordinates do not count. `None` if the x lie on a plane (a line in the plane), or if no Q comes near.
pub fn fit(n: usize, dim: usize, pair: impl Fn(usize) -> [[f64; 3]; 2]) -> Option<Fit> {
    let flat = |mut p: [f64; 3]| {
        p[dim..].fill(0.0);
        p
    };
    let mut middle = [[0.0; 3]; 2];
    for k in 0..n {
        for (m, p) in middle.iter_mut().zip(pair(k)) {
            (0..3).for_each(|d| m[d] += p[d] / n as f64);
        }
    }
    let pair = |k: usize| {
        let [x, y] = pair(k);
        [flat(minus(x, middle[0])), flat(minus(y, middle[1]))]
    };
    let extent = (0..n).map(|k| norm(pair(k)[0])).fold(0.0, f64::max);
    let mut moments = [[0.0; 3]; 3];
    (0..n).for_each(|k| add_product(&mut moments, pair(k)[0], pair(k)[0]));
    let scale = 1.0 / (n as f64 * extent * extent);
    moments.iter_mut().flatten().for_each(|m| *m *= scale);
    (dim..3).for_each(|d| moments[d][d] = 1.0);
    let (det, inverse) = invert(&moments);
    if det <= FLAT || det.is_nan() {
        return None;
    }
    // The linear map of least squares from x to y − Q x.
    let left = |q: &Matrix| {
        let mut sum = [[0.0; 3]; 3];
        for k in 0..n {
            let [x, y] = pair(k);
            add_product(&mut sum, minus(y, times(q, x)), x);
        }
        sum.iter_mut().flatten().for_each(|s| *s *= scale);
        product(&sum, &inverse)
    };
    let mut q = [[0.0; 3]; 3];
    (dim..3).for_each(|d| q[d][d] = 1.0);
    for _ in 0..=ROUNDS {
        let change = left(&q);
        let sum = |i: usize| [0, 1, 2].map(|j| q[i][j] + change[i][j]);
        q = nearest([0, 1, 2].map(sum))?;
    }
    q = exact(q);
    let far = |k: usize| {
        let [x, y] = pair(k);
        norm(minus(y, times(&q, x)))
    };
    let far = (0..n).map(far).fold(0.0, f64::max) / extent;
    far.is_finite().then_some(Fit { q, far })
}

/// Q x.
pub(crate) fn times(q: &Matrix, x: [f64; 3]) -> [f64; 3] {
    q.map(|row| dot(row, x))
}

fn add_product(sum: &mut Matrix, a: [f64; 3], b: [f64; 3]) {
    for (row, a) in sum.iter_mut().zip(a) {
        (0..3).for_each(|j| row[j] += a * b[j]);
    }
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    a.map(|row| [0, 1, 2].map(|j| (0..3).map(|k| row[k] * b[k][j]).sum()))
}

/// The nearest orthogonal matrix: Newton's iteration Q ← (Q + Q⁻ᵀ) / 2. `None` if `q` is far from one.
pub(super) fn nearest(mut q: Matrix) -> Option<Matrix> {
    for step in 0..NEWTON {
        let (det, inverse) = invert(&q);
        if step == 0 && !(0.5..2.0).contains(&det.abs()) {
            return None;
        }
        let mean = |i: usize| [0, 1, 2].map(|j| 0.5 * (q[i][j] + inverse[j][i]));
        q = [0, 1, 2].map(mean);
    }
    Some(q)
}

/// Q with exact zeros and ones, if all its entries are near them.
pub(super) fn exact(q: Matrix) -> Matrix {
    let rounded = q.map(|row| row.map(f64::round));
    let pairs = || q.iter().flatten().zip(rounded.iter().flatten());
    if pairs().all(|(a, b)| (a - b).abs() <= EXACT) {
        // Without −0, which is the same number and another word.
        return rounded.map(|row| row.map(|v| v + 0.0));
    }
    q
}

#[cfg(test)]
#[path = "../../tests/linalg/orthogonal.rs"]
mod tests;
