//! Cells with names become a mesh as a file has it.

use std::collections::HashMap;

use elements::kind::CellKind;
use mesh::{Cells, Members, MeshFile, MeshGroup};

/// Names of cells and sides as the numbers of their groups; 0: in no group.
pub(crate) struct GroupNumbers<'a> {
    /// All names, number 1 first.
    pub names: &'a [&'a str],
    /// The group of each cell.
    pub of_cell: Vec<usize>,
}

/// Makes the mesh. `side` says in which group a side is that lies on the surface or between two cells of different
/// groups, by the middle of its corners and the groups of the cells beside it (0: none).
pub(crate) fn build(
    name: &str,
    points: Vec<[f64; 3]>,
    kind: CellKind,
    cells: &[Vec<u32>],
    groups: &GroupNumbers,
    side: impl Fn([f64; 3], [usize; 2]) -> usize,
) -> MeshFile {
    let mut file = MeshFile {
        name: name.to_string(),
        node_ids: (1..=points.len() as u64).collect(),
        points,
        ..MeshFile::default()
    };
    let mut members = vec![Vec::new(); groups.names.len() + 1];
    let mut beside: HashMap<[u32; 3], (u32, u8, [usize; 2])> = HashMap::new();
    for (c, nodes) in cells.iter().enumerate() {
        let group = groups.of_cell[c];
        members[group].push(file.cells.len() as u32);
        file.cells.push(kind, nodes);
        for (s, of) in kind.sides().iter().enumerate() {
            let mut key = [u32::MAX; 3];
            for (k, &place) in key.iter_mut().zip(&of.nodes[..kind.dim()]) {
                *k = nodes[usize::from(place)];
            }
            key.sort_unstable();
            let place = (c as u32, s as u8, [group, 0]);
            beside
                .entry(key)
                .and_modify(|(_, _, g)| g[1] = group)
                .or_insert(place);
        }
    }
    // In the order of cells, not of a hash.
    let mut sides: Vec<_> = beside
        .into_values()
        .filter(|(_, _, g)| g[0] != g[1])
        .collect();
    sides.sort_unstable();
    let mut wanted = Cells::default();
    for (c, s, beside) in sides {
        let of = &kind.sides()[usize::from(s)];
        let nodes: Vec<u32> = file.cells.side_nodes(c as usize, usize::from(s)).collect();
        let corners = &nodes[..kind.dim()];
        let mut middle = [0.0; 3];
        for &n in corners {
            for (m, x) in middle.iter_mut().zip(file.points[n as usize]) {
                *m += x / corners.len() as f64;
            }
        }
        let group = side(middle, beside);
        if group > 0 {
            members[group].push((file.cells.len() + wanted.len()) as u32);
            wanted.push(of.kind, &nodes);
        }
    }
    for (kind, nodes) in wanted.iter() {
        file.cells.push(kind, nodes);
    }
    file.cell_ids = (1..=file.cells.len() as u64).collect();
    let filled = groups.names.iter().zip(&members[1..]);
    file.groups = filled
        .map(|(name, cells)| MeshGroup {
            name: name.to_string(),
            members: Members::Cells {
                dim: cells
                    .first()
                    .map_or(0, |&c| file.cells.kind(c as usize).dim()),
                cells: cells.clone(),
            },
        })
        .collect();
    file
}
