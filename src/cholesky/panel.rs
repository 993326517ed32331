//! The memory layout of a front's panel: columns come in groups of four, and each group starts with the row of its
//! first pivot.
//!
//! Entries above the pivots are zero and are not stored, except for the triangles inside the groups. The columns of a
//! group have equal length: the kernels read four columns side by side.

/// Number of columns in a group.
pub const COLUMNS: usize = 4;

/// Start of the group whose first column is `j`, a multiple of four, in a panel of `size` rows.
pub fn group(j: usize, size: usize) -> usize {
    j * size - j * j.saturating_sub(COLUMNS) / 2
}

/// Length of a panel.
pub fn length(width: usize, size: usize) -> usize {
    let last = width / COLUMNS * COLUMNS;
    group(last, size) + (width - last) * (size - last)
}

/// Start of column `j`, and the row of its first entry.
pub fn column(j: usize, size: usize) -> (usize, usize) {
    let first = j / COLUMNS * COLUMNS;
    (group(first, size) + (j - first) * (size - first), first)
}

/// Where the pivot of column `j` is.
pub fn diagonal(j: usize, size: usize) -> usize {
    let (start, first) = column(j, size);
    start + j - first
}

/// Stores the first `size` rows of `width` columns that lie `stride` apart.
pub fn store(columns: &[f64], stride: usize, width: usize, size: usize, out: &mut [f64]) {
    for j in 0..width {
        let (start, first) = column(j, size);
        out[start..][..size - first].copy_from_slice(&columns[j * stride..][first..size]);
    }
}

#[cfg(test)]
#[path = "../../tests/inside/cholesky/panel.rs"]
mod tests;
