//! Motions whose names are known.

use super::*;

fn twist(dim: usize, translation: [f64; 3], rotation: [f64; 3]) -> RigidMotion {
    RigidMotion {
        body: 0,
        dim,
        centre: [1.0, 2.0, 0.5],
        radius: 2.0,
        translation,
        rotation,
    }
}

#[test]
fn motions_have_the_names_that_people_give_them() {
    let (x, y, z, o) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3]);
    let along = [2.0, 2.0, 0.0];
    for (twists, expected) in [
        (vec![twist(2, x, o)], "slides along x"),
        (
            vec![twist(2, [-0.3, -0.3, 0.0], o)],
            "slides along (0.7071, 0.7071, 0)",
        ),
        (
            vec![twist(3, x, o), twist(3, along, o)],
            "slides along x and y",
        ),
        (
            vec![twist(3, x, o), twist(3, y, o), twist(3, z, o)],
            "slides in all directions",
        ),
        (vec![twist(2, o, z)], "turns about (1, 2)"),
        (vec![twist(3, o, y)], "turns about y through (1, 0, 0.5)"),
        // The point (1, 0) stays: its displacement is t + ω × (x − c).
        (vec![twist(2, [-2.0, 0.0, 0.0], z)], "turns about (1, 0)"),
        // A turn about any point, where the body slides in all directions.
        (
            vec![
                twist(2, [3.0, -1.0, 0.0], z),
                twist(2, x, o),
                twist(2, y, o),
            ],
            "moves freely",
        ),
        (
            vec![twist(3, [3.0, -1.0, 0.0], z), twist(3, x, o)],
            "slides along x and turns about z through (2, 2, 0)",
        ),
        (
            vec![twist(3, z, z)],
            "turns about z through (1, 2, 0) and slides along this axis by 1.0000 for each radian",
        ),
    ] {
        assert_eq!(in_words(&twists, false), expected);
    }
    assert_eq!(in_words(&[twist(2, x, o)], true), "slide along x");
}

#[test]
fn bodies_move_as_one_if_points_do() {
    let a = twist(2, [-2.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    // The same turn about (1, 0), seen from another body.
    let centre = [4.0, 1.0, 0.0];
    let b = RigidMotion {
        body: 1,
        centre,
        translation: a.at(centre),
        ..a
    };
    assert!(as_one(&[a, b]));
    assert!(!as_one(&[
        a,
        RigidMotion {
            translation: [0.0; 3],
            ..b
        }
    ]));
}
