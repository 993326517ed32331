//! Unit tests of `src/feti/primal/matrix.rs`.

use super::*;

#[test]
fn sparse_and_dense_sums_and_triplets_are_the_same_matrix() {
    // Dofs 100..107 of two bodies, {0..4} and {4..7}; blocks that overlap, in any order of their dofs.
    let mut sent = [Blocks::default(), Blocks::default()];
    let block = |n: usize, s: f64| (0..n * n).map(move |k| s + (k as f64).sin());
    sent[0].push([103, 100, 101], block(3, 1.0));
    sent[0].push([104, 106], block(2, 2.0));
    sent[0].push([], block(0, 0.0));
    sent[1].push([101, 102], block(2, 3.0));
    sent[1].push([106, 105], block(2, 4.0));
    let mut matrix = PrimalMatrix::received(sent.to_vec(), 100, 7);
    matrix.shift(1, 10.0);
    matrix.shift(6, 20.0);
    let triplets = matrix.triplets();
    for body in [0..4, 4..7] {
        let (dense, sparse) = (matrix.dense(&body), matrix.sparse(&body));
        for (i, j) in (0..body.len()).flat_map(|i| (0..body.len()).map(move |j| (i, j))) {
            let at = |i: usize| (100 + body.start + i) as petsc::PetscInt;
            let here = triplets.iter().filter(|t| (t.0, t.1) == (at(i), at(j)));
            let sum: f64 = here.map(|t| t.2).sum();
            assert!((dense.get(i, j) - sum).abs() < 1e-14);
            assert!((sparse.get(i, j) - sum).abs() < 1e-14);
        }
    }
    assert!((0..4).all(|i| sparse_is_sorted(&matrix.sparse(&(0..4)), i)));
    assert_eq!(matrix.sparse(&(0..4)).get(0, 2), 0.0);
}

fn sparse_is_sorted(k: &Csr, i: usize) -> bool {
    k.row(i).0.windows(2).all(|w| w[0] < w[1])
}
