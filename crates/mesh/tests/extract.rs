//! Unit tests of `crates/mesh/src/extract.rs`.

use super::*;
use crate::MeshGroup;
use elements::kind::CellKind;

/// A row of five unit squares, numbered from the right; neighbours share nodes. The square at the left is there three
/// times: cells 4, 11 and 12.
fn file() -> MeshFile {
    let mut file = MeshFile {
        name: "row".into(),
        ..MeshFile::default()
    };
    for k in 0..12 {
        file.points.push([(k / 2) as f64, (k % 2) as f64, 0.0]);
        file.node_ids.push(100 + k);
    }
    for k in (0..5).rev() {
        let a = 2 * k;
        file.cells.push(CellKind::Quad4, &[a, a + 2, a + 3, a + 1]);
    }
    for k in 0..6 {
        file.cells.push(CellKind::Line2, &[2 * k, 2 * k + 1]);
    }
    for _ in 0..2 {
        file.cells.push(CellKind::Quad4, &[0, 2, 3, 1]);
    }
    file.cell_ids = (1..=file.cells.len() as u64).collect();
    let group = |name: &str, members| MeshGroup {
        name: name.into(),
        members,
    };
    let lines = |cells: &[u32]| Members::Cells {
        dim: 1,
        cells: cells.to_vec(),
    };
    file.groups = vec![
        group("all lines", lines(&[5, 6, 7, 8, 9, 10])),
        group("high", Members::Nodes(vec![1, 3, 5, 7, 9, 11])),
        group("left", lines(&[5])),
        // The lower sides of the first, third and fifth square from the right.
        group("low", Members::Sides(vec![(0, 0), (2, 0), (4, 0)])),
        group("right", lines(&[10])),
        group("end", Members::Nodes(vec![10, 11])),
    ];
    file
}

/// Names of groups with positions of their nodes and number of their faces.
fn groups(mesh: &CellMesh) -> Vec<(&str, Vec<[f64; 2]>, usize)> {
    let place = |&k: &u32| [mesh.points[k as usize][0], mesh.points[k as usize][1]];
    let of = |side: &'_ SideGroup| side.nodes.iter().map(place).collect();
    let sides = mesh.sides.iter();
    sides
        .map(|side| (side.name.as_str(), of(side), side.faces.len()))
        .collect()
}

#[test]
fn bodies_have_their_parts_of_groups() {
    let file = file();
    let mut row = Extractor::new(&file, 2);
    // The two squares at the left: cells 4 and 3.
    let two = row.extract(&[3, 4], 2.0).expect("a mesh");
    assert_eq!(two.points.len(), 6);
    assert_eq!(two.points[5], [4.0, 2.0, 0.0]);
    assert_eq!(two.node_ids, [100, 101, 102, 103, 104, 105]);
    assert_eq!(two.cell_ids, [4, 5]);
    let [a, b, c] = [0.0, 2.0, 4.0].map(|x| [[x, 0.0], [x, 2.0]]);
    let ring = vec![a[0], a[1], b[0], b[1], c[0], c[1]];
    let expected = vec![
        // The line in the middle is inside.
        ("all lines", ring.clone(), 2),
        ("high", vec![a[1], b[1], c[1]], 2),
        ("left", a.to_vec(), 1),
        ("low", vec![a[0], b[0]], 1),
        ("all", ring, 6),
    ];
    assert_eq!(groups(&two), expected);
    // The square at the right.
    let one = row.extract(&[0], 1.0).expect("a mesh");
    let [a, b] = [4.0, 5.0].map(|x| [[x, 0.0], [x, 1.0]]);
    let ring = vec![a[0], a[1], b[0], b[1]];
    let expected = vec![
        ("all lines", ring.clone(), 2),
        ("high", vec![a[1], b[1]], 1),
        ("low", vec![a[0], b[0]], 1),
        ("right", b.to_vec(), 1),
        ("end", b.to_vec(), 1),
        ("all", ring, 4),
    ];
    assert_eq!(groups(&one), expected);
}

/// An extraction, a failed one too, leaves nothing behind.
#[test]
fn a_body_does_not_depend_on_those_before_it() {
    let file = file();
    let bodies = [&[0, 1][..], &[2], &[1, 2, 3], &[4], &[0, 1, 2, 3, 4]];
    let mut row = Extractor::new(file.clone(), 2);
    for body in bodies {
        let three = row
            .extract(&[4, 11, 12], 1.0)
            .expect_err("three cells share a side");
        assert!(three.to_string().contains("share one side"), "{three}");
        let alone = Extractor::new(&file, 2).extract(body, 1.0);
        let after = row.extract(body, 1.0);
        assert_eq!(after.expect("a mesh"), alone.expect("a mesh"), "{body:?}");
    }
}

#[test]
fn parts_hang_together_by_nodes() {
    let mut row = Extractor::new(file(), 2);
    assert_eq!(row.connected(&[0, 1, 3]), [vec![0, 1], vec![3]]);
    assert_eq!(row.connected(&[0, 2, 4]), [[0], [2], [4]]);
    assert_eq!(row.connected(&[0, 1, 2, 3, 4]), [[0, 1, 2, 3, 4]]);
}

/// The adjacency that extraction has found is the one that is found anew.
#[test]
fn adjacency_is_that_of_the_cells() {
    let mut row = Extractor::new(file(), 2);
    let mut mesh = row.extract(&[0, 1, 2, 3], 1.0).expect("a mesh");
    let known = mesh.adjacency();
    mesh.forget_adjacency();
    assert_eq!(known, mesh.adjacency());
    assert_eq!(*known, Adjacency::new(&mesh.cells));
}
