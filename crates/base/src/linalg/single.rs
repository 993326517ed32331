//! A dense matrix in single precision, for S in the preconditioner only.
//!
//! M⁻¹ only steers the iteration: seven digits do not change the number of iterations visibly below a κ of 10⁵, and
//! halve the memory traffic of the largest product. Residuals and F stay in double precision.

use super::dense::{gemv, multiply_single, Dense};

/// A square matrix by columns.
#[derive(Debug)]
pub struct Single {
    n: usize,
    /// Entries, relative to `scale`.
    data: Vec<f32>,
    /// The largest entry. Dividing by it makes the format independent of the unit of stiffness.
    scale: f64,
}

impl Single {
    /// `a` rounded. Both triangles are rounded alike, so that a symmetric matrix stays symmetric.
    pub fn new(a: &Dense) -> Single {
        let scale = match a.data.iter().fold(0.0f64, |s, v| s.max(v.abs())) {
            0.0 => 1.0,
            largest => largest,
        };
        Single {
            n: a.rows,
            data: a.data.iter().map(|v| (v / scale) as f32).collect(),
            scale,
        }
    }

    /// y ← factor A x. x is scaled to a largest entry of one before it is rounded, which keeps it in the range of
    /// single precision.
    pub fn mul(&self, factor: f64, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        let largest = x.iter().fold(0.0f64, |a, v| a.max(v.abs()));
        if self.n == 0 || largest == 0.0 {
            return;
        }
        let scaled: Vec<f32> = x.iter().map(|v| (v / largest) as f32).collect();
        let mut sum = vec![0.0; self.n];
        gemv(&self.data, self.n, &scaled, &mut sum);
        for (y, s) in y.iter_mut().zip(&sum) {
            *y = f64::from(*s) * (factor * self.scale * largest);
        }
    }

    /// The first `n` columns of Y ← A X, in one product.
    pub fn mul_columns(&self, x: &Dense, y: &mut Dense, n: usize) {
        let mut largest = vec![0.0f64; n];
        let mut scaled = vec![0.0f32; self.n * n];
        for (c, to) in scaled.chunks_exact_mut(self.n.max(1)).enumerate() {
            let from = x.col(c);
            largest[c] = from.iter().fold(0.0f64, |a, v| a.max(v.abs()));
            if largest[c] > 0.0 {
                for (to, v) in to.iter_mut().zip(from) {
                    *to = (v / largest[c]) as f32;
                }
            }
        }
        let mut sum = vec![0.0f32; self.n * n];
        multiply_single(&self.data, &scaled, &mut sum, (self.n, n));
        for (c, from) in sum.chunks_exact(self.n.max(1)).enumerate() {
            let size = self.scale * largest[c];
            for (y, s) in y.col_mut(c).iter_mut().zip(from) {
                *y = f64::from(*s) * size;
            }
        }
    }
}

#[cfg(test)]
#[path = "../../tests/linalg/single.rs"]
mod tests;
