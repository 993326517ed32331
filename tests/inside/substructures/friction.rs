//! Unit tests of `src/substructures/friction.rs`.

use super::*;

#[test]
fn bounds_are_not_negative_and_follow_the_pressure() {
    let coulomb = FrictionBound::Coulomb {
        coefficient: 0.25,
        limit: 2.0,
    };
    assert_eq!(
        [-1.0, 0.0, 4.0, 40.0].map(|n| coulomb.at(n)),
        [0.0, 0.0, 1.0, 2.0]
    );
    let tresca = FrictionBound::Tresca(1.5);
    assert_eq!([-1.0, 0.0, 40.0].map(|n| tresca.at(n)), [1.5; 3]);
    assert!(tresca.acts_apart() && !coulomb.acts_apart());
}

#[test]
#[should_panic]
fn a_node_has_one_or_two_tangential_rows() {
    FrictionNode::new(0, vec![1, 2, 3], FrictionBound::Tresca(1.0));
}
