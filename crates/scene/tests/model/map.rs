//! Unit tests of `crates/scene/src/model/map.rs`.

use super::*;

fn round(ball: bool, quarter: bool) -> Map {
    Map {
        origin: [0.0; 3],
        size: [1.0; 3],
        shape: BodyShape::Round(Round {
            centre: [1.0, 2.0, 3.0],
            radius: 2.0,
            quarter,
            ball,
            upwards: false,
            grading: 1.5,
            focus: None,
            trim: 1.0,
        }),
    }
}

#[test]
fn elements_are_equal_in_focus_and_grow_beyond() {
    let mut map = round(false, true);
    let BodyShape::Round(shape) = &mut map.shape else {
        unreachable!("it is round")
    };
    (shape.grading, shape.focus) = (1.0, Some(0.02));
    let x = |i: u32| map.apply([f64::from(i) / 50.0, 0.0, 0.0])[0];
    let step = |i: u32| x(i + 1) - x(i);
    assert!(step(1) < 1.01 * step(0) && step(49) > 40.0 * step(0));
    assert!((step(40) / step(39) - step(39) / step(38)).abs() < 1e-3);
    assert_eq!(map.apply([1.0, 1.0, 0.0]), [3.0, 2.0, 0.0]);
}

#[test]
fn bottoms_are_round_and_tops_are_flat() {
    for (ball, quarter) in [(false, false), (true, false), (true, true)] {
        let map = round(ball, quarter);
        for (s, r) in [(0.0, 0.0), (0.3, 0.9), (1.0, 0.5), (0.5, 0.5)] {
            let [x, y, z] = map.apply([s, 0.0, r]);
            let depth = if ball { z - 3.0 } else { 0.0 };
            let distance = (x - 1.0).hypot(y - 2.0).hypot(depth);
            assert!((distance - 2.0).abs() < 1e-14, "{distance}");
            assert!((map.apply([s, 1.0, r])[1] - 2.0).abs() < 1e-15);
        }
    }
    assert_eq!(round(true, false).apply([0.5, 0.0, 0.5]), [1.0, 0.0, 3.0]);
}

#[test]
fn trimmed_bottoms_are_round_and_have_good_corners() {
    let mut map = round(true, true);
    let BodyShape::Round(shape) = &mut map.shape else {
        unreachable!("it is round")
    };
    shape.trim = 0.7;
    let corner = map.apply([1.0, 0.0, 1.0]);
    let from_centre = [corner[0] - 1.0, corner[1] - 2.0, corner[2] - 3.0];
    let distance = from_centre.iter().map(|v| v * v).sum::<f64>().sqrt();
    assert!((distance - 2.0).abs() < 1e-14, "{distance}");
    // The sides of the box meet there at an angle well below 180°, also in a fine mesh.
    let to = |s: [f64; 3]| {
        let p = map.apply(s);
        [0, 1, 2].map(|d| p[d] - corner[d])
    };
    let (p, q) = (to([1.0 - 1e-4, 0.0, 1.0]), to([1.0, 1e-4, 1.0]));
    let product = |a: [f64; 3], b: [f64; 3]| (0..3).map(|d| a[d] * b[d]).sum::<f64>();
    let cosine = product(p, q) / (product(p, p) * product(q, q)).sqrt();
    assert!(cosine > -0.9, "{cosine}");
}

#[test]
fn a_pole_on_top_is_the_mirror_image() {
    let mut map = round(true, false);
    let below = map.apply([0.3, 0.2, 0.6]);
    let BodyShape::Round(shape) = &mut map.shape else {
        unreachable!("it is round")
    };
    shape.upwards = true;
    let above = map.apply([0.3, 0.8, 0.6]);
    assert_eq!([above[0], above[2]], [below[0], below[2]]);
    assert!((above[1] + below[1] - 4.0).abs() < 1e-15);
    assert_eq!(map.apply([0.5, 1.0, 0.5]), [1.0, 4.0, 3.0]);
}

#[test]
fn an_annulus_is_walked_around() {
    let map = Map {
        origin: [-1.0, 0.0, 0.0],
        size: [2.0, 1.0, 0.0],
        shape: BodyShape::Annulus {
            centre: [0.0, 1.0],
            radii: [1.0, 3.0],
            angles: [0.0, std::f64::consts::FRAC_PI_2],
        },
    };
    let [x, y, z] = map.apply([0.0, 1.0, 0.0]);
    assert!(x.abs() < 1e-15 && (y - 3.0).abs() < 1e-15 && z == 0.0);
    assert_eq!(map.apply([1.0, 0.0, 0.0]), [3.0, 1.0, 0.0]);
}
