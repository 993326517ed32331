//! Matrices of two or three rows.

/// Determinant and inverse of a 2 × 2 or 3 × 3 matrix.
#[inline]
pub fn invert<const D: usize>(j: &[[f64; D]; D]) -> (f64, [[f64; D]; D]) {
    let mut adjugate = [[0.0; D]; D];
    if D == 2 {
        adjugate[0][0] = j[1][1];
        adjugate[0][1] = -j[0][1];
        adjugate[1][0] = -j[1][0];
        adjugate[1][1] = j[0][0];
    } else {
        for (i, row) in adjugate.iter_mut().enumerate() {
            for (k, entry) in row.iter_mut().enumerate() {
                let (p, q, r, s) = ((k + 1) % 3, (k + 2) % 3, (i + 1) % 3, (i + 2) % 3);
                *entry = j[p][r] * j[q][s] - j[p][s] * j[q][r];
            }
        }
    }
    let det: f64 = (0..D).map(|i| j[0][i] * adjugate[i][0]).sum();
    let factor = 1.0 / det;
    for entry in adjugate.iter_mut().flatten() {
        *entry *= factor;
    }
    (det, adjugate)
}
