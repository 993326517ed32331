//! Unit tests of `crates/elements/src/mortar/space.rs`.

use super::super::side::{reversed, MortarFace};
use super::*;
use crate::kind::CellKind;

#[test]
fn polygons_are_cut() {
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let shifted = square.map(|[x, y]| [x + 0.25, y - 0.5]);
    assert!((area(&cut(&square, &shifted)) - 0.375).abs() < 1e-15);
    // The order around does not matter.
    let turned: Vec<[f64; 2]> = shifted.iter().rev().copied().collect();
    assert!((area(&cut(&square, &turned)) - 0.375).abs() < 1e-15);
    let inside = [[0.2, 0.2], [0.6, 0.3], [0.3, 0.7]];
    assert!((area(&cut(&square, &inside)) - area(&inside)).abs() < 1e-15);
    assert!((area(&cut(&inside, &square)) - area(&inside)).abs() < 1e-15);
    let away = square.map(|[x, y]| [x + 2.0, y]);
    assert_eq!(area(&cut(&square, &away)), 0.0);
    // A common edge is no common part.
    let beside = square.map(|[x, y]| [x + 1.0, y]);
    assert_eq!(area(&cut(&square, &beside)), 0.0);
}

/// One face of 9 nodes over the unit square, bent along x to z = `bend` · x (1 − x) + `lift`. `up`: the normal points
/// along z.
fn bent(bend: f64, lift: f64, up: bool) -> ([[f64; 3]; 9], MortarFace) {
    let kind = CellKind::Quad9;
    let place = |[s, t, _]: [f64; 3]| {
        let (x, y) = (0.5 + 0.5 * s, 0.5 + 0.5 * t);
        [x, y, bend * x * (1.0 - x) + lift]
    };
    let points: Vec<[f64; 3]> = crate::element::face_values::nodes(kind)
        .iter()
        .map(|&at| place(at))
        .collect();
    let order: Vec<u32> = (0..9).collect();
    let nodes = if up { order } else { reversed(kind, &order) };
    (
        points.try_into().expect("9 nodes"),
        MortarFace { kind, nodes },
    )
}

/// A side of several such faces.
fn side(faces: &[([[f64; 3]; 9], MortarFace)]) -> MortarSide {
    let points = faces.iter().flat_map(|f| f.0).collect();
    let moved = |(k, (_, face)): (u32, &([[f64; 3]; 9], MortarFace))| MortarFace {
        kind: face.kind,
        nodes: face.nodes.iter().map(|n| n + 9 * k).collect(),
    };
    MortarSide::new(3, points, (0..).zip(faces).map(moved).collect())
}

/// The weights of curved faces add up to their area: the arc of a parabola with the slope 1 at its ends, times 1.
#[test]
fn areas_are_those_of_curved_faces() {
    let [a, b] = [true, false].map(|up| side(&[bent(1.0, 0.0, up)]));
    let area: f64 = samples(&a, &b, 0.5).iter().map(|s| s.weight).sum();
    let expected = 0.5 * (2.0_f64.sqrt() + 1.0_f64.asinh());
    assert!((area - expected).abs() < 1e-5, "{area}, not {expected}");
}

/// Behind a surface lies another one with the same normal, several edges away.
#[test]
fn layers_far_behind_the_nearest_one_do_not_count() {
    let a = side(&[bent(0.0, 0.0, true)]);
    let b = side(&[bent(0.0, 6.0, false), bent(0.0, 0.1, false)]);
    let found = samples(&a, &b, 10.0);
    assert!(found.iter().all(|s| s.other == 1));
    let area: f64 = found.iter().map(|s| s.weight).sum();
    assert!((area - 1.0).abs() < 1e-14);
}
