//! Unit tests of `src/cholesky/panel.rs`.

use super::*;
use crate::linalg::dense::Dense;

#[test]
fn every_entry_below_the_diagonal_has_a_place_of_its_own() {
    for (width, more) in (1..=13).flat_map(|w| [0, 1, 9].map(|m| (w, m))) {
        let size = width + more;
        let mut dense = Dense::zeros(size + 2, width);
        for j in 0..width {
            for i in j..size + 2 {
                dense.set(i, j, (100 * j + i + 1) as f64);
            }
        }
        let mut out = vec![0.0; length(width, size)];
        store(&dense.data, size + 2, width, size, &mut out);
        for j in 0..width {
            let (start, first) = column(j, size);
            assert_eq!(out[diagonal(j, size)], dense.get(j, j));
            for i in first..size {
                assert_eq!(
                    out[start + i - first],
                    dense.get(i, j),
                    "{width} {size} {i} {j}"
                );
            }
        }
        let groups: usize = (0..width).map(|j| size - j / COLUMNS * COLUMNS).sum();
        assert_eq!(out.len(), groups);
    }
}
