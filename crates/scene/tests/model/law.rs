//! Unit tests of `crates/scene/src/model/law.rs`.

use super::*;

#[test]
fn axes_of_a_cylinder_are_radial_around_and_along() {
    let axes = MaterialAxes::Cylinder {
        centre: [1.0, 0.0, 0.0],
        axis: [0.0, 0.0, 1.0],
        turn: IDENTITY,
    };
    assert_eq!(
        axes.at([1.0, 2.0, 7.0]),
        [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    );
    // On the axis all directions are alike.
    let [radial, around, along] = axes.at([1.0, 0.0, 3.0]);
    assert_eq!(along, [0.0, 0.0, 1.0]);
    assert_eq!(cross(along, radial), around);
}

#[test]
fn two_vectors_give_orthonormal_axes_unless_they_are_parallel() {
    let axes = axes_of([0.0, 2.0, 0.0], [-1.0, 5.0, 0.0]).expect("axes");
    assert_eq!(axes, [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
    assert!(axes_of([1.0, 1.0, 0.0], [2.0, 2.0, 0.0]).is_none());
    assert!(axes_of([0.0; 3], [2.0, 2.0, 0.0]).is_none());
}

#[test]
fn axes_go_with_a_copy() {
    let mut tangent = Tangent::isotropic(1.0, 0.0);
    tangent.0[0][0] = 5.0;
    let law = OrientedLaw {
        tangent,
        axes: MaterialAxes::Fixed(IDENTITY),
    };
    let turned = Isometry::about([0.0, 0.0, 1.0], 90.0, [3.0, 0.0, 0.0]).expect("a motion");
    let placed = law.at([0.0; 3], Some(&turned));
    // What was along x is along y.
    assert!((placed.0[1][1] - 5.0).abs() < 1e-14 && (placed.0[0][0] - 1.0).abs() < 1e-14);
    let shifted = Isometry::shift([1.0, 2.0, 3.0]);
    assert_eq!(law.at([0.0; 3], Some(&shifted)), tangent);
}
