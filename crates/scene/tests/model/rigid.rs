//! Unit tests of `crates/scene/src/model/rigid.rs`.

use super::*;

#[test]
fn distances_and_normals() {
    let plane = Rigid::Plane {
        point: [0.0, -1.0, 0.0],
        normal: [0.0, 1.0, 0.0],
    };
    assert_eq!(
        plane.distance([7.0, 2.0, 5.0]),
        Some((3.0, [0.0, 1.0, 0.0]))
    );
    let mut round = Rigid::Round {
        centre: [1.0, 0.0, 9.0],
        axis: Some([0.0, 0.0, 1.0]),
        radius: 2.0,
        cavity: false,
    };
    assert_eq!(
        round.distance([4.0, 0.0, 0.0]),
        Some((1.0, [1.0, 0.0, 0.0]))
    );
    assert_eq!(round.distance([1.0, 0.0, 3.0]), None);
    if let Rigid::Round { cavity, axis, .. } = &mut round {
        (*cavity, *axis) = (true, None);
    }
    let (distance, normal) = round.distance([1.0, 1.0, 9.0]).expect("a nearest point");
    assert_eq!((distance, normal), (1.0, [0.0, -1.0, 0.0]));
}
