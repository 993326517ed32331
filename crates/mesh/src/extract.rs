//! From a mesh file to the meshes of bodies.

use std::borrow::Borrow;
use std::collections::HashMap;
use std::sync::Arc;

use super::cell_mesh::{CellMesh, SideGroup};
use super::cells::Cells;
use super::file::{Members, MeshFile};
use super::partition::{Adjacency, Components};
use base::linalg::lists::Lists;
use base::{Error, Result};

/// Most corners of a side of a cell.
const CORNERS: usize = 4;

/// The number that stands for "not in the body at hand".
const NONE: u32 = u32::MAX;

/// Takes the meshes of bodies out of a file. The time for a body grows with its own cells, not with those of the file.
#[derive(Debug, Clone)]
pub struct Extractor<F> {
    file: F,
    dim: usize,
    /// The members of all boundary groups: the group, and a place in the list of its members.
    members: Vec<(u32, u32)>,
    /// The members at each point: cells by their first node, and nodes.
    at_node: Lists,
    /// The members at each cell: its sides.
    at_cell: Lists,
    /// The node of the body at hand at each point of the file; `NONE` outside, and between bodies.
    local: Vec<u32>,
}

impl<F: Borrow<MeshFile>> Extractor<F> {
    /// Prepares a file whose bodies have cells of dimension `dim`.
    pub fn new(file: F, dim: usize) -> Extractor<F> {
        let of = file.borrow();
        let (mut members, mut at_node, mut at_cell) = (Vec::new(), Vec::new(), Vec::new());
        for (g, group) in (0..).zip(&of.groups) {
            let mut add = |list: &mut Vec<(usize, u32)>, place: u32, at: u32| {
                list.push((at as usize, members.len() as u32));
                members.push((g, place));
            };
            match &group.members {
                Members::Cells { dim: of_group, .. } if *of_group >= dim => {}
                Members::Cells { cells, .. } => {
                    for (place, &c) in (0..).zip(cells) {
                        add(&mut at_node, place, of.cells.nodes(c as usize)[0]);
                    }
                }
                Members::Nodes(list) => {
                    let places = (0..).zip(list);
                    places.for_each(|(place, &k)| add(&mut at_node, place, k));
                }
                Members::Sides(list) => {
                    let places = (0..).zip(list);
                    places.for_each(|(place, &(c, _))| add(&mut at_cell, place, c));
                }
            }
        }
        let (n_points, n_cells) = (of.points.len(), of.cells.len());
        Extractor {
            at_node: Lists::of(n_points, at_node.iter().copied()),
            at_cell: Lists::of(n_cells, at_cell.iter().copied()),
            local: vec![NONE; n_points],
            members,
            file,
            dim,
        }
    }

    /// The file.
    pub fn file(&self) -> &MeshFile {
        self.file.borrow()
    }

    /// The dimension of the cells of bodies.
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// The mesh of some cells, as places in the list of the file: nodes are numbered in the order of the file, and
    /// groups become boundary groups. Lengths are multiplied by `scale`.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) where three cells share a side.
    pub fn extract(&mut self, chosen: &[u32], scale: f64) -> Result<CellMesh> {
        let mut own = self.enter(chosen);
        own.sort_unstable();
        for (place, &k) in (0..).zip(&own) {
            self.local[k as usize] = place;
        }
        let mesh = self.mesh(chosen, &own, scale);
        self.leave(&own);
        mesh
    }

    /// The connected parts of some cells: cells are connected if they have a node in common.
    pub fn connected(&mut self, chosen: &[u32]) -> Vec<Vec<u32>> {
        let own = self.enter(chosen);
        let components = Components::by_nodes(&self.cells(chosen)).members();
        self.leave(&own);
        let parts = components.into_iter();
        let parts = parts.map(|part| part.into_iter().map(|c| chosen[c as usize]).collect());
        parts.collect()
    }

    /// Numbers the points of some cells in the order in which they come, and returns them.
    fn enter(&mut self, chosen: &[u32]) -> Vec<u32> {
        let mut own = Vec::new();
        for &c in chosen {
            for &k in self.file.borrow().cells.nodes(c as usize) {
                let place = &mut self.local[k as usize];
                if *place == NONE {
                    *place = own.len() as u32;
                    own.push(k);
                }
            }
        }
        own
    }

    /// Forgets the numbers of the points of a body.
    fn leave(&mut self, own: &[u32]) {
        own.iter().for_each(|&k| self.local[k as usize] = NONE);
    }

    /// Some cells with the body's numbers of nodes.
    fn cells(&self, chosen: &[u32]) -> Cells {
        let file = self.file();
        let mut cells = Cells::default();
        for &c in chosen {
            let nodes = file.cells.nodes(c as usize).iter();
            let nodes: Vec<u32> = nodes.map(|&k| self.local[k as usize]).collect();
            cells.push(file.cells.kind(c as usize), &nodes);
        }
        cells
    }

    /// The mesh of the body at hand, whose points are `own`.
    fn mesh(&self, chosen: &[u32], own: &[u32], scale: f64) -> Result<CellMesh> {
        let file = self.file();
        let points = own
            .iter()
            .map(|&k| file.points[k as usize].map(|x| scale * x));
        let points: Vec<[f64; 3]> = points.collect();
        let cells = self.cells(chosen);
        let cell_ids: Vec<u64> = chosen.iter().map(|&c| file.cell_ids[c as usize]).collect();
        let adjacency = Adjacency::new(&cells);
        if let Some(crowd) = adjacency.crowded.first() {
            let names: Vec<String> = crowd
                .iter()
                .map(|&(c, _)| cell_ids[c as usize].to_string())
                .collect();
            return Err(Error::input(format!(
                "{}: the cells {} share one side (two cells at most were expected)",
                file.name,
                names.join(", ")
            )));
        }
        let skin = adjacency.boundary.clone();
        let sides = SkinSides::new(&cells, &skin);
        let groups = self.members(chosen, own);
        let groups = groups
            .chunk_by(|a, b| a.group == b.group)
            .filter_map(|members| sides.group(file, self.dim, members, &self.local));
        let groups: Vec<SideGroup> = groups.collect();
        let mut mesh = CellMesh::new(self.dim, points, cells, groups, skin);
        mesh.node_ids = own.iter().map(|&k| file.node_ids[k as usize]).collect();
        mesh.cell_ids = cell_ids;
        mesh.resolution = scale.abs() * file.resolution;
        mesh.adjacency = Some(Arc::new(adjacency));
        Ok(mesh)
    }

    /// The members of groups that may belong to the body at hand, by group and place.
    fn members(&self, chosen: &[u32], own: &[u32]) -> Vec<Member> {
        let member = |&k: &u32, cell: usize| {
            let (group, place) = self.members[k as usize];
            Member {
                group: group as usize,
                place: place as usize,
                cell: cell as u32,
            }
        };
        let at_nodes = own.iter().flat_map(|&k| self.at_node.at(k as usize));
        let at_nodes = at_nodes.map(|k| member(k, 0));
        let at_cells = chosen.iter().enumerate().flat_map(|(inside, &c)| {
            let list = self.at_cell.at(c as usize).iter();
            list.map(move |k| member(k, inside))
        });
        let mut found: Vec<Member> = at_nodes.chain(at_cells).collect();
        found.sort_unstable();
        found
    }
}

/// A member of a group that may belong to the body at hand.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Member {
    group: usize,
    /// Its place in the list of the group.
    place: usize,
    /// The body's cell, if the member is the side of one.
    cell: u32,
}

/// The sides on the skin of a mesh, by their corners.
struct SkinSides<'a> {
    cells: &'a Cells,
    skin: &'a [(u32, u8)],
    by_corners: HashMap<[u32; CORNERS], (u32, u8)>,
}

impl<'a> SkinSides<'a> {
    fn new(cells: &'a Cells, skin: &'a [(u32, u8)]) -> SkinSides<'a> {
        let corners = |&(c, side): &(u32, u8)| {
            let (c, place) = (c as usize, usize::from(side));
            let n = cells.kind(c).sides()[place].kind.corners();
            (key(cells.side_nodes(c, place).take(n)), (c as u32, side))
        };
        SkinSides {
            cells,
            skin,
            by_corners: skin.iter().map(corners).collect(),
        }
    }

    /// The part of a group that belongs to the body: `members` are those of one group, `local` has the node of the body
    /// of each node of the file. `None` if there is none.
    fn group(
        &self,
        file: &MeshFile,
        dim: usize,
        members: &[Member],
        local: &[u32],
    ) -> Option<SideGroup> {
        let group = &file.groups[members.first()?.group];
        let mut nodes = Vec::new();
        let mut faces = Vec::new();
        match &group.members {
            Members::Cells { cells, dim: of } => {
                for c in members.iter().map(|m| cells[m.place] as usize) {
                    let all = file.cells.nodes(c).iter();
                    let own: Vec<u32> = all.map(|&k| local[k as usize]).collect();
                    if own.contains(&NONE) {
                        continue;
                    }
                    let corners = file.cells.kind(c).corners();
                    nodes.extend(&own);
                    if of + 1 == dim {
                        faces.extend(self.by_corners.get(&key(own[..corners].iter().copied())));
                    }
                }
            }
            Members::Nodes(list) => {
                nodes.extend(members.iter().map(|m| local[list[m.place] as usize]));
                nodes.sort_unstable();
                // Faces with all their nodes in the group belong to it: surfaces may be given by nodes.
                let has = |&(c, side): &(u32, u8)| {
                    let mut of_side = self.cells.side_nodes(c as usize, side.into());
                    of_side.all(|k| nodes.binary_search(&k).is_ok())
                };
                faces.extend(self.skin.iter().filter(|face| has(face)));
            }
            Members::Sides(list) => {
                for member in members {
                    let side = list[member.place].1;
                    faces.push((member.cell, side));
                    nodes.extend(self.cells.side_nodes(member.cell as usize, side.into()));
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

#[cfg(test)]
#[path = "../tests/extract.rs"]
mod tests;
