//! Unit tests of `crates/base/src/linalg/csr.rs`.

use super::*;

#[test]
fn blocks_are_added_up() {
    let lists = [vec![3, 0, 1], vec![4, 3], vec![], vec![1]];
    let value = |b: usize, i: usize, j: usize| (1 + b * 9 + i * 3 + j) as f64;
    let a = Csr::from_blocks(6, &lists, value);
    let mut triplets = Vec::new();
    for (b, list) in lists.iter().enumerate() {
        for (i, &row) in list.iter().enumerate() {
            let entry = |(j, &col): (usize, &u32)| (row, col, value(b, i, j));
            triplets.extend(list.iter().enumerate().map(entry));
        }
    }
    assert_eq!(a, Csr::from_triplets(6, &triplets));
}

#[test]
fn sorted_and_counted_rows_are_the_same_and_add_up_what_is_repeated() {
    let n = 7;
    let draw = |k: u32| k.wrapping_mul(2_654_435_761) >> 7;
    let entries: Vec<(u32, u32, f64)> = (0..400)
        .map(|k| {
            (
                draw(k) % 6,
                draw(k + 1000) % 7,
                f64::from(draw(k + 2000) % 100),
            )
        })
        .collect();
    let [sorted, counted] = [rows_sorted(n, &entries), rows_counted(n, &entries)];
    assert_eq!(sorted.start, counted.start);
    assert_eq!(sorted.entries, counted.entries);
    for few in [&entries[..20], &entries[..]] {
        let a = Csr::from_triplets(n, few);
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let here = few
                .iter()
                .filter(|e| (e.0 as usize, e.1 as usize) == (i, j));
            assert_eq!(a.get(i, j), here.map(|e| e.2).sum::<f64>());
        }
        assert!((0..n).all(|i| a.row(i).0.is_sorted()));
    }
}

/// Long rows are sorted by counting, short ones by comparison; columns may be more than rows.
#[test]
fn rows_may_be_longer_than_columns_are_high() {
    for n in [2u32, 400] {
        let entries: Vec<(u32, u32, f64)> = (0..2 * n)
            .map(|k| (k % 2, (n - 1) - k / 2, f64::from(k) - 1.0))
            .collect();
        let a = Csr::from_triplets(2, &entries).without_zeros();
        assert_eq!(a.row_ptr, [0, n as usize, 2 * n as usize - 1]);
        for i in 0..2 {
            let (col, val) = a.row(i);
            assert!(col.windows(2).all(|c| c[0] < c[1]));
            for (&j, &v) in col.iter().zip(val) {
                assert_eq!(v, f64::from(2 * (n - 1 - j)) + i as f64 - 1.0);
            }
        }
    }
}
