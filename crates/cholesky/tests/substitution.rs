//! Unit tests of `crates/cholesky/src/substitution.rs`.

use crate::matrices::random;
use crate::panel;
use crate::sweep::{eliminate, substitute};

/// The columns of a panel with `width` columns and `size` rows and a large diagonal.
fn columns(width: usize, size: usize) -> Vec<f64> {
    let mut columns = random(width * size, (width + 31 * size) as u64);
    (0..width).for_each(|j| columns[j * size + j] += 3.0);
    columns
}

#[test]
fn panels_of_every_width_are_solved_with() {
    for (width, below) in (1..=9).flat_map(|w| [0, 1, 7, 8, 21].map(|b| (w, b))) {
        let size = width + below;
        let columns = columns(width, size);
        let l = |i: usize, j: usize| columns[j * size + i];
        let mut panel = Vec::new();
        panel::append(&columns, size, width, size, &mut panel);
        let start = random(size, 5);

        let mut work = start.clone();
        eliminate(&panel, width, &mut work);
        for i in 0..size {
            let known: f64 = (0..width.min(i + 1)).map(|j| l(i, j) * work[j]).sum();
            let expected = if i < width { known } else { known + work[i] };
            assert!((expected - start[i]).abs() < 1e-13, "{width} {below} {i}");
        }

        let mut work = start.clone();
        substitute(&panel, width, &mut work);
        assert_eq!(work[width..], start[width..]);
        for (j, b) in start.iter().enumerate().take(width) {
            let product: f64 = (j..size).map(|i| l(i, j) * work[i]).sum();
            assert!((product - b).abs() < 1e-13, "{width} {below} {j}");
        }
    }
}
