//! The memory layout of an update, a lower triangle: strips of columns, each of them a matrix.
//!
//! A strip has the columns from `start` and the rows from `start` down, column after column. Products write it as they
//! write any matrix, where it stays until the parent takes it. Above its diagonal there are entries that nobody reads.

use std::ops::Range;

use faer::MatMut;

/// Number of columns of a strip: one is done in a millisecond in the largest fronts.
pub const STRIP: usize = 192;

/// Columns `start..start + columns` of the triangle, from row `start` down.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Strip {
    /// The first column, and the first row.
    pub start: usize,
    /// Number of columns.
    pub columns: usize,
    /// Number of rows.
    pub rows: usize,
    /// Where it begins.
    at: usize,
}

impl Strip {
    /// Strip number `k` of a triangle of this order.
    fn new(k: usize, order: usize) -> Strip {
        let start = k * STRIP;
        // The strips before it have order, order − STRIP, … rows.
        let at = STRIP * (k * order - STRIP * (k * k.saturating_sub(1) / 2));
        Strip {
            start,
            columns: STRIP.min(order - start),
            rows: order - start,
            at,
        }
    }

    fn range(self) -> Range<usize> {
        self.at..self.at + self.rows * self.columns
    }

    /// Its entries, to write.
    pub fn of(self, triangle: &mut [f64]) -> MatMut<'_, f64> {
        MatMut::from_column_major_slice_mut(&mut triangle[self.range()], self.rows, self.columns)
    }
}

/// The strips of a triangle of this order.
pub fn strips(order: usize) -> impl Iterator<Item = Strip> {
    (0..order.div_ceil(STRIP)).map(move |k| Strip::new(k, order))
}

/// Number of entries of a triangle of this order.
pub fn length(order: usize) -> usize {
    Strip::new(order / STRIP, order).range().end
}

/// The columns of a triangle of this order, each from its diagonal entry down.
pub fn columns(triangle: &[f64], order: usize) -> impl Iterator<Item = &[f64]> {
    strips(order).flat_map(|strip| {
        let all = triangle[strip.range()].chunks_exact(strip.rows);
        all.enumerate().map(|(j, column)| &column[j..])
    })
}

/// Column `j`, from its diagonal entry down, to write.
pub fn column_mut(triangle: &mut [f64], order: usize, j: usize) -> &mut [f64] {
    let strip = Strip::new(j / STRIP, order);
    let inside = j - strip.start;
    let column = &mut triangle[strip.at + inside * strip.rows..][..strip.rows];
    &mut column[inside..]
}

/// The triangle without the entries that nobody reads, for a message.
pub fn packed(triangle: &[f64], order: usize) -> Vec<f64> {
    let mut out = Vec::with_capacity(order * (order + 1) / 2);
    columns(triangle, order).for_each(|column| out.extend_from_slice(column));
    out
}

/// The triangle of a message.
pub fn unpacked(packed: &[f64], order: usize) -> Vec<f64> {
    let mut out = vec![0.0; length(order)];
    let mut rest = packed;
    for j in 0..order {
        let (column, after) = rest.split_at(order - j);
        column_mut(&mut out, order, j).copy_from_slice(column);
        rest = after;
    }
    out
}

#[cfg(test)]
#[path = "../../tests/inside/cholesky/strips.rs"]
mod tests;
