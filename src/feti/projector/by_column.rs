//! Motions by the columns in which they have coefficients: what a row does to many of them.

use super::column_map::ColumnMap;
use super::kernel_motion::KernelMotion;

/// Motions by the columns in which they have coefficients, as far as these are known here.
pub struct ByColumn {
    /// Where the entries of each column begin, and the end.
    start: Vec<usize>,
    /// (motion, coefficient).
    entries: Vec<(u32, f64)>,
}

impl ByColumn {
    /// Sorts the coefficients of motions.
    pub fn new<'a>(known: &ColumnMap, motions: impl Iterator<Item = &'a KernelMotion>) -> ByColumn {
        let mut all: Vec<(u32, u32, f64)> = Vec::new();
        for (m, motion) in (0..).zip(motions) {
            let here = motion.0.iter();
            all.extend(here.filter_map(|&(c, v)| known.here(c).map(|c| (c, m, v))));
        }
        all.sort_by_key(|e| (e.0, e.1));
        let mut start = vec![0; known.n() + 1];
        all.iter().for_each(|e| start[e.0 as usize + 1] += 1);
        for c in 0..known.n() {
            start[c + 1] += start[c];
        }
        ByColumn {
            start,
            entries: all.into_iter().map(|e| (e.1, e.2)).collect(),
        }
    }

    /// The coefficients of motions in a column: (motion, coefficient), by increasing motion.
    pub fn at(&self, column: u32) -> &[(u32, f64)] {
        &self.entries[self.start[column as usize]..self.start[column as usize + 1]]
    }

    /// The work of a row of G on each motion that it touches, by increasing number of the motion.
    pub fn works(&self, columns: &[u32], values: &[f64]) -> Vec<(usize, f64)> {
        let mut out: Vec<(usize, f64)> = Vec::new();
        for (&c, g) in columns.iter().zip(values) {
            out.extend(self.at(c).iter().map(|&(m, v)| (m as usize, g * v)));
        }
        out.sort_by_key(|e| e.0);
        out.chunk_by(|a, b| a.0 == b.0)
            .map(|w| (w[0].0, w.iter().map(|e| e.1).sum()))
            .collect()
    }
}
