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

    /// The rows and columns listed in `keep` (increasing), in that order.
    pub fn restricted(&self, keep: &[u32]) -> Csr {
        let mut place = vec![u32::MAX; self.n()];
        for (p, &i) in keep.iter().enumerate() {
            place[i as usize] = p as u32;
        }
        let mut out = Csr {
            row_ptr: vec![0],
            ..Csr::default()
        };
        for &i in keep {
            let (col, val) = self.row(i as usize);
            for (&j, &v) in col.iter().zip(val) {
                if place[j as usize] != u32::MAX {
                    out.col.push(place[j as usize]);
                    out.val.push(v);
                }
            }
            out.row_ptr.push(out.col.len());
        }
        out
    }

    /// The matrix with the given (row, column, value) entries, repeated ones added up.
    ///
    /// Entries are summed in the order in which they come, so that the result does not depend on how the
    /// sort treats equal keys.
    pub fn from_triplets(n: usize, entries: &[(u32, u32, f64)]) -> Csr {
        let mut start = vec![0usize; n + 1];
        entries.iter().for_each(|e| start[e.0 as usize + 1] += 1);
        for i in 0..n {
            start[i + 1] += start[i];
        }
        let mut next = start.clone();
        let mut order = vec![(0u32, 0u32); entries.len()];
        for (k, e) in entries.iter().enumerate() {
            let at = &mut next[e.0 as usize];
            order[*at] = (e.1, k as u32);
            *at += 1;
        }
        let mut out = Csr {
            row_ptr: vec![0],
            ..Csr::default()
        };
        for i in 0..n {
            let row = &mut order[start[i]..start[i + 1]];
            row.sort_unstable();
            for (p, &(j, k)) in row.iter().enumerate() {
                let value = entries[k as usize].2;
                if p > 0 && row[p - 1].0 == j {
                    *out.val.last_mut().expect("an entry came before") += value;
                } else {
                    out.col.push(j);
                    out.val.push(value);
                }
            }
            out.row_ptr.push(out.col.len());
        }
        out
    }
}
