//! Unit tests of `crates/cholesky/src/interior/graph.rs`.

use super::*;
use crate::matrices::{dense_of, grid_laplacian};

#[test]
fn counts_are_those_of_the_dense_factor_and_postordering_keeps_them() {
    let (k, _) = grid_laplacian(9, 7, 0.5);
    let inside: Vec<u32> = (0..k.n() as u32).collect();
    let graph = graph_of(&k, &inside);
    // A poor order with much fill: odd dofs first.
    let order: Vec<u32> = (0..63).map(|i| (i * 10) % 63).collect();
    let tree = Tree::new(&graph, order);
    let a = dense_of(&k);
    let permuted = faer::Mat::from_fn(63, 63, |i, j| {
        a[(tree.order[i] as usize, tree.order[j] as usize)]
    });
    let llt = permuted.llt(faer::Side::Lower).expect("definite");
    let count = |j: usize| (j..63).filter(|&i| llt.L()[(i, j)].abs() > 1e-14).count() as u32;
    let dense: Vec<u32> = (0..63).map(count).collect();
    assert_eq!(tree.counts(&graph), dense);
    let total: u32 = dense.iter().sum();
    let post = tree.postordered(&graph);
    assert_eq!(post.counts(&graph).iter().sum::<u32>(), total);
    let mut all = post.order.clone();
    all.sort_unstable();
    assert_eq!(all, inside);
    // Every parent comes right behind its last child's subtree.
    for (p, &q) in post.parent.iter().enumerate() {
        assert!(q == NONE || q as usize > p);
    }
}
