//! Unit tests of `src/contact/repairs/dependent.rs`.

use super::*;

/// cᵀN below this is rounding.
const LEVEL: f64 = 1e-12;

/// The rows between bodies that meet at one node, in a grid of 2 × 2 or 2 × 2 × 2 bodies.
fn grid(dim: usize) -> Dense {
    let n = 1usize << dim;
    let pairs: Vec<[usize; 2]> = (0..n)
        .flat_map(|i| (0..dim).map(move |d| [i, i | 1 << d]))
        .filter(|[i, j]| i != j)
        .collect();
    Dense::from_fn(pairs.len(), n, |r, j| match pairs[r] {
        [one, _] if one == j => 1.0,
        [_, other] if other == j => -1.0,
        _ => 0.0,
    })
}

/// Bᵀλ.
fn forces(b: &Dense, lambda: &[f64]) -> Vec<f64> {
    let force = |j: usize| (0..b.rows).map(|r| b.get(r, j) * lambda[r]).sum();
    (0..b.cols).map(force).collect()
}

fn work(c: &[f64], lambda: &[f64]) -> f64 {
    c.iter().zip(lambda).map(|(c, l)| c * l).sum()
}

/// Numbers in [0, 1) that follow no pattern.
fn scattered(n: usize, seed: f64) -> Vec<f64> {
    (1..=n)
        .map(|k| (seed * 17.3 + k as f64 * 7.77).sin().abs())
        .collect()
}

#[test]
fn one_row_of_a_cross_point_leaves() {
    // Rows (0,1), (0,2), (1,3), (2,3): N = (1, −1, 1, −1).
    let b = grid(2);
    let n = [1.0, -1.0, 1.0, -1.0];
    assert_eq!(forces(&b, &n), [0.0; 4]);
    for seed in 1..50 {
        let (c, before) = (
            scattered(4, f64::from(seed)),
            scattered(4, 0.5 + f64::from(seed)),
        );
        let mut after = before.clone();
        ratio_test_descent_at_node(&b, &[Law::Unilateral; 4], &c, &mut after, LEVEL);
        let sign = -work(&c, &n).signum();
        let furthest = (0..4)
            .filter(|&r| sign * n[r] < 0.0)
            .map(|r| before[r])
            .fold(f64::INFINITY, f64::min);
        for r in 0..4 {
            assert!((after[r] - before[r] - sign * furthest * n[r]).abs() < 1e-13);
        }
        assert!(after.contains(&0.0));
    }
}

#[test]
fn the_forces_stay_and_the_dual_energy_rises() {
    let b = grid(3);
    for seed in 1..50 {
        let (c, before) = (
            scattered(12, f64::from(seed)),
            scattered(12, 0.3 + f64::from(seed)),
        );
        let mut after = before.clone();
        ratio_test_descent_at_node(&b, &[Law::Unilateral; 12], &c, &mut after, LEVEL);
        for (now, was) in forces(&b, &after).iter().zip(forces(&b, &before)) {
            assert!((now - was).abs() < 1e-12);
        }
        assert!(after.iter().all(|l| *l >= 0.0));
        assert!(work(&c, &after) <= work(&c, &before) + 1e-12);
        // Eight bodies are held together by seven rows: five of twelve have left.
        assert!(after.iter().filter(|l| **l > 0.0).count() <= 7);
    }
}

#[test]
fn gaps_that_fit_leave_the_rows_alone() {
    let b = grid(2);
    let before = scattered(4, 3.0);
    for c in [vec![0.0; 4], vec![0.1, 0.3, 0.5, 0.3]] {
        let mut after = before.clone();
        ratio_test_descent_at_node(&b, &[Law::Unilateral; 4], &c, &mut after, LEVEL);
        assert_eq!(after, before);
    }
    // Ties have multipliers of both signs and never leave.
    let mut after = vec![-1.0, 2.0, 0.5, 0.5];
    ratio_test_descent_at_node(
        &b,
        &[Law::Tie, Law::Unilateral, Law::Unilateral, Law::Unilateral],
        &[1.0, 0.0, 0.0, 0.0],
        &mut after,
        LEVEL,
    );
    assert!(
        (after[0] + 1.5).abs() < 1e-13 && after[2] == 0.0,
        "{after:?}"
    );
}
