//! Unit tests of `src/feti/lifting/factor.rs`.

use super::*;
use crate::matrices::{distance, grid_laplacian, random};

/// The entries of K as blocks: each off-diagonal one with its mirror image, each diagonal one by itself.
fn parts(k: &Csr) -> (Vec<Vec<u32>>, Vec<Vec<f64>>) {
    let (mut lists, mut blocks) = (Vec::new(), Vec::new());
    for i in 0..k.n() {
        let (col, val) = k.row(i);
        for (&j, v) in col.iter().zip(val) {
            match j as usize {
                j if j == i => {
                    lists.push(vec![i as u32]);
                    blocks.push(vec![*v]);
                }
                j if j > i => {
                    lists.push(vec![i as u32, j as u32]);
                    blocks.push(vec![0.0, *v, 0.0]);
                }
                _ => {}
            }
        }
    }
    (lists, blocks)
}

fn both(k: &Csr) -> (Option<PartialCholesky>, Dense) {
    let (lists, blocks) = parts(k);
    let blocks: Vec<&[f64]> = blocks.iter().map(|b| &b[..]).collect();
    (
        sparse(k.n(), &lists, &blocks),
        dense(k.n(), &lists, &blocks),
    )
}

/// K with row and column `to` replaced by those of `from`, or by zero.
fn changed(k: &Csr, to: usize, from: Option<usize>) -> Csr {
    let source = |i: usize| if i == to { from } else { Some(i) };
    let entry = |i: usize, j: usize| Some(k.get(source(i)?, source(j)?));
    let pairs = (0..k.n()).flat_map(|i| (0..k.n()).map(move |j| (i, j)));
    let triplets: Vec<(u32, u32, f64)> = pairs
        .filter_map(|(i, j)| Some((i as u32, j as u32, entry(i, j)?)))
        .filter(|t| t.2 != 0.0 || t.0 == t.1)
        .collect();
    Csr::from_triplets(k.n(), &triplets)
}

#[test]
fn sparse_and_dense_factors_solve_alike_and_dependent_columns_are_left_to_the_dense_one() {
    let (k, _) = grid_laplacian(19, 17, 0.2);
    let (factor, a) = both(&k);
    let factor = factor.expect("regular, with many zeros");
    assert!((0..k.n()).all(|i| (0..k.n()).all(|j| a.get(i, j) == k.get(i, j))));
    let mut x = random(k.n(), 4);
    let mut y = x.clone();
    factor.solve(&mut x);
    Semidefinite::new(&a).solve(&mut y);
    let far = distance(&x, &y);
    assert!(far < 1e-12, "{far:.1e}");

    // A free body; two equal columns; a zero column; few columns.
    let refused = |k: &Csr| both(k).0.is_none();
    assert!(refused(&grid_laplacian(19, 17, 0.0).0));
    assert!(refused(&changed(&k, 5, Some(0))));
    assert!(refused(&changed(&k, 7, None)));
    assert!(refused(&grid_laplacian(9, 9, 0.2).0));
}
