//! Sparse rows with few columns, such as those of G: one row for every multiplier that this rank owns.

use mpi::topology::SimpleCommunicator;

use crate::linalg::dense::Dense;
use crate::parallel::exchange::{sum_all, Record};

/// An entry on its way to the rank that owns its row.
#[derive(Debug, Clone, Copy)]
pub struct RowEntry {
    /// Global row.
    pub row: u32,
    /// Column.
    pub col: u32,
    /// Value to be added.
    pub value: f64,
}

impl Record for RowEntry {
    const WORDS: usize = 2;
    fn pack(&self, out: &mut Vec<u64>) {
        out.extend([
            u64::from(self.row) << 32 | u64::from(self.col),
            self.value.to_bits(),
        ]);
    }
    fn unpack(w: &[u64]) -> Self {
        RowEntry {
            row: (w[0] >> 32) as u32,
            col: (w[0] & u64::from(u32::MAX)) as u32,
            value: f64::from_bits(w[1]),
        }
    }
}

/// Rows of a matrix with r columns, on the rank that owns them.
#[derive(Debug, Clone, Default)]
pub struct Rows {
    start: Vec<usize>,
    col: Vec<u32>,
    val: Vec<f64>,
}

impl Rows {
    /// From (row, column, value) entries, repeated ones added up.
    pub fn from_triplets(n: usize, mut entries: Vec<(u32, u32, f64)>) -> Rows {
        entries.sort_by_key(|e| (e.0, e.1));
        let mut rows = Rows {
            start: vec![0; n + 1],
            ..Rows::default()
        };
        for group in entries.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let sum: f64 = group.iter().map(|e| e.2).sum();
            if sum != 0.0 {
                rows.start[group[0].0 as usize + 1] += 1;
                rows.col.push(group[0].1);
                rows.val.push(sum);
            }
        }
        for i in 0..n {
            rows.start[i + 1] += rows.start[i];
        }
        rows
    }

    /// The entries of row `i`.
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.start[i]..self.start[i + 1];
        range.map(|k| (self.col[k] as usize, self.val[k]))
    }

    /// The columns and values of row `i`.
    pub fn entries(&self, i: usize) -> (&[u32], &[f64]) {
        let range = self.start[i]..self.start[i + 1];
        (&self.col[range.clone()], &self.val[range])
    }

    /// The columns of all entries.
    pub fn columns(&self) -> &[u32] {
        &self.col
    }

    /// Number of rows.
    pub fn n(&self) -> usize {
        self.start.len() - 1
    }

    /// Aᵀ B for matrices of r columns whose rows are distributed alike, over the rows that `chosen` selects.
    /// Collective.
    pub fn product(
        &self,
        comm: &SimpleCommunicator,
        b: &Rows,
        r: usize,
        chosen: impl Fn(usize) -> bool,
    ) -> Dense {
        let mut product = Dense::zeros(r, r);
        for i in (0..self.n()).filter(|&i| chosen(i)) {
            for (p, ap) in self.row(i) {
                for (q, bq) in b.row(i) {
                    product.data[p + q * r] += ap * bq;
                }
            }
        }
        sum_all(comm, &mut product.data);
        product
    }

    /// out ← out + Aᵀ λ, this rank's share.
    pub fn add_transpose(&self, lambda: &[f64], out: &mut [f64]) {
        for (i, &l) in lambda.iter().enumerate() {
            self.row(i).for_each(|(c, v)| out[c] += v * l);
        }
    }

    /// λ ← λ + α A x.
    pub fn add(&self, alpha: f64, x: &[f64], lambda: &mut [f64]) {
        for (i, l) in lambda.iter_mut().enumerate() {
            *l += alpha * self.row(i).map(|(c, v)| v * x[c]).sum::<f64>();
        }
    }

    /// Row i ← q_i · row i.
    pub fn scale_rows(&mut self, q: &[f64]) {
        for (i, &qi) in q.iter().enumerate() {
            let range = self.start[i]..self.start[i + 1];
            self.val[range].iter_mut().for_each(|v| *v *= qi);
        }
    }
}
