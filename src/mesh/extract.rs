//! From a mesh file to the meshes of bodies.

use std::collections::HashMap;

use super::cell_mesh::{CellMesh, SideGroup};
use super::cells::Cells;
use super::file::{Group, Members, MeshFile};
use super::partition::{Adjacency, Components};
use crate::error::{Error, Result};

/// Most corners of a side of a cell.
const CORNERS: usize = 4;

/// The mesh of some cells of a file, as places in its list: nodes are numbered in the order of the file, and groups
/// become boundary groups. Lengths are multiplied by `scale`.
///
/// # Errors
/// [`Error::Input`] where three cells share a side.
pub fn extract(file: &MeshFile, dim: usize, chosen: &[u32], scale: f64) -> Result<CellMesh> {
    let mut local = vec![u32::MAX; file.points.len()];
    for &c in chosen {
        for &k in file.cells.nodes(c as usize) {
            local[k as usize] = 0;
        }
    }
    let mut points = Vec::new();
    let mut node_ids = Vec::new();
    for (k, place) in local.iter_mut().enumerate() {
        if *place != u32::MAX {
            *place = points.len() as u32;
            points.push(file.points[k].map(|x| scale * x));
            node_ids.push(file.node_ids[k]);
        }
    }
    let mut cells = Cells::default();
    let mut of_file = HashMap::with_capacity(chosen.len());
    for &c in chosen {
        let nodes = file.cells.nodes(c as usize).iter();
        let nodes: Vec<u32> = nodes.map(|&k| local[k as usize]).collect();
        of_file.insert(c, cells.len() as u32);
        cells.push(file.cells.kind(c as usize), &nodes);
    }
    let cell_ids: Vec<u64> = chosen.iter().map(|&c| file.cell_ids[c as usize]).collect();
    let adjacency = Adjacency::new(&cells);
    if let Some(crowd) = adjacency.crowded.first() {
        let names: Vec<String> = crowd
            .iter()
            .map(|&(c, _)| cell_ids[c as usize].to_string())
            .collect();
        return Err(Error::Input(format!(
            "{}: the cells {} share one side (two cells at most were expected)",
            file.name,
            names.join(", ")
        )));
    }
    let skin = adjacency.boundary;
    let sides = Sides::new(&cells, &skin);
    let groups = file.groups.iter();
    let groups = groups.filter_map(|group| sides.group(file, group, dim, &local, &of_file));
    let groups: Vec<SideGroup> = groups.collect();
    let mut mesh = CellMesh::new(dim, points, cells, groups, skin);
    mesh.node_ids = node_ids;
    mesh.cell_ids = cell_ids;
    Ok(mesh)
}

/// The connected parts of some cells of a file: cells are connected if they have a node in common.
pub fn connected(file: &MeshFile, chosen: &[u32]) -> Vec<Vec<u32>> {
    let mut cells = Cells::default();
    for &c in chosen {
        cells.push(file.cells.kind(c as usize), file.cells.nodes(c as usize));
    }
    let components = Components::by_nodes(&cells).members();
    let parts = components.into_iter();
    let parts = parts.map(|part| part.into_iter().map(|c| chosen[c as usize]).collect());
    parts.collect()
}

/// The sides on the skin of a mesh, by their corners.
struct Sides<'a> {
    cells: &'a Cells,
    skin: &'a [(u32, u8)],
    by_corners: HashMap<[u32; CORNERS], (u32, u8)>,
}

impl<'a> Sides<'a> {
    fn new(cells: &'a Cells, skin: &'a [(u32, u8)]) -> Sides<'a> {
        let corners = |&(c, side): &(u32, u8)| {
            let (c, place) = (c as usize, usize::from(side));
            let n = cells.kind(c).sides()[place].kind.corners();
            (key(cells.side_nodes(c, place).take(n)), (c as u32, side))
        };
        Sides {
            cells,
            skin,
            by_corners: skin.iter().map(corners).collect(),
        }
    }

    /// The part of a group that belongs to the body: `local` has the node of the body of each node of the file,
    /// `of_file` the cell of each cell. `None` if there is none.
    fn group(
        &self,
        file: &MeshFile,
        group: &Group,
        dim: usize,
        local: &[u32],
        of_file: &HashMap<u32, u32>,
    ) -> Option<SideGroup> {
        let mut nodes = Vec::new();
        let mut faces = Vec::new();
        match &group.members {
            Members::Cells { dim: of, .. } if *of >= dim => return None,
            Members::Cells { cells, dim: of } => {
                for &c in cells {
                    let all = file.cells.nodes(c as usize);
                    let own: Vec<u32> = all.iter().map(|&k| local[k as usize]).collect();
                    if own.contains(&u32::MAX) {
                        continue;
                    }
                    let corners = file.cells.kind(c as usize).corners();
                    nodes.extend(&own);
                    if of + 1 == dim {
                        faces.extend(self.by_corners.get(&key(own[..corners].iter().copied())));
                    }
                }
            }
            Members::Nodes(list) => {
                let own = list.iter().map(|&k| local[k as usize]);
                nodes.extend(own.filter(|&k| k != u32::MAX));
                nodes.sort_unstable();
                // Faces with all their nodes in the group belong to it: surfaces may be given by nodes.
                let has = |&(c, side): &(u32, u8)| {
                    let mut of_side = self.cells.side_nodes(c as usize, side.into());
                    of_side.all(|k| nodes.binary_search(&k).is_ok())
                };
                faces.extend(self.skin.iter().filter(|face| has(face)));
            }
            Members::Sides(list) => {
                for &(c, side) in list {
                    if let Some(&c) = of_file.get(&c) {
                        faces.push((c, side));
                        nodes.extend(self.cells.side_nodes(c as usize, side.into()));
                    }
                }
            }
        }
        nodes.sort_unstable();
        nodes.dedup();
        faces.sort_unstable();
        faces.dedup();
        (!nodes.is_empty()).then(|| SideGroup {
            name: group.name.clone(),
            nodes,
            faces,
        })
    }
}

/// The corners of a side in increasing order.
fn key(corners: impl Iterator<Item = u32>) -> [u32; CORNERS] {
    let mut out = [u32::MAX; CORNERS];
    for (place, corner) in out.iter_mut().zip(corners) {
        *place = corner;
    }
    out.sort_unstable();
    out
}
