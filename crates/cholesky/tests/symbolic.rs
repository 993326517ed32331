//! Unit tests of `crates/cholesky/src/symbolic.rs`.

use super::*;

/// A grid of n x n blocks and its lines as sets, every other one first; block b has b mod 4 dofs, except that those
/// without dofs are in no set.
fn blocks(n: usize) -> (Csr, Vec<Vec<u32>>, Vec<usize>) {
    let at = |i: usize, j: usize| (i * n + j) as u32;
    let mut entries: Vec<(u32, u32, f64)> = Vec::new();
    for i in 0..n {
        for j in 0..n {
            entries.push((at(i, j), at(i, j), 1.0));
            let others = [(i + 1, j), (i, j + 1)].into_iter();
            for (k, l) in others.filter(|&(k, l)| k < n && l < n) {
                entries.extend([(at(i, j), at(k, l), 1.0), (at(k, l), at(i, j), 1.0)]);
            }
        }
    }
    let start: Vec<usize> = (0..=n * n).map(|b| (0..b).map(|b| b % 4).sum()).collect();
    let line = |i: usize| (0..n).map(move |j| at(i, j)).filter(|b| b % 4 > 0);
    let order = (0..n).step_by(2).chain((1..n).step_by(2));
    let sets = order.map(|i| line(i).collect()).collect();
    (Csr::from_triplets(n * n, &entries), sets, start)
}

#[test]
fn fronts_of_blocks_are_those_of_their_dofs() {
    let (graph, sets, start) = blocks(7);
    let dofs = |b: u32| start[b as usize]..start[b as usize + 1];
    let n = start[49];
    let by_blocks = Symbolic::with_blocks(&graph, &sets, n, dofs);
    // The same matrix dof by dof.
    let mut entries: Vec<(u32, u32, f64)> = Vec::new();
    for a in 0..49 {
        for &b in graph.row(a).0 {
            for i in dofs(a as u32) {
                entries.extend(dofs(b).map(|j| (i as u32, j as u32, 1.0)));
            }
        }
    }
    let of = |set: &Vec<u32>| {
        set.iter()
            .flat_map(|&b| dofs(b))
            .map(|d| d as u32)
            .collect()
    };
    let sets: Vec<Vec<u32>> = sets.iter().map(of).collect();
    let by_dofs = Symbolic::with_supernodes(&Csr::from_triplets(n, &entries), &[], &sets);
    assert_eq!(by_blocks.interior, by_dofs.interior);
    assert_eq!(by_blocks.position, by_dofs.position);
    assert_eq!(by_blocks.storage, by_dofs.storage);
    assert_eq!(by_blocks.fronts.len(), by_dofs.fronts.len());
    for (a, b) in by_blocks.fronts.iter().zip(&by_dofs.fronts) {
        assert_eq!((a.start, a.end, a.panel), (b.start, b.end, b.panel));
        assert_eq!((a.parent, &a.below), (b.parent, &b.below));
        assert_eq!(a.into_parent, b.into_parent);
    }
}
