//! Unit tests of `crates/lab/src/assembled/cycles.rs`.

use super::*;

/// Rows given as (plus, minus, gap) on `n` unknowns.
fn rows(n: u64, list: &[(usize, usize, f64)]) -> Inequalities {
    let row = |&(plus, minus, gap): &(usize, usize, f64)| GapInequality { plus, minus, gap };
    Inequalities {
        unknowns: (0..n).collect(),
        rows: list.iter().map(row).collect(),
        ..Inequalities::default()
    }
}

/// Bᵀλ.
fn forces(rows: &Inequalities, lambda: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; rows.ground() + 1];
    for (row, l) in rows.rows.iter().zip(lambda) {
        out[row.plus] += l;
        out[row.minus] -= l;
    }
    out.pop();
    out
}

#[test]
fn the_row_with_the_largest_gap_leaves() {
    // w₁ ≤ w₀ + 2 follows from the two rows over w₂; unknown 4 is ground, and of two bounds the smaller one counts.
    let list = [
        (1, 0, 2.0),
        (2, 0, 0.5),
        (1, 2, 1.0),
        (3, 4, 0.3),
        (3, 4, 0.1),
    ];
    let rows = rows(4, &list);
    let before = vec![1.0, 2.0, 3.0, 4.0, 5.0];
    let mut lambda = before.clone();
    descend_around_cycles(&rows, &mut lambda);
    let right = [0.0, 3.0, 4.0, 0.0, 9.0];
    for (found, right) in lambda.iter().zip(right) {
        assert!((found - right).abs() < 1e-14, "{lambda:?}");
    }
    let (was, is) = (forces(&rows, &before), forces(&rows, &lambda));
    assert!(was.iter().zip(is).all(|(a, b)| (a - b).abs() < 1e-14));
}

#[test]
fn a_cross_point_keeps_a_tree() {
    // Four bodies around a point, each pushed by the one before: all rows with both signs, gaps that do not fit.
    let mut list = Vec::new();
    for k in 0..4 {
        list.push((k, (k + 1) % 4, 0.1 * (k + 1) as f64));
        list.push(((k + 1) % 4, k, 0.03 * k as f64));
    }
    let rows = rows(4, &list);
    let before = vec![1.0, 0.5, 2.0, 0.25, 1.5, 3.0, 0.75, 1.0];
    let mut lambda = before.clone();
    descend_around_cycles(&rows, &mut lambda);
    let cost = |lambda: &[f64]| -> f64 { list.iter().zip(lambda).map(|(r, l)| r.2 * l).sum() };
    assert!(lambda.iter().all(|l| *l >= 0.0));
    assert!(cost(&lambda) < cost(&before));
    assert!(
        lambda.iter().filter(|l| **l > 0.0).count() <= 3,
        "{lambda:?}"
    );
    let (was, is) = (forces(&rows, &before), forces(&rows, &lambda));
    assert!(was.iter().zip(is).all(|(a, b)| (a - b).abs() < 1e-13));
}

#[test]
fn what_fits_or_has_no_minimum_stays() {
    let fits = rows(3, &[(1, 0, 1.5), (2, 0, 0.5), (1, 2, 1.0)]);
    let mut lambda = vec![1.0, 2.0, 3.0];
    descend_around_cycles(&fits, &mut lambda);
    assert_eq!(lambda, [1.0, 2.0, 3.0]);
    // w₀ ≤ w₁ − 1 and w₁ ≤ w₀ + 0.5 contradict each other.
    let contradict = rows(2, &[(0, 1, -1.0), (1, 0, 0.5)]);
    let mut lambda = vec![1.0, 2.0];
    descend_around_cycles(&contradict, &mut lambda);
    assert_eq!(lambda, [1.0, 2.0]);
}
