use std::collections::HashMap;

use super::super::meshes::{hexes, mixed, quads, second_order, tets, triangles, Mesh};
use super::*;

/// The boundary by another way: sorted corners of all sides in one table.
fn table(mesh: &Mesh) -> HashMap<Vec<u32>, Vec<(u32, u8)>> {
    let mut table: HashMap<Vec<u32>, Vec<(u32, u8)>> = HashMap::new();
    for (c, (kind, _)) in mesh.cells.iter().enumerate() {
        for (s, side) in kind.sides().iter().enumerate() {
            let mut corners: Vec<u32> = mesh
                .cells
                .side_nodes(c, s)
                .take(side.kind.corners())
                .collect();
            corners.sort_unstable();
            table.entry(corners).or_default().push((c as u32, s as u8));
        }
    }
    table
}

#[test]
fn every_side_has_its_twin_or_is_boundary() {
    let meshes = [
        triangles([9, 7], |x, y| (x - 4.0).hypot(y - 3.0) < 1.5),
        quads([4, 3]),
        tets([3, 4, 2]),
        hexes([3, 2, 4]),
        mixed([3, 2, 6]),
        second_order(&tets([2, 2, 2])),
    ];
    for mesh in meshes {
        let adjacency = Adjacency::new(&mesh.cells);
        assert_eq!(adjacency.len(), mesh.cells.len());
        assert!(adjacency.crowded.is_empty());
        let mut boundary = Vec::new();
        for halves in table(&mesh).into_values() {
            match halves[..] {
                [one] => boundary.push(one),
                [a, b] => {
                    assert_eq!(adjacency.across(a.0 as usize, usize::from(a.1)), Some(b.0));
                    assert_eq!(adjacency.across(b.0 as usize, usize::from(b.1)), Some(a.0));
                }
                _ => unreachable!("a sound mesh"),
            }
        }
        boundary.sort_unstable();
        assert_eq!(adjacency.boundary, boundary);
        for &(c, side) in &boundary {
            assert_eq!(adjacency.across(c as usize, usize::from(side)), None);
        }
        let sides: usize = mesh.cells.kinds().iter().map(|k| k.sides().len()).sum();
        let inner: usize = (0..mesh.cells.len())
            .map(|c| adjacency.neighbours(c).count())
            .sum();
        assert_eq!(inner + boundary.len(), sides);
    }
}

/// Counts that one can do by hand.
#[test]
fn boundaries_of_boxes() {
    assert_eq!(
        Adjacency::new(&hexes([3, 4, 5]).cells).boundary.len(),
        2 * (12 + 15 + 20)
    );
    assert_eq!(
        Adjacency::new(&tets([3, 4, 5]).cells).boundary.len(),
        4 * (12 + 15 + 20)
    );
    assert_eq!(Adjacency::new(&quads([3, 4]).cells).boundary.len(), 14);
}

/// A brick that is there twice: its sides inside have three cells, the others two.
#[test]
fn sides_of_three_cells_are_reported() {
    let mut mesh = hexes([2, 1, 1]);
    let twice = mesh.cells.nodes(0).to_vec();
    mesh.cells.push(mesh.cells.kind(0), &twice);
    let adjacency = Adjacency::new(&mesh.cells);
    assert_eq!(adjacency.crowded.len(), 1);
    let cells: Vec<u32> = adjacency.crowded[0].iter().map(|h| h.0).collect();
    assert_eq!(cells, [0, 1, 2]);
    assert_eq!(adjacency.boundary.len(), 5);
    // A crowded side separates.
    assert_eq!(Components::by_sides(&adjacency).count, 2);
    assert_eq!(Components::by_nodes(&mesh.cells).count, 1);
}

/// No cell, and a cell by itself.
#[test]
fn tiny_meshes() {
    let nothing = Adjacency::new(&Cells::default());
    assert!(nothing.is_empty() && nothing.boundary.is_empty());
    assert_eq!(Components::by_sides(&nothing).count, 0);
    assert_eq!(Components::by_nodes(&Cells::default()).count, 0);
    let one = Adjacency::new(&hexes([1, 1, 1]).cells);
    assert_eq!((one.len(), one.boundary.len()), (1, 6));
}

/// Bricks that touch in a side, an edge, a node, and not at all.
#[test]
fn components_by_sides_and_by_nodes() {
    let grid = hexes([3, 3, 3]);
    let pick = |places: &[[usize; 3]]| {
        let kept: Vec<usize> = places.iter().map(|[i, j, k]| (k * 3 + j) * 3 + i).collect();
        let mesh = super::super::meshes::without(&grid, |c| !kept.contains(&c));
        let sides = Components::by_sides(&Adjacency::new(&mesh.cells));
        let nodes = Components::by_nodes(&mesh.cells);
        assert_eq!(
            sides.members().iter().map(Vec::len).sum::<usize>(),
            places.len()
        );
        (sides.count, nodes.count)
    };
    assert_eq!(pick(&[[0, 0, 0], [1, 0, 0]]), (1, 1));
    assert_eq!(pick(&[[0, 0, 0], [1, 1, 0]]), (2, 1));
    assert_eq!(pick(&[[0, 0, 0], [1, 1, 1]]), (2, 1));
    assert_eq!(pick(&[[0, 0, 0], [2, 0, 0]]), (2, 2));
    assert_eq!(pick(&[[0, 0, 0], [1, 0, 0], [2, 1, 0], [2, 2, 2]]), (3, 2));
    // Numbered by their first cells.
    let row = super::super::meshes::without(&hexes([5, 1, 1]), |c| c % 2 == 1);
    assert_eq!(Components::by_nodes(&row.cells).of, [0, 1, 2]);
}
