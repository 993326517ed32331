//! The mesh of a body as a list of cells, with its boundary groups and its partition.

use std::sync::Arc;

use super::cells::Cells;
use super::partition::{Adjacency, Interface, Sharing};
use super::parts::MeshPartition;

/// A part of the boundary of a mesh of cells.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SideGroup {
    /// Its name.
    pub name: String,
    /// Its nodes, increasing.
    pub nodes: Vec<u32>,
    /// Its sides of cells: the cell, and the side of its kind.
    pub faces: Vec<(u32, u8)>,
}

/// The name of the whole boundary among the boundary groups.
pub const SKIN: &str = "all";

/// The mesh of a body: cells of one dimension, 2 or 3.
#[derive(Debug, Clone, PartialEq)]
pub struct CellMesh {
    /// The dimension, 2 or 3.
    pub dim: usize,
    /// Position of every node; z is 0 in the plane.
    pub points: Vec<[f64; 3]>,
    /// The number of every node in its file.
    pub node_ids: Vec<u64>,
    /// The length that one unit in the last digit of a coordinate stands for; 0 where they are exact. Directions that
    /// follow from positions are known to this length divided by that of an edge.
    pub resolution: f64,
    /// The cells.
    pub cells: Cells,
    /// The number of every cell in its file.
    pub cell_ids: Vec<u64>,
    /// The named boundary groups, then the whole boundary, [`SKIN`].
    pub sides: Vec<SideGroup>,
    /// The partition into subdomains.
    pub parts: MeshPartition,
    /// Which cells share sides, from the extraction of the mesh until it is cut.
    pub(super) adjacency: Option<Arc<Adjacency>>,
}

impl CellMesh {
    /// A mesh in one subdomain. `groups` are the boundary groups; the whole boundary is added.
    pub fn new(
        dim: usize,
        points: Vec<[f64; 3]>,
        cells: Cells,
        mut groups: Vec<SideGroup>,
        skin: Vec<(u32, u8)>,
    ) -> CellMesh {
        let mut on_skin: Vec<u32> = skin
            .iter()
            .flat_map(|&(c, side)| cells.side_nodes(c as usize, side.into()))
            .collect();
        on_skin.sort_unstable();
        on_skin.dedup();
        groups.push(SideGroup {
            name: SKIN.into(),
            nodes: on_skin,
            faces: skin,
        });
        let of_cell = vec![0; cells.len()];
        let sharing = Sharing::new(&cells, &of_cell, 1, points.len());
        let parts = MeshPartition::new(of_cell, sharing, Interface::default());
        CellMesh {
            dim,
            node_ids: (1..=points.len() as u64).collect(),
            resolution: 0.0,
            cell_ids: (1..=cells.len() as u64).collect(),
            points,
            cells,
            sides: groups,
            parts,
            adjacency: None,
        }
    }

    /// This mesh in `n` other subdomains, given the subdomain of every cell and the interface of the subdomains.
    #[must_use]
    pub fn partitioned(mut self, of_cell: Vec<u32>, n: usize, shared: Interface) -> CellMesh {
        let sharing = Sharing::new(&self.cells, &of_cell, n, self.points.len());
        self.parts = MeshPartition::new(of_cell, sharing, shared);
        self
    }

    /// Which cells share sides: found once for a mesh that comes from a file, whose cells must not change.
    pub fn adjacency(&self) -> Arc<Adjacency> {
        let known = self.adjacency.clone();
        known.unwrap_or_else(|| Arc::new(Adjacency::new(&self.cells)))
    }

    /// Frees what [`CellMesh::adjacency`] knows.
    pub fn forget_adjacency(&mut self) {
        self.adjacency = None;
    }

    /// The positions of the nodes of a cell.
    pub fn cell_points(&self, cell: usize) -> Vec<[f64; 3]> {
        let nodes = self.cells.nodes(cell).iter();
        nodes.map(|&k| self.points[k as usize]).collect()
    }

    /// Number of the side group of the whole boundary.
    pub fn skin(&self) -> usize {
        self.sides.len() - 1
    }
}
