//! Columns of multipliers as dense panels. The columns of one body touch the same rows: a product gathers these rows
//! once and goes through all columns of the body at the speed of a dense matrix.

use std::ops::Range;

use crate::feti::projector::sweep::MultiplierColumn;
use base::linalg::dense::Dense;

/// Consecutive columns with the same reach.
#[derive(Debug, Default)]
struct ColumnPanel {
    columns: Range<usize>,
    /// Owned rows with an entry in some column, increasing.
    rows: Vec<u32>,
    /// Rows × columns.
    values: Dense,
}

/// A matrix with this rank's rows of multipliers and a few columns for every body.
#[derive(Debug, Default)]
pub struct Panels {
    panels: Vec<ColumnPanel>,
    /// Number of columns.
    pub cols: usize,
}

impl Panels {
    /// The columns in the order that they come in.
    pub fn new(columns: &[MultiplierColumn]) -> Panels {
        let mut panels = Vec::new();
        let mut first = 0;
        for group in columns.chunk_by(|a, b| a.reach == b.reach) {
            panels.push(ColumnPanel::new(first, group));
            first += group.len();
        }
        Panels {
            panels,
            cols: columns.len(),
        }
    }

    /// out ← out + Aᵀ v, this rank's share.
    pub fn add_transpose(&self, v: &[f64], out: &mut [f64]) {
        let mut gathered = Vec::new();
        for panel in &self.panels {
            gathered.clear();
            gathered.extend(panel.rows.iter().map(|&i| v[i as usize]));
            let part = &mut out[panel.columns.clone()];
            panel.values.add_mul_transpose(&gathered, part);
        }
    }

    /// v ← v + α A c.
    pub fn add(&self, alpha: f64, c: &[f64], v: &mut [f64]) {
        let mut product = Vec::new();
        for panel in &self.panels {
            let c: Vec<f64> = c[panel.columns.clone()].iter().map(|c| alpha * c).collect();
            product.clear();
            product.resize(panel.rows.len(), 0.0);
            panel.values.add_mul(&c, &mut product);
            for (&i, p) in panel.rows.iter().zip(&product) {
                v[i as usize] += p;
            }
        }
    }

    /// out ← out + Aᵀ B on this rank's rows, placed at (`at`.0, `at`.1) of `out`.
    pub fn add_product(&self, other: &Panels, out: &mut Dense, at: (usize, usize)) {
        self.products(other, |a, b, part| {
            for (q, j) in other.columns(b).enumerate() {
                let column = &mut out.col_mut(at.1 + j)[at.0..];
                let sums = column[self.columns(a)].iter_mut().zip(part.col(q));
                sums.for_each(|(o, p)| *o += p);
            }
        });
    }

    /// AᵀB on this rank's rows: calls `visit(a, b, block)` for every panel a and every panel b of `other` that have a
    /// row in common, by increasing a and b. Panels without common rows cost nothing.
    pub fn products(&self, other: &Panels, mut visit: impl FnMut(usize, usize, &Dense)) {
        let places = other.places();
        let rows_of = |p: &ColumnPanel| {
            Dense::from_fn(p.values.cols, p.rows.len(), |j, i| p.values.get(i, j))
        };
        let right: Vec<Dense> = other.panels.iter().map(rows_of).collect();
        // The blocks of one panel, and which of them are in use.
        let mut blocks: Vec<Dense> = vec![Dense::default(); other.panels.len()];
        let mut used: Vec<usize> = Vec::new();
        for (a, panel) in self.panels.iter().enumerate() {
            let left = rows_of(panel);
            for (here, &row) in panel.rows.iter().enumerate() {
                for &(b, at) in places.get(row as usize).into_iter().flatten() {
                    let (x, y) = (left.col(here), right[b as usize].col(at as usize));
                    let block = &mut blocks[b as usize];
                    if block.data.is_empty() {
                        *block = Dense::zeros(x.len(), y.len());
                        used.push(b as usize);
                    }
                    for (column, y) in block.data.chunks_exact_mut(x.len()).zip(y) {
                        column.iter_mut().zip(x).for_each(|(c, x)| *c += x * y);
                    }
                }
            }
            used.sort_unstable();
            for b in used.drain(..) {
                visit(a, b, &std::mem::take(&mut blocks[b]));
            }
        }
    }

    /// The columns of panel `k`.
    pub fn columns(&self, k: usize) -> Range<usize> {
        self.panels[k].columns.clone()
    }

    /// Where the columns of every panel begin, and the end.
    pub fn starts(&self) -> Vec<usize> {
        let starts = self.panels.iter().map(|p| p.columns.start);
        starts.chain([self.cols]).collect()
    }

    /// For every row the panels that have it, and where.
    fn places(&self) -> Vec<Vec<(u32, u32)>> {
        let last = self.panels.iter().filter_map(|p| p.rows.last()).max();
        let mut places = vec![Vec::new(); last.map_or(0, |&row| row as usize + 1)];
        for (b, panel) in (0..).zip(&self.panels) {
            for (at, &row) in (0..).zip(&panel.rows) {
                places[row as usize].push((b, at));
            }
        }
        places
    }
}

impl ColumnPanel {
    fn new(first: usize, columns: &[MultiplierColumn]) -> ColumnPanel {
        let all = || columns.iter().flat_map(|c| &c.entries);
        // The rows are marked in a table, not sorted: the columns have thousands of entries and mostly the same rows.
        const NONE: u32 = u32::MAX;
        let end = all().map(|e| e.0 as usize + 1).max().unwrap_or(0);
        let mut place = vec![NONE; end];
        all().for_each(|e| place[e.0 as usize] = 0);
        let mut rows = Vec::new();
        for (row, place) in place.iter_mut().enumerate().filter(|p| *p.1 != NONE) {
            *place = rows.len() as u32;
            rows.push(row as u32);
        }
        let mut values = Dense::zeros(rows.len(), columns.len());
        for (c, column) in columns.iter().enumerate() {
            let out = values.col_mut(c);
            for &(row, value) in &column.entries {
                out[place[row as usize] as usize] += value;
            }
        }
        ColumnPanel {
            columns: first..first + columns.len(),
            rows,
            values,
        }
    }
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/deflation/panels.rs"]
mod tests;
