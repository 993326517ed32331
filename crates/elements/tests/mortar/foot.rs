//! Unit tests of `crates/elements/src/mortar/foot.rs`.

use super::super::side::MortarFace;
use super::*;

/// A square of two by two faces of edge 1/2 in the plane z = 0, with the normal along z.
fn square() -> MortarSide {
    let points = (0..9).map(|k| [(k % 3) as f64 / 2.0, (k / 3) as f64 / 2.0, 0.0]);
    let face = |&[i, j]: &[u32; 2]| {
        let first = i + 3 * j;
        MortarFace {
            kind: CellKind::Quad4,
            nodes: vec![first, first + 1, first + 4, first + 3],
        }
    };
    let faces = [[0, 0], [1, 0], [0, 1], [1, 1]].iter().map(face);
    MortarSide::new(3, points.collect(), faces.collect())
}

#[test]
fn a_foot_is_the_nearest_point_with_the_values_there() {
    let side = square();
    let feet = Feet::new(&side);
    let foot = feet.of([0.6, 0.2, 0.1], 0.2, &|_| true).unwrap();
    assert!((foot.distance - 0.1).abs() < 1e-15);
    let sum = |d: usize| -> f64 {
        let each = foot
            .values
            .iter()
            .map(|(k, v)| v * side.points()[*k as usize][d]);
        each.sum()
    };
    assert!((sum(0) - 0.6).abs() < 1e-14 && (sum(1) - 0.2).abs() < 1e-14);
    assert_eq!(foot.values.len(), 4);
    // Farther than asked for, from the other side too; at the limit it counts.
    assert!(feet.of([0.6, 0.2, -0.21], 0.2, &|_| true).is_none());
    assert!(feet.of([0.6, 0.2, -0.2], 0.2, &|_| true).is_some());
    // Rounding of a coordinate is no way beyond it.
    assert!(feet.of([0.6, 0.2, 0.1 + 0.2], 0.3, &|_| true).is_some());
    assert!(feet.of([0.6, 0.2, 0.1], 0.2, &|n| n[2] < 0.0).is_none());
}

#[test]
fn beyond_the_rim_there_is_a_little_slack() {
    let side = square();
    let feet = Feet::new(&side);
    // As CalculiX has it: the mean of 1/2 / 3 and 1/2 / (3 sqrt(2)), times 2.5 %.
    let small = 0.025 * (1.0 / 6.0 + 1.0 / (6.0 * 2.0_f64.sqrt())) / 2.0;
    assert!((side.small() - small).abs() < 1e-15);
    assert!(feet
        .of([1.0 + 1.01 * small, 0.3, 0.0], 0.1, &|_| true)
        .is_none());
    let foot = feet
        .of([1.0 + 0.99 * small, 0.3, 0.0], 0.1, &|_| true)
        .unwrap();
    assert!((foot.point[0] - 1.0).abs() < 1e-14 && foot.distance == 0.0);
}

#[test]
fn an_edge_between_faces_is_no_rim() {
    // A roof: above its ridge no plane of a face has the node inside.
    let points = vec![
        [0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [-1.0, 0.0, -1.0],
        [-1.0, 1.0, -1.0],
        [1.0, 0.0, -1.0],
        [1.0, 1.0, -1.0],
    ];
    let face = |nodes: Vec<u32>| MortarFace {
        kind: CellKind::Quad4,
        nodes,
    };
    let side = MortarSide::new(
        3,
        points,
        vec![face(vec![2, 0, 1, 3]), face(vec![0, 4, 5, 1])],
    );
    let feet = Feet::new(&side);
    let foot = feet.of([0.0, 0.5, 0.1], 0.11, &|_| true).unwrap();
    assert!((foot.distance - 0.1).abs() < 1e-14, "{}", foot.distance);
    assert!(foot
        .point
        .iter()
        .zip([0.0, 0.5, 0.0])
        .all(|(a, b)| (a - b).abs() < 1e-12));
    assert!(feet.of([0.0, 0.5, 0.12], 0.11, &|_| true).is_none());
}

#[test]
fn curved_faces_are_met_where_they_are() {
    // A parabola y = x² in the plane, as one segment of second order.
    let points = vec![[-1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 0.0]];
    let face = MortarFace {
        kind: CellKind::Line3,
        nodes: vec![0, 1, 2],
    };
    let side = MortarSide::new(2, points, vec![face]);
    let feet = Feet::new(&side);
    let (s, way) = (0.5, 0.05);
    let length = 2.0_f64.sqrt();
    let x = [s + way / length, s * s - way / length, 0.0];
    let foot = feet.of(x, 0.5, &|_| true).unwrap();
    assert!((foot.point[0] - s).abs() < 1e-9 && (foot.point[1] - s * s).abs() < 1e-9);
}

#[test]
fn beyond_a_reference_cell_the_nearest_point_is_on_its_edge() {
    let near = |kind, at: [f64; 2], expected: [f64; 2]| {
        let found = inside(kind, [at[0], at[1], 0.0]);
        let apart = minus(found, [expected[0], expected[1], 0.0]);
        assert!(norm(apart) < 1e-15, "{at:?}: {found:?}");
    };
    let triangle = CellKind::Triangle3;
    near(triangle, [0.25, 0.5], [0.25, 0.5]);
    near(triangle, [0.25, -0.5], [0.25, 0.0]);
    near(triangle, [-0.5, 0.25], [0.0, 0.25]);
    // Across the long edge, and beyond its ends.
    near(triangle, [1.0, 0.5], [0.75, 0.25]);
    near(triangle, [0.5, 1.0], [0.25, 0.75]);
    near(triangle, [3.0, 0.5], [1.0, 0.0]);
    near(triangle, [0.5, 3.0], [0.0, 1.0]);
    near(CellKind::Quad4, [1.5, -2.0], [1.0, -1.0]);
}
