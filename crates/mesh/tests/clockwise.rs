//! Unit tests of `crates/mesh/src/clockwise.rs`.

use super::*;
use crate::MeshGroup;

const KINDS: [CellKind; 5] = [
    CellKind::Triangle3,
    CellKind::Triangle6,
    CellKind::Quad4,
    CellKind::Quad8,
    CellKind::Quad9,
];

/// A cell of its kind, counter-clockwise: corners, middles of edges, centre.
fn points(kind: CellKind) -> Vec<[f64; 3]> {
    let corners = match kind.corners() {
        3 => vec![[0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]],
        _ => vec![[0.0; 3], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]],
    };
    let mut all = corners.clone();
    let middles = kind
        .edges()
        .iter()
        .take((kind.nodes() - kind.corners()).min(kind.corners()));
    for [a, b] in middles.map(|e| e.map(usize::from)) {
        all.push([0, 1, 2].map(|d| 0.5 * (corners[a][d] + corners[b][d])));
    }
    if kind == CellKind::Quad9 {
        all.push([1.0, 1.0, 0.0]);
    }
    all
}

/// A mirrored cell becomes one whose nodes are in order again, from the same first node; the nodes of a side are the
/// same ones under its new number. A cell that runs counter-clockwise stays.
#[test]
fn mirrored_cells_are_turned_and_sides_keep_their_nodes() {
    for kind in KINDS {
        let n = kind.nodes() as u32;
        let right = points(kind).into_iter();
        let left = points(kind).into_iter().map(|p| [-p[0], p[1], 0.0]);
        let mut file = MeshFile {
            points: right.chain(left).collect(),
            ..MeshFile::default()
        };
        let own: Vec<u32> = (0..n).collect();
        let mirrored: Vec<u32> = (n..2 * n).collect();
        file.cells.push(kind, &own);
        file.cells.push(kind, &mirrored);
        let sides: Vec<(u32, u8)> = (0..2)
            .flat_map(|c| (0..kind.corners() as u8).map(move |s| (c, s)))
            .collect();
        file.groups.push(MeshGroup {
            name: "sides".into(),
            members: Members::Sides(sides.clone()),
        });
        let nodes = |file: &MeshFile, (c, s): (u32, u8)| {
            let mut nodes: Vec<u32> = file.cells.side_nodes(c as usize, s.into()).collect();
            nodes.sort_unstable();
            nodes
        };
        let before: Vec<Vec<u32>> = sides.iter().map(|&s| nodes(&file, s)).collect();
        assert_eq!(file.turn_clockwise(), [1], "{kind:?}");
        assert_eq!(file.cells.nodes(0), own, "{kind:?}");
        assert_eq!(file.cells.nodes(1)[0], n, "{kind:?}");
        let Members::Sides(after) = &file.groups[0].members else {
            panic!("sides");
        };
        let after: Vec<Vec<u32>> = after.iter().map(|&s| nodes(&file, s)).collect();
        assert_eq!(after, before, "{kind:?}");
        // Middles lie between the corners of their edges.
        let at = |k: usize| file.points[file.cells.nodes(1)[k] as usize];
        let middles = (kind.corners()..kind.nodes()).zip(kind.edges());
        for (m, [a, b]) in middles {
            let (a, b) = (at(usize::from(*a)), at(usize::from(*b)));
            assert_eq!(at(m), [0, 1, 2].map(|d| 0.5 * (a[d] + b[d])), "{kind:?}");
        }
        assert!(file.turn_clockwise().is_empty(), "{kind:?}");
    }
}
