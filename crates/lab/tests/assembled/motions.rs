//! Unit tests of `crates/lab/src/assembled/motions.rs`.

use super::*;

#[test]
fn equations_are_kept_while_they_are_independent() {
    let mut e = Echelon::default();
    assert!(e.insert(&vec![(0, 1.0), (1, 2.0)], 5.0));
    assert!(e.insert(&vec![(1, 1.0), (2, -1.0)], 1.0));
    assert!(!e.insert(&vec![(0, 1.0), (2, 2.0)], 3.0));
    assert_eq!(e.left(&vec![(0, 3.0), (1, 6.0)]), 0.0);
    assert!(e.left(&vec![(2, 1.0)]) > 0.1);
    assert!(e.insert(&vec![(0, 1.0), (1, 1.0)], 4.0));
    assert_eq!(e.rank(), 3);
    // α₀ + 2α₁ = 5, α₁ − α₂ = 1, α₀ + α₁ = 4.
    for (a, want) in e.solve(3).iter().zip([3.0, 1.0, 0.0]) {
        assert!((a - want).abs() < 1e-13, "{a} {want}");
    }
}

#[test]
fn candidates_complete_equations_firmly() {
    let mut e = Echelon::default();
    assert!(e.insert(&vec![(0, 1.0)], 0.0));
    let candidates = [
        (7, vec![(0, 1.0)]),
        (8, vec![(0, 1.0), (1, 1e-3)]),
        (9, vec![(1, 1.0), (2, 1.0)]),
        (10, vec![(1, 1.0), (2, -1.0)]),
    ];
    let chosen = e.complete(3, &candidates);
    let chosen: Vec<u64> = chosen.into_iter().map(|c| c.0).collect();
    assert_eq!(chosen, [9, 10]);
}
