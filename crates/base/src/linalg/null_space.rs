//! The vectors that a small dense matrix maps to zero.

use std::ops::Range;

/// A basis of the null space of a matrix of `n` columns, given by rows: an entry per column in each vector.
///
/// Columns of earlier `groups` are eliminated before those of later ones, in each the largest entry first. A vector has
/// the entry 1 at its own free column, 0 at the other free ones, and its other entries are in columns that were
/// eliminated. The vectors are listed by increasing free column. What is left of a column counts as zero up to `zero`.
pub fn null_space(
    mut rows: Vec<Vec<f64>>,
    groups: &[Range<usize>],
    zero: f64,
) -> Vec<(usize, Vec<f64>)> {
    let n = groups.last().map_or(0, |g| g.end);
    let mut pivot_of_row: Vec<usize> = Vec::new();
    let mut eliminated = vec![false; n];
    for group in groups {
        loop {
            let done = pivot_of_row.len();
            let mut best = (zero, None);
            for (i, row) in rows.iter().enumerate().skip(done) {
                for j in group.clone().filter(|&j| !eliminated[j]) {
                    if row[j].abs() > best.0 {
                        best = (row[j].abs(), Some((i, j)));
                    }
                }
            }
            let Some((i, j)) = best.1 else { break };
            rows.swap(done, i);
            let pivot = rows[done][j];
            rows[done].iter_mut().for_each(|v| *v /= pivot);
            let by = rows[done].clone();
            for (k, row) in rows.iter_mut().enumerate() {
                let factor = row[j];
                if k != done && factor != 0.0 {
                    row.iter_mut().zip(&by).for_each(|(v, b)| *v -= factor * b);
                }
            }
            eliminated[j] = true;
            pivot_of_row.push(j);
        }
    }
    let free = (0..n).filter(|&j| !eliminated[j]);
    free.map(|f| {
        let mut x = vec![0.0; n];
        x[f] = 1.0;
        for (row, &j) in rows.iter().zip(&pivot_of_row) {
            x[j] = -row[f];
        }
        (f, x)
    })
    .collect()
}

#[cfg(test)]
#[path = "../../tests/linalg/null_space.rs"]
mod tests;
