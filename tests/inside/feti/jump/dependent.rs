//! Unit tests of `src/feti/jump/dependent.rs`.

use super::*;

/// Rows between each two of three bodies: the third is the sum of the others, N = (1, 1, −1).
fn triangle() -> Dense {
    let rows = [[1.0, -1.0, 0.0], [0.0, 1.0, -1.0], [1.0, 0.0, -1.0]];
    Dense::from_fn(3, 3, |i, j| rows[i][j])
}

#[test]
fn contradictory_gaps_share_what_is_too_much() {
    let b = triangle();
    let near = |active: [bool; 3], c: [f64; 3], expected: [f64; 3]| {
        let found = consistent(&b, &active, &c);
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-14, "{c:?}: {found}");
        }
    };
    near([true; 3], [1.0, 2.0, 6.0], [2.0, 3.0, 5.0]);
    // Gaps that fit to rounding stay as they are, and a billionth is no rounding.
    let fitting = [0.1, 0.2, 0.1 + 0.2];
    assert_eq!(consistent(&b, &[true; 3], &fitting), fitting);
    let third = 1e-9 / 3.0;
    let less = [1.0 + third, 2.0 + third, 3.0 + 2.0 * third];
    near([true; 3], [1.0, 2.0, 3.0 + 1e-9], less);
    // Two of the rows contradict nothing.
    near([true, false, true], [1.0, 2.0, 6.0], [1.0, 2.0, 6.0]);
}

#[test]
fn a_row_follows_from_others_if_its_gap_does() {
    let b = triangle();
    let two = [true, true, false];
    assert_eq!(implied(&b, &two, &[1.0, 2.0, 3.0]), [2]);
    assert!(implied(&b, &two, &[1.0, 2.0, 3.5]).is_empty());
    assert!(implied(&b, &[true, false, false], &[1.0, 2.0, 3.0]).is_empty());
    assert!(implied(&b, &[false; 3], &[0.0; 3]).is_empty());
}
