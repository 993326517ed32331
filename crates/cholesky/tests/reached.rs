//! Unit tests of `crates/cholesky/src/reached.rs`.

use super::*;
use crate::matrices::{distance, random};
use crate::symbolic::Symbolic;
use base::linalg::csr::Csr;
use std::sync::Arc;

/// The five-point matrix of a square of n² dofs, a little stiffer than the Laplacian.
fn square(n: usize) -> Csr {
    let mut entries = Vec::new();
    for i in 0..n * n {
        entries.push((i as u32, i as u32, 4.1));
        let right = (i % n + 1 < n).then_some(i + 1);
        let above = (i + n < n * n).then_some(i + n);
        for j in right.into_iter().chain(above) {
            entries.push((i as u32, j as u32, -1.0));
            entries.push((j as u32, i as u32, -1.0));
        }
    }
    Csr::from_triplets(n * n, &entries)
}

/// Loads and solutions at some dofs are those of the whole solve, with one column and with several.
#[test]
fn some_dofs_have_what_the_whole_solve_has() {
    let n = 23;
    let k = square(n);
    let border: Vec<u32> = (0..n as u32).collect();
    let (factor, _) = PartialCholesky::new(&k, Arc::new(Symbolic::new(&k, &border, None)))
        .expect("a positive definite matrix");
    // The side opposite the border, and a dof in the middle.
    let last = (n * (n - 1)) as u32;
    let mut dofs: Vec<u32> = (last..last + n as u32).collect();
    dofs.push((n * n / 2) as u32);
    let at = factor.reached(&dofs);
    assert!(at.fronts.len() < factor.symbolic.fronts.len());
    // The same from a factor that has nothing else.
    let stored = Arc::new(factor.symbolic.only(&at));
    let (small, _) = PartialCholesky::inside(&k, &factor.symbolic, stored).expect("as above");
    assert!(small.bytes() < factor.bytes());
    let at_small = small.reached(&dofs);
    let load = random(dofs.len(), 3);
    let [a, b] = [(&factor, &at), (&small, &at_small)].map(|(f, at)| f.solve_at(at, &[&load]));
    assert_eq!(a, b);
    for columns in [1, 3, LANES] {
        let loads: Vec<Vec<f64>> = (0..columns)
            .map(|c| random(dofs.len(), 7 + c as u64))
            .collect();
        let refs: Vec<&[f64]> = loads.iter().map(Vec::as_slice).collect();
        let mut x = factor.forward_at(&at, &refs);
        assert_eq!(x.columns(), columns);
        let mut whole: Vec<Vec<f64>> = Vec::new();
        for (c, load) in loads.iter().enumerate() {
            let mut y = vec![0.0; k.n()];
            dofs.iter().zip(load).for_each(|(&i, v)| y[i as usize] = *v);
            factor.forward(&mut y);
            let on: Vec<f64> = border.iter().map(|&i| y[i as usize]).collect();
            assert!(distance(&factor.on_interface(&x, c), &on) < 1e-15);
            let values = random(n, 50 + c as u64);
            factor.set_interface(&mut x, c, &values);
            border
                .iter()
                .zip(&values)
                .for_each(|(&i, v)| y[i as usize] = *v);
            factor.backward(&mut y);
            whole.push(dofs.iter().map(|&i| y[i as usize]).collect());
        }
        let near = |a: &[Vec<f64>], b: &[Vec<f64>]| {
            let pairs = a.iter().flatten().zip(b.iter().flatten());
            pairs.fold(0.0f64, |far, (a, b)| far.max((a - b).abs()))
        };
        assert!(near(&factor.backward_at(&at, x), &whole) < 1e-14);
        let solved = factor.solve_at(&at, &refs);
        let whole = loads.iter().map(|load| {
            let mut y = vec![0.0; k.n()];
            dofs.iter().zip(load).for_each(|(&i, v)| y[i as usize] = *v);
            factor.solve(&mut y);
            dofs.iter().map(|&i| y[i as usize]).collect()
        });
        assert!(near(&solved, &whole.collect::<Vec<_>>()) < 1e-14);
    }
}
