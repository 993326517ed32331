//! Unit tests of `crates/elements/src/mortar/orientation.rs`.

use super::*;
use crate::kind::CellKind;
use crate::mortar::MortarSide;
use base::linalg::vec3::dot;

fn faces(kind: CellKind, lists: &[&[u32]]) -> Vec<MortarFace> {
    let face = |nodes: &&[u32]| MortarFace {
        kind,
        nodes: nodes.to_vec(),
    };
    lists.iter().map(face).collect()
}

#[test]
fn neighbours_that_disagree_are_found() {
    let line = |lists| one_way(&faces(CellKind::Line2, lists));
    assert_eq!(line(&[&[0, 1], &[1, 2], &[2, 3]]), None);
    assert_eq!(line(&[&[0, 1], &[1, 2], &[3, 2]]), Some([1, 2]));
    let quads = |lists| one_way(&faces(CellKind::Quad4, lists));
    assert_eq!(quads(&[&[0, 1, 4, 3], &[1, 2, 5, 4]]), None);
    assert_eq!(quads(&[&[0, 1, 4, 3], &[1, 4, 5, 2]]), Some([0, 1]));
    // Two pairs of faces on one edge.
    let four: &[&[u32]] = &[&[0, 1, 2], &[1, 0, 3], &[0, 1, 4], &[1, 0, 5]];
    assert_eq!(one_way(&faces(CellKind::Triangle3, four)), None);
}

/// Reversed faces of all kinds have opposite normals at all nodes, and twice reversed ones are the same.
#[test]
fn reversed_faces_have_opposite_normals() {
    let places: [[f64; 2]; 9] = [
        [0.0, 0.0],
        [2.0, 0.1],
        [2.2, 2.0],
        [0.1, 1.9],
        [1.0, -0.1],
        [2.2, 1.0],
        [1.1, 2.1],
        [-0.1, 1.0],
        [1.0, 1.0],
    ];
    let bent = |[x, y]: [f64; 2]| [x, y, 0.1 * x * y];
    let triangle = [
        [0.0, 0.0],
        [2.0, 0.1],
        [0.2, 2.0],
        [1.0, 0.0],
        [1.1, 1.1],
        [0.1, 1.0],
    ];
    for kind in [
        CellKind::Line2,
        CellKind::Line3,
        CellKind::Triangle3,
        CellKind::Triangle6,
        CellKind::Quad4,
        CellKind::Quad8,
        CellKind::Quad9,
    ] {
        let n = kind.nodes();
        let dim = kind.dim() + 1;
        let points: Vec<[f64; 3]> = match kind {
            CellKind::Line3 => vec![[0.0; 3], [2.0, 0.0, 0.0], [1.0, 0.2, 0.0]],
            CellKind::Line2 => vec![[0.0; 3], [2.0, 0.1, 0.0]],
            _ if kind.corners() == 3 => triangle[..n].iter().map(|x| bent(*x)).collect(),
            _ => places[..n].iter().map(|x| bent(*x)).collect(),
        };
        let one = vec![MortarFace {
            kind,
            nodes: (0..n as u32).collect(),
        }];
        let side = MortarSide::new(dim, points, one);
        let back = side.reversed();
        assert_eq!(back.reversed(), side);
        assert_eq!(MortarFace::kind_of(dim, n), Some(kind));
        let (normals, others) = (side.normals(), back.normals());
        for (a, b) in normals.iter().zip(&others) {
            assert!(
                (dot(*a, *b) + 1.0).abs() < 1e-12,
                "{}: {a:?} {b:?}",
                kind.name()
            );
        }
    }
}
