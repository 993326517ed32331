//! Unit tests of `crates/mesh/src/congruent.rs`.

use super::*;
use crate::Cells;
use elements::kind::CellKind;

/// Two triangles on four points without symmetry.
fn kite(place: impl Fn([f64; 3]) -> [f64; 3], mirrored: bool) -> CellMesh {
    let points = [[0.0, 0.0], [2.0, 0.1], [1.7, 1.4], [-0.2, 1.0]];
    let points: Vec<[f64; 3]> = points.iter().map(|p| place([p[0], p[1], 0.0])).collect();
    let mut cells = Cells::default();
    for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
        let nodes = if mirrored { [a, c, b] } else { [a, b, c] };
        cells.push(CellKind::Triangle3, &nodes);
    }
    let skin = if mirrored {
        vec![(0, 1), (0, 2), (1, 0), (1, 1)]
    } else {
        vec![(0, 0), (0, 1), (1, 1), (1, 2)]
    };
    CellMesh::new(2, points, cells, Vec::new(), skin)
}

#[test]
fn moved_turned_and_mirrored_copies_are_known() {
    let original = kite(|p| p, false);
    let turned = |[x, y, z]: [f64; 3]| [0.6 * x - 0.8 * y + 7.0, 0.8 * x + 0.6 * y, z];
    let mirrored = |p: [f64; 3]| {
        let [x, y, z] = turned(p);
        [-x, y, z]
    };
    assert!(congruent(&original, &kite(turned, false)));
    assert!(congruent(&original, &kite(mirrored, true)));
    let longer = |[x, y, z]: [f64; 3]| [1.001 * x, y, z];
    assert!(!congruent(&original, &kite(longer, false)));
}

#[test]
fn other_cells_on_the_same_points_are_no_copy() {
    let original = kite(|p| p, false);
    let mut other = kite(|p| p, false);
    other.cells = Cells::default();
    other.cells.push(CellKind::Triangle3, &[0, 1, 3]);
    other.cells.push(CellKind::Triangle3, &[1, 2, 3]);
    assert!(!congruent(&original, &other));
}

/// Outlines let all copies through, to the tolerance, and keep others out.
#[test]
fn outlines_tell_meshes_apart() {
    let original = kite(|p| p, false);
    let outline = MeshFingerprint::new(&original);
    let copy = |[x, y, z]: [f64; 3]| [0.8 * y - 0.6 * x + 3.0, 0.6 * y + 0.8 * x, z];
    assert!(congruent(&original, &kite(copy, true)));
    assert!(outline.may_be(&MeshFingerprint::new(&kite(copy, true))));
    // Off by as much as a copy may be.
    let rough = |p: [f64; 3]| copy(p).map(|x| x + 0.7e-6 * (1e3 * x).sin());
    assert!(congruent(&original, &kite(rough, false)));
    assert!(outline.may_be(&MeshFingerprint::new(&kite(rough, false))));
    let sheared = |[x, y, z]: [f64; 3]| [x + 0.01 * y, y, z];
    assert!(!outline.may_be(&MeshFingerprint::new(&kite(sheared, false))));
    let longer = |p: [f64; 3]| p.map(|x| 1.001 * x);
    assert!(!outline.may_be(&MeshFingerprint::new(&kite(longer, false))));
}
