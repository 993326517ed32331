//! Unit tests of `crates/cholesky/src/front.rs`.

use super::*;
use crate::matrices::random;
use crate::strips::{self, SchurUpdate};

/// Factors a panel with these diagonal entries, and computes its update.
type How = fn(&mut Dense, &mut [f64], &[f64], f64, &mut Scratch) -> Vec<usize>;

/// A front of w columns of a positive definite matrix of n rows, and room for its update.
fn dense_front(n: usize, w: usize) -> (Dense, Vec<f64>) {
    let a = random(n * n, 3);
    let product = |i: usize, j: usize| {
        let rows = (0..n).map(|k| a[i * n + k] * a[j * n + k]);
        rows.sum::<f64>() + if i == j { 1.0 } else { 0.0 }
    };
    let panel = Dense::from_fn(n, w, |i, j| if i < j { 0.0 } else { product(i, j) });
    // What the memory has had before must not count.
    (panel, vec![f64::NAN; strips::length(n - w)])
}

#[test]
fn a_front_at_once_and_by_groups_are_the_same() {
    for (n, w) in [(60, 60), (130, 100), (260, 97), (70, 3), (600, 150)] {
        let (panel, update) = dense_front(n, w);
        let diagonal: Vec<f64> = (0..w).map(|j| panel.get(j, j)).collect();
        let run = |how: How| {
            let (mut panel, mut update) = (panel.clone(), update.clone());
            let scratch = &mut Scratch::default();
            let weak = how(&mut panel, &mut update, &diagonal, 1e-12, scratch);
            (panel, update, weak)
        };
        let (at_once, left, none) =
            run(|p, u, d, least, s| factor_semidefinite(p, u, d, least, s, &mut || ()));
        let (by_groups, left_by_groups, none_either) = run(factor_by_groups);
        assert!(none.is_empty() && none_either.is_empty());
        let largest = panel.data.iter().fold(0.0f64, |a, v| a.max(v.abs()));
        for j in 0..w {
            for i in j..n {
                let error = (at_once.get(i, j) - by_groups.get(i, j)).abs();
                assert!(error < 1e-12 * largest, "{n}, {w}: {error:.1e}");
            }
        }
        let (left, other) = (
            SchurUpdate::Strips(left),
            SchurUpdate::Strips(left_by_groups),
        );
        let columns = (0..n - w).map(|j| [&left, &other].map(|u| u.column(n - w, j)));
        for (a, b) in columns.flat_map(|[a, b]| a.iter().zip(b)) {
            let error = (a - b).abs();
            assert!(error < 1e-12 * largest, "{n}, {w}: {error:.1e}");
        }
    }
}

#[test]
fn columns_that_repeat_are_left_out_of_a_wide_front() {
    // Columns 70 and 110 repeat 5 and 60, which are in other groups.
    let (n, twins) = (120, [(70, 5), (110, 60)]);
    let of = |i: usize| twins.iter().find(|t| t.0 == i).map_or(i, |t| t.1);
    let (whole, _) = dense_front(n, n);
    let entry = |i: usize, j: usize| {
        let (i, j) = (of(i).max(of(j)), of(i).min(of(j)));
        whole.get(i, j)
    };
    let mut panel = Dense::from_fn(n, n, |i, j| if i < j { 0.0 } else { entry(i, j) });
    let diagonal: Vec<f64> = (0..n).map(|j| panel.get(j, j)).collect();
    let scratch = &mut Scratch::default();
    let weak = factor_semidefinite(&mut panel, &mut [], &diagonal, 1e-10, scratch, &mut || ());
    assert_eq!(weak, [70, 110]);
    // L Lᵀ is the matrix in the other columns.
    for j in (0..n).filter(|&j| of(j) == j) {
        for i in (j..n).filter(|&i| of(i) == i) {
            let sum: f64 = (0..=j).map(|k| panel.get(i, k) * panel.get(j, k)).sum();
            assert!((sum - entry(i, j)).abs() < 1e-11 * diagonal[i].max(diagonal[j]));
        }
    }
}
