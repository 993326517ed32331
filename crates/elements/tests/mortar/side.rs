//! Unit tests of `crates/elements/src/mortar/side.rs`.

use super::*;

/// Two segments of lengths 3 and 4 that meet at a right angle: the normal at their node is the mean by length.
#[test]
fn normals_at_nodes_are_means_by_area() {
    let points = vec![[0.0; 3], [3.0, 0.0, 0.0], [3.0, 4.0, 0.0]];
    let face = |a: u32| MortarFace {
        kind: CellKind::Line2,
        nodes: vec![a, a + 1],
    };
    let found = MortarSide::new(2, points, vec![face(0), face(1)]).normals();
    let expected = [[0.0, -1.0, 0.0], [0.8, -0.6, 0.0], [1.0, 0.0, 0.0]];
    for (n, m) in found.iter().zip(&expected) {
        assert!((0..3).all(|d| (n[d] - m[d]).abs() < 1e-15), "{n:?}");
    }
}
