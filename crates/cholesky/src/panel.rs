//! The memory layout of a front's panel: in the order in which a solve reads it.
//!
//! Columns come in groups of four. A group starts with the square of its pivots. The rows below follow in lots of
//! eight: the eight entries of the first column, those of the second, and so on. The last lot has what remains. So
//! the kernels read one stream, and the rows of a lot stand in vector registers while all columns meet them.
//!
//! ```text
//!     group   n² entries   l_jj l_j+1,j …           the square, column after column; above its diagonal: any values
//!             8 n          rows 1–8 of column 1, rows 1–8 of column 2, …
//!             8 n          rows 9–16 of column 1, …
//!             r n          the last r < 8 rows of column 1, …
//! ```
//!
//! Entries above the pivots are zero and are not stored, except for those in the squares.

/// Number of columns in a group.
pub const COLUMNS: usize = 4;

/// Number of rows in a lot: two vector registers of four numbers, or one of eight.
pub const LOT: usize = 8;

/// Start of the group whose first column is `j`, a multiple of four, in a panel of `size` rows.
pub fn group(j: usize, size: usize) -> usize {
    j * size - j * j.saturating_sub(COLUMNS) / 2
}

/// Length of a panel.
pub fn length(width: usize, size: usize) -> usize {
    let last = width / COLUMNS * COLUMNS;
    group(last, size) + (width - last) * (size - last)
}

/// Where the pivot of column `j` is, in a panel of `width` columns and `size` rows.
pub fn diagonal(j: usize, width: usize, size: usize) -> usize {
    let first = j / COLUMNS * COLUMNS;
    let n = COLUMNS.min(width - first);
    group(first, size) + (j - first) * (n + 1)
}

/// Where the entry of row `i` and column `j`, i ≥ j, is, in a panel of `width` columns and `size` rows.
pub fn entry(i: usize, j: usize, width: usize, size: usize) -> usize {
    let first = j / COLUMNS * COLUMNS;
    let n = COLUMNS.min(width - first);
    let (start, column) = (group(first, size), j - first);
    if i < first + n {
        return start + column * n + i - first;
    }
    let below = i - first - n;
    let lot = below / LOT * LOT;
    let rows = LOT.min(size - first - n - lot);
    start + n * n + lot * n + column * rows + below % LOT
}

/// Appends the first `size` rows of `width` columns that lie `stride` apart.
pub fn append(columns: &[f64], stride: usize, width: usize, size: usize, out: &mut Vec<f64>) {
    for j in (0..width).step_by(COLUMNS) {
        let n = COLUMNS.min(width - j);
        let column = |k: usize| &columns[k * stride + j..][..size - j];
        (j..j + n).for_each(|k| out.extend_from_slice(&column(k)[..n]));
        if n < COLUMNS {
            for row in (n..size - j).step_by(LOT) {
                let rows = row..(size - j).min(row + LOT);
                (j..j + n).for_each(|k| out.extend_from_slice(&column(k)[rows.clone()]));
            }
            continue;
        }
        // Whole lots have a length that the compiler knows.
        let lots = std::array::from_fn::<_, COLUMNS, _>(|k| column(j + k)[n..].chunks_exact(LOT));
        let rest = lots.clone().map(|of_column| of_column.remainder());
        let [a, b, c, d] = lots;
        for (((a, b), c), d) in a.zip(b).zip(c).zip(d) {
            let mut lot = [[0.0; LOT]; COLUMNS];
            for (to, from) in lot.iter_mut().zip([a, b, c, d]) {
                to.copy_from_slice(from);
            }
            out.extend_from_slice(lot.as_flattened());
        }
        rest.iter().for_each(|rows| out.extend_from_slice(rows));
    }
}

#[cfg(test)]
#[path = "../tests/panel.rs"]
mod tests;
