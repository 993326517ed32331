//! The orthogonal matrix by which one set of blocks is similar to another.

use super::orthogonal::{exact, nearest, Matrix};

/// An entry of Q below this counts as zero where its sign is chosen.
const ZERO: f64 = 1e-6;

/// Q with B_k = r Q A_k Qᵀ for the `n` pairs of blocks of `size` rows; `pair(k)` is (A_k, B_k). Q is the orthogonal
/// matrix nearest to the one that makes Σ |B_k Q − r Q A_k|² smallest (Frobenius norms). The caller has to see how well
/// it fits. −Q does as well as Q; the first entry of Q that is not zero is positive. `None` if no orthogonal matrix is
/// near.
///
/// Q is the only one, but for its sign, if no matrix other than multiples of the identity commutes with all A_k.
pub fn similarity(
    n: usize,
    size: usize,
    r: f64,
    pair: impl Fn(usize) -> [Matrix; 2],
) -> Option<Matrix> {
    let unknowns = size * size;
    let mut normal = [[0.0; 9]; 9];
    for k in 0..n {
        let [a, b] = pair(k);
        for i in 0..size {
            for j in 0..size {
                // Σ_l B_il Q_lj − r Σ_l Q_il A_lj
                let mut row = [0.0; 9];
                for l in 0..size {
                    row[l * size + j] += b[i][l];
                    row[i * size + l] -= r * a[l][j];
                }
                for (normal, x) in normal.iter_mut().zip(row) {
                    normal.iter_mut().zip(row).for_each(|(n, y)| *n += x * y);
                }
            }
        }
    }
    let normal = faer::Mat::from_fn(unknowns, unknowns, |i, j| normal[i][j]);
    let eigen = normal.self_adjoint_eigen(faer::Side::Lower).ok()?;
    let mut q = [[0.0; 3]; 3];
    (size..3).for_each(|d| q[d][d] = 1.0);
    let root = (size as f64).sqrt();
    for i in 0..unknowns {
        q[i / size][i % size] = root * eigen.U()[(i, 0)];
    }
    let first = q[0].iter().find(|v| v.abs() > ZERO)?;
    let sign = first.signum();
    let own = q[..size].iter_mut().flat_map(|row| &mut row[..size]);
    own.for_each(|v| *v *= sign);
    nearest(q).map(exact)
}

#[cfg(test)]
#[path = "../../tests/linalg/similar.rs"]
mod tests;
