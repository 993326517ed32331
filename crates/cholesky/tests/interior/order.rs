//! Unit tests of `crates/cholesky/src/interior/order.rs`.

use super::*;
use crate::matrices::grid_laplacian;
use crate::multifrontal::PartialCholesky;
use crate::symbolic::{Keep, Symbolic};
use std::sync::Arc;

#[test]
fn every_ordering_eliminates_every_dof_once() {
    let (k, x) = grid_laplacian(31, 22, 0.1);
    let interface: Vec<u32> = (0..31).collect();
    for ordering in Ordering::ALL {
        let found = Elimination::new(&k, &interface, Some(&x), ordering).expect("ordered");
        for list in [found.interior.clone(), found.supernodes.concat()] {
            let mut sorted = list;
            sorted.sort_unstable();
            assert_eq!(sorted, (31..k.n() as u32).collect::<Vec<_>>());
        }
    }
}

#[test]
fn minimum_degree_fills_less_than_the_natural_order_and_fronts_are_few() {
    let (k, x) = grid_laplacian(60, 60, 0.1);
    let entries = |sets: &[Vec<u32>]| {
        let symbolic = Arc::new(Symbolic::with_supernodes(&k, &[], sets));
        let (factor, _) = PartialCholesky::new(&k, symbolic.clone()).expect("definite");
        assert_eq!(factor.bytes(), 8 * symbolic.factor_entries(Keep::Boundary));
        symbolic.factor_entries(Keep::Boundary)
    };
    let single: Vec<Vec<u32>> = (0..k.n() as u32).map(|i| vec![i]).collect();
    let natural = entries(&single);
    for ordering in Ordering::ALL {
        let found = Elimination::new(&k, &[], Some(&x), ordering).expect("ordered");
        let ours = entries(&found.supernodes);
        assert!(ours < natural, "{ordering:?}: {ours} of {natural}");
        assert!(found.supernodes.len() < k.n() / 4, "{ordering:?}");
    }
}

#[test]
fn orderings_are_the_same_on_every_thread() {
    let (k, _) = grid_laplacian(50, 40, 0.1);
    for ordering in [Ordering::Metis, Ordering::Scotch] {
        let order = || {
            let found = Elimination::new(&k, &[], None, ordering).expect("ordered");
            found.interior
        };
        let all: Vec<Vec<u32>> = std::thread::scope(|s| {
            let started: Vec<_> = (0..4).map(|_| s.spawn(order)).collect();
            started
                .into_iter()
                .map(|t| t.join().expect("no panic"))
                .collect()
        });
        assert!(all.iter().all(|o| *o == all[0]), "{ordering:?}");
    }
}
