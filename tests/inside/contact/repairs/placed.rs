//! Unit tests of `src/contact/repairs/placed.rs`.

use super::*;

/// A row Σ a z ≤ b.
fn row(a: &[(u64, f64)]) -> MotionConstraint {
    a.iter().map(|&(m, x)| [m, x.to_bits()]).collect()
}

#[test]
fn bodies_go_to_the_nearest_place_without_violations() {
    // z₄ ≤ −1, z₄ + z₇ ≤ −4, z₇ ≤ 9: from 0 the nearest point is (−2, −2).
    let rows = [
        row(&[(4, 1.0)]),
        row(&[(4, 1.0), (7, 1.0)]),
        row(&[(7, 1.0)]),
    ];
    let given: Vec<(&MotionConstraint, f64)> = rows.iter().zip([-1.0, -4.0, 9.0]).collect();
    let found = least(&[4, 7], &given, &Tuning::DEFAULT).expect("they move");
    assert!(found.iter().all(|z| (z + 2.0).abs() < 1e-12), "{found:?}");
    // Without violations they stay.
    let given: Vec<(&MotionConstraint, f64)> = rows.iter().zip([0.0, 1.0, 9.0]).collect();
    assert!(least(&[4, 7], &given, &Tuning::DEFAULT).is_none());
}

#[test]
fn where_violations_stay_their_squares_are_least() {
    // z ≤ −1 twice as important as z ≥ 3, by two rows: (z + 1)² · 2 + (3 − z)² is least at 1/3.
    let rows = [row(&[(2, 1.0)]), row(&[(2, 1.0)]), row(&[(2, -1.0)])];
    let given: Vec<(&MotionConstraint, f64)> = rows.iter().zip([-1.0, -1.0, -3.0]).collect();
    let found = least(&[2], &given, &Tuning::DEFAULT).expect("it moves");
    assert!((found[0] - 1.0 / 3.0).abs() < 1e-6, "{found:?}");
}
