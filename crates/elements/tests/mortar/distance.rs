//! Unit tests of `crates/elements/src/mortar/distance.rs`.

use super::super::side::MortarFace;
use super::*;
use crate::kind::CellKind;

/// A segment in the plane from the origin along x, of this length.
fn segment(length: f64) -> MortarSide {
    let face = MortarFace {
        kind: CellKind::Line2,
        nodes: vec![0, 1],
    };
    MortarSide::new(2, vec![[0.0; 3], [length, 0.0, 0.0]], vec![face])
}

#[test]
fn sides_are_looked_for_within_four_edges_of_the_coarser_one() {
    let [fine, coarse] = [0.25, 2.0].map(segment);
    assert_eq!(reach(&fine, &coarse, f64::INFINITY), 8.0);
    assert_eq!(reach(&coarse, &fine, f64::INFINITY), 8.0);
    assert_eq!(reach(&fine, &coarse, 0.5), 0.5);
}

/// Sides at coordinates of a thousand touch where their distance is rounding of these, and sides near the origin do
/// not.
#[test]
fn rounding_of_coordinates_is_no_distance() {
    for (at, far, expected) in [
        (1024.0, 0.25, 0.25),
        (1024.0, -0.25, -0.25),
        (1024.0, 2.0_f64.powi(-34), 0.0),
        (1.0, 2.0_f64.powi(-34), 2.0_f64.powi(-34)),
    ] {
        let origin = [at, 0.0, 0.0];
        let own = |_: u32| origin;
        let other = |_: u32| [at + far, 3.0, 0.0];
        let lists = [(0, 1.0)];
        let found = distance([&lists, &lists], [&own, &other], origin, [1.0, 0.0, 0.0]);
        assert_eq!(found, expected, "{far} at {at}");
    }
}
