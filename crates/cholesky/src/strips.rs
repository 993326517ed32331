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

/// Column `j`, from its diagonal entry down, to write.
pub fn column_mut(triangle: &mut [f64], order: usize, j: usize) -> &mut [f64] {
    &mut triangle[column(order, j)]
}

fn column(order: usize, j: usize) -> Range<usize> {
    let strip = Strip::new(j / STRIP, order);
    let start = strip.at + (j - strip.start) * strip.rows;
    start + j - strip.start..start + strip.rows
}

/// An update that waits for the parent of its front. Lists may be longer than what they have.
#[derive(Debug)]
pub enum SchurUpdate {
    /// As its front has left it.
    Strips(Vec<f64>),
    /// As it goes in messages: column after column, each from its diagonal entry down.
    Packed(Vec<f64>),
}

impl Default for SchurUpdate {
    fn default() -> SchurUpdate {
        SchurUpdate::Strips(Vec::new())
    }
}

impl SchurUpdate {
    /// Column `j`, from its diagonal entry down.
    pub fn column(&self, order: usize, j: usize) -> &[f64] {
        match self {
            SchurUpdate::Strips(all) => &all[column(order, j)],
            SchurUpdate::Packed(all) => {
                let start = j * order - j * j.saturating_sub(1) / 2;
                &all[start..start + order - j]
            }
        }
    }

    /// The update as it goes in a message, for an `order` of the triangle.
    pub fn packed(&self, order: usize) -> Vec<f64> {
        let mut out = Vec::with_capacity(order * (order + 1) / 2);
        (0..order).for_each(|j| out.extend_from_slice(self.column(order, j)));
        out
    }

    /// Its memory.
    pub fn into_memory(self) -> Vec<f64> {
        let (SchurUpdate::Strips(all) | SchurUpdate::Packed(all)) = self;
        all
    }
}

/// Memory for `n` numbers, which may be longer and have any entries: of what is spare the shortest that suffices.
pub fn room_for(spare: &mut Vec<Vec<f64>>, n: usize) -> Vec<f64> {
    let suffices = (0..spare.len()).filter(|&i| spare[i].len() >= n);
    match suffices.min_by_key(|&i| spare[i].len()) {
        Some(i) => spare.swap_remove(i),
        None => {
            // The longest one makes room for it.
            let longest = (0..spare.len()).max_by_key(|&i| spare[i].len());
            longest.map(|i| spare.swap_remove(i));
            vec![0.0; n]
        }
    }
}

#[cfg(test)]
#[path = "../tests/strips.rs"]
mod tests;
