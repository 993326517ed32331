//! The mesh of a body, however it was made: what everything behind the meshes sees.
//!
//! A box is stored by its counts, whatever their size; a mesh of cells is stored cell by cell. Nodes, subdomains and
//! sides are numbers in both.

use std::sync::Arc;

use super::boxes::{places, BoxMesh};
use super::cell_mesh::CellMesh;

/// Names of the sides of boxes; the last two only in three dimensions.
pub const SIDES: [&str; 6] = ["left", "right", "bottom", "top", "back", "front"];

/// The mesh of a body.
#[derive(Debug, Clone, PartialEq)]
pub enum Mesh {
    /// A box of equal cells in equal blocks; scenes may bend it.
    Grid(BoxMesh),
    /// Cells of any kind in subdomains of any shape.
    Cells(Arc<CellMesh>),
}

impl From<BoxMesh> for Mesh {
    fn from(mesh: BoxMesh) -> Mesh {
        Mesh::Grid(mesh)
    }
}

impl From<CellMesh> for Mesh {
    fn from(mesh: CellMesh) -> Mesh {
        Mesh::Cells(Arc::new(mesh))
    }
}

impl Mesh {
    /// The box, if it is one.
    pub fn grid(&self) -> Option<&BoxMesh> {
        match self {
            Mesh::Grid(grid) => Some(grid),
            Mesh::Cells(_) => None,
        }
    }

    /// The mesh of cells, if it is one.
    pub fn cells(&self) -> Option<&CellMesh> {
        match self {
            Mesh::Grid(_) => None,
            Mesh::Cells(mesh) => Some(mesh),
        }
    }

    /// The dimension, 2 or 3.
    pub fn dim(&self) -> usize {
        match self {
            Mesh::Grid(grid) => grid.dim(),
            Mesh::Cells(mesh) => mesh.dim,
        }
    }

    /// Number of nodes.
    pub fn n_nodes(&self) -> usize {
        match self {
            Mesh::Grid(grid) => grid.n_nodes(),
            Mesh::Cells(mesh) => mesh.points.len(),
        }
    }

    /// Number of elements.
    pub fn n_elements(&self) -> usize {
        match self {
            Mesh::Grid(grid) => grid.n_elements(),
            Mesh::Cells(mesh) => mesh.cells.len(),
        }
    }

    /// Number of subdomains.
    pub fn n_subdomains(&self) -> usize {
        match self {
            Mesh::Grid(grid) => grid.n_subdomains(),
            Mesh::Cells(mesh) => mesh.parts.len(),
        }
    }

    /// Position of a node; of a box before it is bent.
    pub fn position(&self, node: usize) -> [f64; 3] {
        match self {
            Mesh::Grid(grid) => grid.position(grid.place(node)),
            Mesh::Cells(mesh) => mesh.points[node],
        }
    }

    /// The number of a node in messages: that of its file where it is from one.
    pub fn node_id(&self, node: usize) -> u64 {
        match self {
            Mesh::Grid(_) => node as u64,
            Mesh::Cells(mesh) => mesh.node_ids[node],
        }
    }

    /// The nodes of subdomain `s`, increasing.
    pub fn subdomain_nodes(&self, s: usize) -> Vec<usize> {
        match self {
            Mesh::Grid(grid) => grid.block(s).places().map(|p| grid.node(p)).collect(),
            Mesh::Cells(mesh) => mesh.parts.nodes(s).iter().map(|&k| k as usize).collect(),
        }
    }

    /// The subdomain of lowest number that contains the node.
    pub fn owner(&self, node: usize) -> usize {
        match self {
            Mesh::Grid(grid) => grid.owner(grid.place(node)),
            Mesh::Cells(mesh) => mesh.parts.sharers(node)[0] as usize,
        }
    }

    /// Number of subdomains that contain the node.
    pub fn multiplicity(&self, node: usize) -> usize {
        match self {
            Mesh::Grid(grid) => grid.multiplicity(grid.place(node)),
            Mesh::Cells(mesh) => mesh.parts.sharers(node).len(),
        }
    }

    /// Whether the node is a vertex of the partition. This includes corners of boxes that no subdomains share: they
    /// matter where bodies meet.
    pub fn is_vertex(&self, node: usize) -> bool {
        match self {
            Mesh::Grid(grid) => grid.is_vertex(grid.place(node)),
            Mesh::Cells(mesh) => mesh.parts.is_vertex(node),
        }
    }

    /// Number of nodes that subdomain `s` owns: those that no subdomain of lower number contains.
    pub fn n_owned(&self, s: usize) -> usize {
        match self {
            Mesh::Grid(grid) => owned_box(grid, s).1.iter().product(),
            Mesh::Cells(mesh) => mesh.parts.owned(s).len(),
        }
    }

    /// The owner of a node, and the place of the node among those that it owns.
    pub fn owned_rank(&self, node: usize) -> (usize, usize) {
        match self {
            Mesh::Grid(grid) => {
                let place = grid.place(node);
                let owner = grid.owner(place);
                let (first, [width, height, _]) = owned_box(grid, owner);
                let at = [0, 1, 2].map(|d| place[d] - first[d]);
                (owner, (at[2] * height + at[1]) * width + at[0])
            }
            Mesh::Cells(mesh) => (self.owner(node), mesh.parts.rank(node)),
        }
    }

    /// The node of place `rank` among those that subdomain `s` owns.
    pub fn owned_node(&self, s: usize, rank: usize) -> usize {
        match self {
            Mesh::Grid(grid) => {
                let (low, [width, height, _]) = owned_box(grid, s);
                let at = [rank % width, rank / width % height, rank / (width * height)];
                grid.node([0, 1, 2].map(|d| low[d] + at[d]))
            }
            Mesh::Cells(mesh) => mesh.parts.owned(s)[rank] as usize,
        }
    }

    /// Number of sides: those of the box, or the boundary groups and the whole boundary.
    pub fn n_sides(&self) -> usize {
        match self {
            Mesh::Grid(grid) => 2 * grid.dim(),
            Mesh::Cells(mesh) => mesh.sides.len(),
        }
    }

    /// The name of a side.
    pub fn side_name(&self, side: usize) -> &str {
        match self {
            Mesh::Grid(_) => SIDES[side],
            Mesh::Cells(mesh) => &mesh.sides[side].name,
        }
    }

    /// The side of this name.
    pub fn side_of_name(&self, name: &str) -> Option<usize> {
        (0..self.n_sides()).find(|&side| self.side_name(side) == name)
    }

    /// The sides that cover the boundary once: those of the box, or the whole boundary.
    pub fn outer_sides(&self) -> std::ops::Range<usize> {
        match self {
            Mesh::Grid(grid) => 0..2 * grid.dim(),
            Mesh::Cells(mesh) => mesh.skin()..mesh.sides.len(),
        }
    }

    /// The nodes of a side, increasing.
    pub fn side_nodes(&self, side: usize) -> Vec<usize> {
        match self {
            Mesh::Grid(grid) => grid.side_nodes(side).map(|p| grid.node(p)).collect(),
            Mesh::Cells(mesh) => {
                let nodes = mesh.sides[side].nodes.iter();
                nodes.map(|&k| k as usize).collect()
            }
        }
    }

    /// The nodes on the boundary, increasing.
    pub fn boundary(&self) -> Vec<usize> {
        match self {
            Mesh::Grid(grid) => grid.boundary().map(|p| grid.node(p)).collect(),
            Mesh::Cells(mesh) => self.side_nodes(mesh.skin()),
        }
    }

    /// Whether subdomain `s` has elements at a side.
    pub fn reaches(&self, s: usize, side: usize) -> bool {
        match self {
            Mesh::Grid(grid) => {
                let d = side / 2;
                grid.block(s).place[d] == [0, grid.subdomains[d] - 1][side % 2]
            }
            Mesh::Cells(mesh) => {
                let group = &mesh.sides[side];
                let has = |&node: &u32| mesh.parts.sharers(node as usize).contains(&(s as u32));
                group.nodes.iter().any(has)
            }
        }
    }

    /// The place of a subdomain in the body, for coefficients that follow it.
    pub fn subdomain_place(&self, s: usize) -> [usize; 3] {
        match self {
            Mesh::Grid(grid) => grid.block(s).place,
            Mesh::Cells(_) => [s, 0, 0],
        }
    }

    /// Subdomains in x, y and z; of a mesh of cells all in x.
    pub fn subdomain_counts(&self) -> [usize; 3] {
        match self {
            Mesh::Grid(grid) => grid.subdomains,
            Mesh::Cells(mesh) => [mesh.parts.len(), 1, 1],
        }
    }

    /// The nodes that several subdomains contain, increasing.
    pub fn shared_nodes(&self) -> Vec<usize> {
        match self {
            Mesh::Grid(grid) => {
                let each = grid.block_elements();
                let inner = |p: &[usize; 3]| (0..grid.dim()).any(|d| p[d] % each[d] == 0);
                let lines = places(grid.nodes()).filter(inner);
                let shared = lines.filter(|&p| grid.multiplicity(p) > 1);
                shared.map(|p| grid.node(p)).collect()
            }
            Mesh::Cells(mesh) => {
                let shared = |k: &usize| mesh.parts.sharers(*k).len() > 1;
                (0..mesh.points.len()).filter(shared).collect()
            }
        }
    }
}

/// The box of nodes that subdomain `s` owns: its first node and the numbers of nodes along each direction. Nodes at its
/// lower ends belong to the neighbours of lower number.
fn owned_box(mesh: &BoxMesh, s: usize) -> ([usize; 3], [usize; 3]) {
    let block = mesh.block(s);
    let (mut first, mut count) = ([0; 3], [0; 3]);
    for d in 0..3 {
        let inner = usize::from(block.place[d] > 0);
        first[d] = block.first[d] + inner;
        count[d] = block.elements[d] + 1 - inner;
    }
    (first, count)
}
