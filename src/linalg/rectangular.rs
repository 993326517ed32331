//! A rectangular block of a sparse matrix.

use super::csr::Csr;

/// Compressed rows; a column index is a position in the list of columns from which the block was made.
#[derive(Debug, Clone, Default)]
pub struct Rectangular {
    row_ptr: Vec<usize>,
    col: Vec<u32>,
    val: Vec<f64>,
}

impl Rectangular {
    /// The entries of `k` in these rows and columns, in this order.
    pub fn block(k: &Csr, rows: &[u32], cols: &[u32]) -> Rectangular {
        let mut place = vec![u32::MAX; k.n()];
        for (p, &j) in cols.iter().enumerate() {
            place[j as usize] = p as u32;
        }
        let mut out = Rectangular {
            row_ptr: vec![0],
            ..Rectangular::default()
        };
        for &i in rows {
            let (col, val) = k.row(i as usize);
            let inside = col
                .iter()
                .zip(val)
                .filter(|e| place[*e.0 as usize] != u32::MAX);
            for (&j, &v) in inside {
                out.col.push(place[j as usize]);
                out.val.push(v);
            }
            out.row_ptr.push(out.col.len());
        }
        out
    }

    fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.row_ptr[i]..self.row_ptr[i + 1];
        let entries = self.col[range.clone()].iter().zip(&self.val[range]);
        entries.map(|(&j, &v)| (j as usize, v))
    }

    /// y ← y + factor A x.
    pub fn add_mul(&self, factor: f64, x: &[f64], y: &mut [f64]) {
        for (i, y) in y.iter_mut().enumerate() {
            *y += factor * self.row(i).map(|(j, v)| v * x[j]).sum::<f64>();
        }
    }

    /// y ← y + factor Aᵀ x.
    pub fn add_mul_transpose(&self, factor: f64, x: &[f64], y: &mut [f64]) {
        for (i, &x) in x.iter().enumerate() {
            if x != 0.0 {
                self.row(i).for_each(|(j, v)| y[j] += factor * v * x);
            }
        }
    }

    /// Number of bytes held.
    pub fn bytes(&self) -> usize {
        8 * self.row_ptr.len() + 12 * self.col.len()
    }
}
