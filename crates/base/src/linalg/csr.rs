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

    /// Replaces a diagonal entry, which is stored.
    pub fn set_diagonal(&mut self, i: usize, value: f64) {
        let range = self.row_ptr[i]..self.row_ptr[i + 1];
        let at = self.col[range.clone()].partition_point(|&j| (j as usize) < i);
        self.val[range][at] = value;
    }

    /// y ← A x.
    pub fn mul(&self, x: &[f64], y: &mut [f64]) {
        for (i, yi) in y.iter_mut().enumerate().take(self.n()) {
            let (col, val) = self.row(i);
            *yi = col.iter().zip(val).map(|(&j, &a)| a * x[j as usize]).sum();
        }
    }

    /// y ← y + factor A x, where A may be a block.
    pub fn add_mul(&self, factor: f64, x: &[f64], y: &mut [f64]) {
        for (i, y) in y.iter_mut().enumerate() {
            let (col, val) = self.row(i);
            let sum = col.iter().zip(val).map(|(&j, v)| v * x[j as usize]);
            *y += factor * sum.sum::<f64>();
        }
    }

    /// y ← y + factor Aᵀ x, where A may be a block.
    pub fn add_mul_transpose(&self, factor: f64, x: &[f64], y: &mut [f64]) {
        for (i, &x) in x.iter().enumerate().filter(|x| *x.1 != 0.0) {
            let (col, val) = self.row(i);
            let entries = col.iter().zip(val);
            entries.for_each(|(&j, v)| y[j as usize] += factor * v * x);
        }
    }

    /// Number of bytes held.
    pub fn bytes(&self) -> usize {
        8 * self.row_ptr.len() + 12 * self.col.len()
    }

    /// The rows and columns listed in `keep` (increasing), in that order.
    pub fn restricted(&self, keep: &[u32]) -> Csr {
        self.block(keep, keep)
    }

    /// The indices that `listed` leaves out, increasing.
    pub fn others(&self, listed: &[u32]) -> Vec<u32> {
        let mut others = vec![true; self.n()];
        listed.iter().for_each(|&i| others[i as usize] = false);
        (0..self.n() as u32)
            .filter(|&i| others[i as usize])
            .collect()
    }

    /// The block of these rows and columns, in this order. A column index is a position in `cols`.
    pub fn block(&self, rows: &[u32], cols: &[u32]) -> Csr {
        let mut place = vec![u32::MAX; self.n()];
        for (p, &j) in cols.iter().enumerate() {
            place[j as usize] = p as u32;
        }
        let mut out = Csr {
            row_ptr: vec![0],
            ..Csr::default()
        };
        for &i in rows {
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

    /// The sum of dense blocks: block b has rows and columns `lists[b]` and entries `value(b, i, j)`, where i and j are
    /// positions in its list. The blocks are added in their order.
    pub fn from_blocks(
        n: usize,
        lists: &[Vec<u32>],
        value: impl Fn(usize, usize, usize) -> f64,
    ) -> Csr {
        let mut rows: Vec<Vec<(u32, u32)>> = vec![Vec::new(); n];
        for (b, list) in (0..).zip(lists) {
            for (a, &i) in (0..).zip(list) {
                rows[i as usize].push((b, a));
            }
        }
        let mut out = Csr {
            row_ptr: vec![0],
            ..Csr::default()
        };
        // The last row in which each column was found, and its place in that row.
        let mut seen = vec![u32::MAX; n];
        let mut place = vec![0; n];
        for (i, blocks) in (0..).zip(&rows) {
            let start = out.col.len();
            for &(b, _) in blocks {
                for &j in &lists[b as usize] {
                    if seen[j as usize] != i {
                        seen[j as usize] = i;
                        out.col.push(j);
                    }
                }
            }
            out.col[start..].sort_unstable();
            for (p, &j) in (start..).zip(&out.col[start..]) {
                place[j as usize] = p;
            }
            out.val.resize(out.col.len(), 0.0);
            for &(b, a) in blocks {
                for (c, &j) in lists[b as usize].iter().enumerate() {
                    out.val[place[j as usize]] += value(b as usize, a as usize, c);
                }
            }
            out.row_ptr.push(out.col.len());
        }
        out
    }

    /// This matrix without entries that are zero.
    pub fn without_zeros(self) -> Csr {
        let mut out = Csr {
            row_ptr: vec![0],
            ..Csr::default()
        };
        for row in self.row_ptr.windows(2) {
            let entries = self.col[row[0]..row[1]]
                .iter()
                .zip(&self.val[row[0]..row[1]]);
            for (&j, &v) in entries.filter(|e| *e.1 != 0.0) {
                out.col.push(j);
                out.val.push(v);
            }
            out.row_ptr.push(out.col.len());
        }
        out
    }

    /// The matrix of `n` rows with the given (row, column, value) entries, repeated ones added up.
    ///
    /// Repeated entries are summed in the order in which they are given: the result does not depend on how the sort
    /// treats equal keys.
    pub fn from_triplets(n: usize, entries: &[(u32, u32, f64)]) -> Csr {
        let order = match entries.len() / n.max(1) {
            ..LONG => rows_sorted(n, entries),
            _ => rows_counted(n, entries),
        };
        let mut out = Csr {
            row_ptr: vec![0],
            ..Csr::default()
        };
        for row in order.start.windows(2) {
            let row = &order.entries[row[0]..row[1]];
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

/// Rows with more entries than this are sorted by counting. Counting passes twice through memory; comparison sorting
/// makes about log₂(length) passes.
const LONG: usize = 64;

/// Entries by row and column; entries at the same place keep their given order.
struct Ordered {
    /// Start of each row; length n + 1.
    start: Vec<usize>,
    /// Pairs (column, index of the entry).
    entries: Vec<(u32, u32)>,
}

/// Each row sorted.
fn rows_sorted(n: usize, entries: &[(u32, u32, f64)]) -> Ordered {
    let all = entries.iter().zip(0..).map(|(e, k)| (e.0, (e.1, k)));
    let mut out = Ordered::by_row(n, entries, all);
    for row in out.start.windows(2) {
        out.entries[row[0]..row[1]].sort_unstable();
    }
    out
}

/// Orders the entries by column, then deals them out to rows: each row is then sorted by column.
fn rows_counted(n: usize, entries: &[(u32, u32, f64)]) -> Ordered {
    let columns = entries.iter().map(|e| e.1 as usize + 1).max().unwrap_or(0);
    let mut next = starts(columns, entries.iter().map(|e| e.1));
    let mut by_column = vec![0u32; entries.len()];
    for (e, k) in entries.iter().zip(0..) {
        let at = &mut next[e.1 as usize];
        by_column[*at] = k;
        *at += 1;
    }
    let all = by_column.iter().map(|&k| {
        let e = &entries[k as usize];
        (e.0, (e.1, k))
    });
    Ordered::by_row(n, entries, all)
}

impl Ordered {
    /// Deals the entries listed in `all` out to their rows.
    fn by_row(
        n: usize,
        entries: &[(u32, u32, f64)],
        all: impl Iterator<Item = (u32, (u32, u32))>,
    ) -> Ordered {
        let start = starts(n, entries.iter().map(|e| e.0));
        let mut next = start.clone();
        let mut out = vec![(0, 0); entries.len()];
        for (row, entry) in all {
            let at = &mut next[row as usize];
            out[*at] = entry;
            *at += 1;
        }
        Ordered {
            start,
            entries: out,
        }
    }
}

/// Start of each of `n` lists, and the end of the last one, from the list number of each entry.
fn starts(n: usize, lists: impl Iterator<Item = u32>) -> Vec<usize> {
    let mut start = vec![0usize; n + 1];
    lists.for_each(|l| start[l as usize + 1] += 1);
    for i in 0..n {
        start[i + 1] += start[i];
    }
    start
}

#[cfg(test)]
#[path = "../../tests/linalg/csr.rs"]
mod tests;
