//! Unit tests of `crates/base/src/linalg/strained.rs`.

use super::*;

/// A chain of springs of different stiffness; `held`: the first node is held by one, too.
fn chain(stiffness: &[f64], held: f64) -> Csr {
    let mut entries = vec![(0, 0, held)];
    for (i, &k) in (0..).zip(stiffness) {
        entries.extend([(i, i, k), (i, i + 1, -k), (i + 1, i, -k), (i + 1, i + 1, k)]);
    }
    Csr::from_triplets(stiffness.len() + 1, &entries)
}

#[test]
fn a_stiff_chain_that_is_carried_along_has_the_forces_of_its_strain() {
    let stiffness = [1.1e12, 0.7e12, 1.3e12];
    let k = chain(&stiffness, 0.0);
    let d = k.diagonal();
    // A motion by 0.3, and strains that belong to forces of 0.1.
    let mut u = vec![0.3];
    for s in stiffness {
        u.push(u.last().unwrap() + 0.1 / s);
    }
    let ones = vec![vec![1.0; 4]];
    let v = strained(&k, Some(&ones), &d, &u, 0.0).expect("it moves rigidly");
    assert!(v.iter().all(|v| v.abs() < 1e-12), "{v:?}");
    let mut force = vec![0.0; 4];
    k.mul(&v, &mut force);
    // What is left of the rounding of u balances itself.
    assert!(force.iter().sum::<f64>().abs() < 1e-12, "{force:?}");
    assert!((force[3] - 0.1).abs() < 1e-3, "{force:?}");
    // A chain that is held, one that is strained, and one of which nothing is known stay as they are.
    let held = chain(&stiffness, 1e12);
    assert!(strained(&held, Some(&ones), &held.diagonal(), &u, 0.0).is_none());
    assert!(strained(&k, Some(&ones), &d, &u, 1e10).is_none());
    assert!(strained(&k, None, &d, &u, 0.0).is_none());
}
