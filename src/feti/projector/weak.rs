//! Motions of single bodies on which rows do no more than rounding of the input allows (`noise`).

use crate::feti::primal::kernel::fixing_rows;
use base::linalg::dense::Dense;

/// Eigenvalues of a small matrix are known to this part of the largest one.
const EIGENVALUES: f64 = 1e-14;

/// The columns of a body that are best left out, increasing: as many as it has motions on which its rows do no more
/// than `noise`. `block` is GᵀG of the body.
pub(super) fn weak_columns(block: &Dense, noise: f64) -> Vec<usize> {
    if noise == 0.0 || block.rows == 0 {
        return Vec::new();
    }
    let a = faer::Mat::from_fn(block.rows, block.rows, |i, j| block.get(i, j));
    let eigen = a.self_adjoint_eigen(faer::Side::Lower);
    let eigen = eigen.expect("eigenvalues of a small symmetric finite matrix converge");
    let values = eigen.S().column_vector();
    // They increase, and are known to rounding of the largest one.
    let limit = noise.max(EIGENVALUES * values[block.rows - 1]);
    let weak = (0..block.rows).filter(|&k| values[k] <= limit).count();
    let motions = Dense::from_fn(block.rows, weak, |i, k| eigen.U()[(i, k)]);
    let mut columns = fixing_rows(&motions);
    columns.sort_unstable();
    columns
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/projector/weak.rs"]
mod tests;
