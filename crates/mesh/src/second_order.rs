//! Boxes of elements of second order, as meshes of cells.

use super::boxes::{places, BoxMesh};
use super::cell_mesh::{CellMesh, SideGroup};
use super::cells::Cells;
use super::partition::Interface;
use super::SIDES;
use elements::kind::CellKind;

/// The corners of a quadrilateral or hexahedron in the order of its kind, as lattice places 0 and 2.
const CORNERS: [[usize; 3]; 8] = [
    [0, 0, 0],
    [2, 0, 0],
    [2, 2, 0],
    [0, 2, 0],
    [0, 0, 2],
    [2, 0, 2],
    [2, 2, 2],
    [0, 2, 2],
];

/// The orders of the axes along which the simplices of a cell walk from its first to its last corner, and whether the
/// simplex then has positive volume.
const WALKS: [&[([usize; 3], bool)]; 2] = [
    &[([0, 1, 2], true), ([1, 0, 2], false)],
    &[
        ([0, 1, 2], true),
        ([0, 2, 1], false),
        ([1, 0, 2], false),
        ([1, 2, 0], true),
        ([2, 0, 1], true),
        ([2, 1, 0], false),
    ],
];

/// The box with elements of second order, in the same blocks: quadrilaterals of 9 and hexahedra of 27 nodes, or
/// triangles of 6 and tetrahedra of 10. `position` places a point of the box.
pub fn second_order(
    grid: &BoxMesh,
    simplices: bool,
    position: impl Fn([f64; 3]) -> [f64; 3],
) -> CellMesh {
    let dim = grid.dim();
    // Nodes are those of a box of half the step.
    let fine = BoxMesh {
        elements: grid.elements.map(|n| 2 * n),
        subdomains: grid.subdomains,
        ..*grid
    };
    let points = places(fine.nodes()).map(|p| position(fine.position(p)));
    let mut cells = Cells::default();
    let mut of_cell = Vec::new();
    let each = grid.block_elements();
    for place in places(grid.elements.map(|n| n.max(1))) {
        let block = [0, 1, 2].map(|d| place[d] / each[d].max(1));
        let [sx, sy, _] = grid.subdomains;
        let subdomain = ((block[2] * sy + block[1]) * sx + block[0]) as u32;
        let node = |at: [usize; 3]| fine.node([0, 1, 2].map(|d| 2 * place[d] + at[d])) as u32;
        for (kind, lattice) in shapes(dim, simplices) {
            let nodes: Vec<u32> = lattice.into_iter().map(node).collect();
            cells.push(kind, &nodes);
            of_cell.push(subdomain);
        }
    }
    let outer = |side: usize, p: [usize; 3]| p[side / 2] == [0, fine.elements[side / 2]][side % 2];
    let sides: Vec<Vec<(u32, u8)>> = (0..2 * dim)
        .map(|side| faces(&cells, |k| outer(side, fine.place(k))))
        .collect();
    let skin = sides.concat();
    let groups = (0..2 * dim).map(|side| SideGroup {
        name: SIDES[side].into(),
        nodes: fine.side_nodes(side).map(|p| fine.node(p) as u32).collect(),
        faces: sides[side].clone(),
    });
    let points: Vec<[f64; 3]> = points.collect();
    let mesh = CellMesh::new(dim, points, cells, groups.collect(), skin);
    mesh.partitioned(of_cell, grid.n_subdomains(), shared(&fine))
}

/// The kinds and nodes of the cells of an element, as places of a lattice of 3 × 3 (× 3).
fn shapes(dim: usize, simplices: bool) -> Vec<(CellKind, Vec<[usize; 3]>)> {
    let middle = |a: [usize; 3], b: [usize; 3]| [0, 1, 2].map(|d| (a[d] + b[d]) / 2);
    let with_middles = |kind: CellKind, corners: &[[usize; 3]]| {
        let mut nodes = corners.to_vec();
        for [a, b] in kind.edges() {
            nodes.push(middle(corners[usize::from(*a)], corners[usize::from(*b)]));
        }
        nodes
    };
    if !simplices {
        let (kind, corners) = match dim {
            2 => (CellKind::Quad9, &CORNERS[..4]),
            _ => (CellKind::Hex27, &CORNERS[..]),
        };
        let mut nodes = with_middles(kind, corners);
        match dim {
            2 => nodes.push([1, 1, 0]),
            _ => nodes.extend([
                [0, 1, 1],
                [2, 1, 1],
                [1, 0, 1],
                [1, 2, 1],
                [1, 1, 0],
                [1, 1, 2],
                [1, 1, 1],
            ]),
        }
        return vec![(kind, nodes)];
    }
    let kind = [CellKind::Triangle6, CellKind::Tet10][dim - 2];
    let simplex = |(axes, positive): &([usize; 3], bool)| {
        let mut at = [0; 3];
        let mut corners = vec![at];
        for &axis in &axes[..dim] {
            at[axis] = 2;
            corners.push(at);
        }
        if !positive {
            corners.swap(0, 1);
        }
        (kind, with_middles(kind, &corners))
    };
    WALKS[dim - 2].iter().map(simplex).collect()
}

/// The sides of cells all of whose nodes are on a side of the box.
fn faces(cells: &Cells, on: impl Fn(usize) -> bool) -> Vec<(u32, u8)> {
    let mut out = Vec::new();
    for c in 0..cells.len() {
        for side in 0..cells.kind(c).sides().len() {
            if cells.side_nodes(c, side).all(|k| on(k as usize)) {
                out.push((c as u32, side as u8));
            }
        }
    }
    out
}

/// Vertices, edges and faces of the blocks: those that several blocks share, as entities, and all corners of blocks.
fn shared(fine: &BoxMesh) -> Interface {
    let each = fine.block_elements();
    let dim = fine.dim();
    let mut out = Interface::default();
    let mut entities: std::collections::BTreeMap<(Vec<usize>, [usize; 3]), Vec<u32>> =
        Default::default();
    for place in places(fine.nodes()) {
        let along: Vec<usize> = (0..dim).filter(|&d| place[d] % each[d] != 0).collect();
        let node = fine.node(place) as u32;
        match along.len() {
            0 => out.vertices.push(node),
            n if n < dim && dim == 3 => {
                let mut start = place;
                along.iter().for_each(|&d| start[d] -= place[d] % each[d]);
                entities.entry((along, start)).or_default().push(node);
            }
            _ => {}
        }
    }
    for ((along, _), nodes) in entities {
        if fine.multiplicity(fine.place(nodes[0] as usize)) < 2 {
            continue;
        }
        match along.len() {
            1 => out.edges.push(nodes),
            _ => out.faces.push(nodes),
        }
    }
    out
}
