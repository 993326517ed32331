//! Unit tests of `crates/cholesky/src/lanes.rs`.

use crate::matrices::{grid_laplacian, random};
use crate::multifrontal::PartialCholesky;
use crate::symbolic::Symbolic;
use std::sync::Arc;

#[test]
fn many_are_like_one() {
    let (k, x) = grid_laplacian(23, 17, 0.01);
    let interface: Vec<u32> = (0..23).chain([100, 200]).collect();
    let symbolic = Arc::new(Symbolic::new(&k, &interface, Some(&x)));
    let (factor, _) = PartialCholesky::new(&k, symbolic).expect("definite");
    for n in [1, 3, 8] {
        let start: Vec<Vec<f64>> = (0..n).map(|c| random(k.n(), c as u64 + 1)).collect();
        let (mut forward, mut backward) = (start.clone(), start.clone());
        let mut solved = start.clone();
        factor.solve_many(&mut solved);
        factor.forward_many(&mut forward);
        factor.backward_many(&mut backward);
        for (c, b) in start.iter().enumerate() {
            let (mut f, mut g, mut s) = (b.clone(), b.clone(), b.clone());
            factor.forward(&mut f);
            factor.backward(&mut g);
            factor.solve(&mut s);
            for (one, many) in [(f, &forward[c]), (g, &backward[c]), (s, &solved[c])] {
                let far = one.iter().zip(many).map(|(a, b)| (a - b).abs());
                let size = one.iter().fold(1.0f64, |a, v| a.max(v.abs()));
                let far = far.fold(0.0, f64::max) / size;
                assert!(far < 1e-13, "{far:e}");
            }
        }
    }
}
