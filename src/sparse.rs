//! The one sparse matrix format that crosses module borders: square, symmetric in value, both triangles stored.

/// A square sparse matrix by compressed rows. Column indices are sorted and unique within a row; symmetric
/// matrices store both triangles, so that a product needs one pass.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Csr {
    /// Start of each row in `col` and `val`; length n + 1.
    pub row_ptr: Vec<usize>,
    /// Column of each entry.
    pub col: Vec<u32>,
    /// Value of each entry.
    pub val: Vec<f64>,
}

impl Csr {
    /// Number of rows (and columns).
    pub fn n(&self) -> usize {
        self.row_ptr.len().saturating_sub(1)
    }

    /// Number of stored entries.
    pub fn nnz(&self) -> usize {
        self.col.len()
    }

    /// The columns and values of row `i`.
    pub fn row(&self, i: usize) -> (&[u32], &[f64]) {
        let range = self.row_ptr[i]..self.row_ptr[i + 1];
        (&self.col[range.clone()], &self.val[range])
    }

    /// The entry (i, j), zero where none is stored.
    pub fn get(&self, i: usize, j: usize) -> f64 {
        let (col, val) = self.row(i);
        col.binary_search(&(j as u32)).map_or(0.0, |k| val[k])
    }

    /// The diagonal, zero where no entry is stored.
    pub fn diagonal(&self) -> Vec<f64> {
        (0..self.n()).map(|i| self.get(i, i)).collect()
    }

    /// y ← A x.
    pub fn mul(&self, x: &[f64], y: &mut [f64]) {
        for (i, yi) in y.iter_mut().enumerate().take(self.n()) {
            let (col, val) = self.row(i);
            *yi = col.iter().zip(val).map(|(&j, &a)| a * x[j as usize]).sum();
        }
    }

    /// The matrix with the given (row, column, value) entries, repeated ones added up.
    ///
    /// Entries are summed in the order in which they come, so that the result does not depend on how the
    /// sort treats equal keys.
    pub fn from_triplets(n: usize, triplets: &[(u32, u32, f64)]) -> Csr {
        let mut order: Vec<u32> = (0..triplets.len() as u32).collect();
        order.sort_by_key(|&k| {
            let (i, j, _) = triplets[k as usize];
            (i, j)
        });
        let mut out = Csr {
            row_ptr: vec![0; n + 1],
            col: Vec::with_capacity(triplets.len()),
            val: Vec::with_capacity(triplets.len()),
        };
        let mut last = None;
        for k in order {
            let (i, j, v) = triplets[k as usize];
            if last == Some((i, j)) {
                *out.val
                    .last_mut()
                    .expect("an entry was pushed for this key") += v;
            } else {
                out.col.push(j);
                out.val.push(v);
                out.row_ptr[i as usize + 1] += 1;
                last = Some((i, j));
            }
        }
        for i in 0..n {
            out.row_ptr[i + 1] += out.row_ptr[i];
        }
        out
    }
}
