//! Unit tests of `src/embed/bonds.rs`.

use super::*;

/// A bond between a subdomain and a larger one.
fn held(child: usize, parent: usize, shared: usize) -> HoldingBond {
    HoldingBond {
        child,
        parent,
        equal: 0,
        shared,
    }
}

/// A bond between two subdomains with equally few motions.
fn equal(child: usize, parent: usize) -> HoldingBond {
    HoldingBond {
        child,
        parent,
        equal: 1,
        shared: 2,
    }
}

/// Which larger subdomain keeps which; sorted.
fn kept(bonds: &[HoldingBond]) -> Vec<(usize, usize)> {
    let mut kept: Vec<(usize, usize)> = parents(bonds).into_iter().collect();
    kept.sort_unstable();
    kept
}

#[test]
fn a_node_between_two_plates_goes_with_one_of_them() {
    assert_eq!(kept(&[held(5, 3, 2), held(5, 9, 2)]), [(5, 3)]);
    assert_eq!(kept(&[held(5, 3, 2), held(5, 9, 4)]), [(5, 9)]);
}

#[test]
fn subdomains_at_one_node_go_with_the_same_plate() {
    // 5, 6 and 7 hang together, and each touches another plate: together they have most in common with 2.
    let bonds = [
        equal(5, 6),
        equal(6, 7),
        held(5, 1, 2),
        held(6, 2, 2),
        held(7, 2, 2),
    ];
    assert_eq!(kept(&bonds), [(5, 2), (6, 2), (7, 2)]);
    // What hangs together and touches no plate is kept by none.
    assert_eq!(kept(&[equal(5, 6), held(8, 1, 2)]), [(8, 1)]);
}

#[test]
fn a_chain_of_sizes_is_a_chain() {
    // In space: a node (3 motions) on an edge (5) of a cell (6).
    let bonds = [held(1, 2, 3), held(1, 3, 3), held(2, 3, 6)];
    assert_eq!(kept(&bonds), [(1, 2), (2, 3)]);
}
