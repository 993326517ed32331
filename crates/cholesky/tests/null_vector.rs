//! Unit tests of `crates/cholesky/src/null_vector.rs`.

use std::sync::Arc;

use super::super::multifrontal::PartialCholesky;
use super::super::symbolic::Symbolic;
use base::linalg::csr::Csr;

/// Springs between neighbours in a square of n × n points, without those that `cut` names.
fn springs(n: usize, cut: impl Fn(usize, usize) -> bool) -> Csr {
    let mut entries = Vec::new();
    let mut join = |a: usize, b: usize| {
        if !cut(a, b) {
            let (a, b) = (a as u32, b as u32);
            entries.extend([(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)]);
        }
    };
    for i in 0..n {
        for j in 0..n {
            let at = i * n + j;
            if i + 1 < n {
                join(at, at + n);
            }
            if j + 1 < n {
                join(at, at + 1);
            }
        }
    }
    // The first point is held.
    entries.push((0, 0, 1.0));
    Csr::from_triplets(n * n, &entries)
}

#[test]
fn parts_that_nothing_holds_move_alone() {
    let n = 14;
    // Two rows of points hang together and on nothing else, and so do the last three points of the last row.
    let part = |p: usize| match (p / n, p % n) {
        (6 | 7, _) => 1,
        (13, 11..) => 2,
        (8.., _) => 3,
        _ => 0,
    };
    let k = springs(n, |a, b| part(a) != part(b));
    let symbolic = Arc::new(Symbolic::new(&k, &[], None));
    let (factor, left) = PartialCholesky::semidefinite(&k, symbolic, 1e-10);
    let mut parts: Vec<usize> = left.iter().map(|&d| part(d as usize)).collect();
    parts.sort_unstable();
    assert_eq!(parts, [1, 2, 3]);
    for &dof in &left {
        let v = factor.null_vector(dof);
        // Every point of the part moves by one, and no other.
        let own: Vec<u32> = (0..(n * n) as u32)
            .filter(|&p| part(p as usize) == part(dof as usize))
            .collect();
        assert_eq!(v.iter().map(|e| e.0).collect::<Vec<u32>>(), own);
        let away = v.iter().fold(0.0f64, |a, e| a.max((e.1 - 1.0).abs()));
        assert!(away < 1e-12, "{away:.1e}");
    }
}
