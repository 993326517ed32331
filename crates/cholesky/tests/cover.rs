//! Unit tests of `crates/cholesky/src/cover.rs`.

use super::*;
use crate::matrices::random;

/// The size of the smallest set that covers all edges, by trying all sets of left vertices.
fn exhaustive(edges: &[Vec<u32>], n_right: usize) -> usize {
    let sets = 0..1u32 << edges.len();
    let size = |set: u32| {
        let mut right = vec![false; n_right];
        for (_, of) in edges.iter().enumerate().filter(|(l, _)| set >> l & 1 == 0) {
            of.iter().for_each(|&r| right[r as usize] = true);
        }
        set.count_ones() as usize + right.iter().filter(|r| **r).count()
    };
    sets.map(size).min().expect("the empty set is one")
}

#[test]
fn covers_are_covers_and_smallest() {
    for seed in 0..200 {
        let (n, m) = (1 + seed % 9, 1 + seed * 7 % 11);
        let draw = random(n * m, seed as u64 + 1);
        let density = -0.9 + 0.15 * (seed % 8) as f64;
        let of = |l: usize| {
            (0..m)
                .filter(|r| draw[l * m + r] < density)
                .map(|r| r as u32)
                .collect()
        };
        let edges: Vec<Vec<u32>> = (0..n).map(of).collect();
        let (left, right) = smallest(&edges, m);
        for (l, of) in edges.iter().enumerate() {
            assert!(left[l] || of.iter().all(|&r| right[r as usize]), "{seed}");
        }
        let size = left.iter().chain(&right).filter(|c| **c).count();
        assert_eq!(size, exhaustive(&edges, m), "{seed}");
    }
}
