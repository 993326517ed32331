//! Unit tests of `crates/elements/src/mortar/plane.rs`.

use super::super::side::MortarFace;
use super::*;
use crate::kind::CellKind;

/// Segments between these points, two by two; the normal is to the right of the way along each.
fn segments(points: &[[f64; 2]]) -> MortarSide {
    let face = |k: usize| MortarFace {
        kind: CellKind::Line2,
        nodes: vec![2 * k as u32, 2 * k as u32 + 1],
    };
    let places = points.iter().map(|[x, y]| [*x, *y, 0.0]).collect();
    MortarSide::new(2, places, (0..points.len() / 2).map(face).collect())
}

/// Both layers of the other side have normals towards the multiplier side, in any order.
#[test]
fn the_nearest_of_several_layers_is_opposite() {
    let side = segments(&[[1.0, 0.0], [0.0, 0.0]]);
    let (near, far) = ([[0.0, 0.1], [1.0, 0.1]], [[0.0, 0.4], [1.0, 0.4]]);
    for (layers, nearest) in [([near, far], 0), ([far, near], 1)] {
        let found = samples(&side, &segments(&layers.concat()), 0.5);
        assert!(!found.is_empty());
        assert!(found.iter().all(|s| s.other == nearest));
        let length: f64 = found.iter().map(|s| s.weight).sum();
        assert!((length - 1.0).abs() < 1e-15);
    }
}
