//! Columns of multipliers as dense panels. The columns of one body touch the same rows: a product gathers these rows
//! once and goes through all columns of the body at the speed of a dense matrix.

use std::ops::Range;

use crate::feti::projector::sweep::Column;
use crate::linalg::dense::{multiply, Dense};

/// Consecutive columns with the same reach.
#[derive(Debug, Default)]
struct Panel {
    columns: Range<usize>,
    /// Owned rows with an entry in some column, increasing.
    rows: Vec<u32>,
    /// Rows × columns.
    values: Dense,
}

/// A matrix with this rank's rows of multipliers and a few columns for every body.
#[derive(Debug, Default)]
pub struct Panels {
    panels: Vec<Panel>,
    /// Number of columns.
    pub cols: usize,
}

impl Panels {
    /// The columns in the order that they come in.
    pub fn new(columns: &[Column]) -> Panels {
        let mut panels = Vec::new();
        let mut first = 0;
        for group in columns.chunk_by(|a, b| a.reach == b.reach) {
            panels.push(Panel::new(first, group));
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
        for a in &self.panels {
            for b in &other.panels {
                let common = b.gather(&a.rows);
                if common.data.is_empty() {
                    continue;
                }
                let mut part = Dense::zeros(a.values.cols, common.cols);
                let left = a.values.view().transpose();
                multiply(part.view_mut(), false, 1.0, left, common.view());
                for (q, j) in b.columns.clone().enumerate() {
                    let column = &mut out.col_mut(at.1 + j)[at.0..];
                    let sums = column[a.columns.clone()].iter_mut().zip(part.col(q));
                    sums.for_each(|(o, p)| *o += p);
                }
            }
        }
    }
}

impl Panel {
    fn new(first: usize, columns: &[Column]) -> Panel {
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
        Panel {
            columns: first..first + columns.len(),
            rows,
            values,
        }
    }

    /// These rows of all columns, with zeros in rows that the panel does not have. The matrix is empty if the panel has
    /// none of the rows.
    fn gather(&self, rows: &[u32]) -> Dense {
        let mut pairs = Vec::new();
        let mut at = 0;
        for (i, row) in rows.iter().enumerate() {
            while at < self.rows.len() && self.rows[at] < *row {
                at += 1;
            }
            if self.rows.get(at) == Some(row) {
                pairs.push((i, at));
            }
        }
        if pairs.is_empty() {
            return Dense::default();
        }
        let mut out = Dense::zeros(rows.len(), self.values.cols);
        for c in 0..out.cols {
            let (from, to) = (self.values.col(c), out.col_mut(c));
            pairs.iter().for_each(|&(i, at)| to[i] = from[at]);
        }
        out
    }
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/deflation/panels.rs"]
mod tests;
