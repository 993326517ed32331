//! Unit tests of `crates/cholesky/src/panel.rs`.

use super::*;

/// The entries (row, column) of a panel in the order of memory.
fn order(width: usize, size: usize) -> Vec<(usize, usize)> {
    let mut order = Vec::new();
    for j in (0..width).step_by(COLUMNS) {
        let columns = j..width.min(j + COLUMNS);
        let square: Vec<usize> = columns.clone().collect();
        let below: Vec<usize> = (columns.end..size).collect();
        for rows in [&square[..]].into_iter().chain(below.chunks(LOT)) {
            order.extend(
                columns
                    .clone()
                    .flat_map(|j| rows.iter().map(move |&i| (i, j))),
            );
        }
    }
    order
}

#[test]
fn squares_come_first_and_rows_in_lots() {
    for (width, more) in (1..=13).flat_map(|w| [0, 1, 8, 9, 23].map(|m| (w, m))) {
        let (size, stride) = (width + more, width + more + 2);
        let value = |i: usize, j: usize| (100 * j + i + 1) as f64;
        let columns: Vec<f64> = (0..width)
            .flat_map(|j| (0..stride).map(move |i| value(i, j)))
            .collect();
        let mut out = Vec::new();
        append(&columns, stride, width, size, &mut out);
        let expected: Vec<f64> = order(width, size)
            .iter()
            .map(|&(i, j)| value(i, j))
            .collect();
        assert_eq!(out, expected, "{width} {size}");
        assert_eq!(out.len(), length(width, size));
        for j in 0..width {
            assert_eq!(out[diagonal(j, width, size)], value(j, j));
        }
        for j in (0..width).step_by(COLUMNS) {
            assert_eq!(out[group(j, size)], value(j, j));
        }
    }
}
