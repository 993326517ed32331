//! Which cells have which nodes.

use crate::mesh::cells::Cells;

/// The cells at every node.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Incidence {
    starts: Vec<u32>,
    cells: Vec<u32>,
}

impl Incidence {
    /// For nodes in 0..`n_nodes`.
    ///
    /// # Panics
    /// When the cells have 2³² nodes or more, each counted in each of its cells, or nodes beyond `n_nodes`.
    pub fn new(cells: &Cells, n_nodes: usize) -> Incidence {
        assert!(
            u32::try_from(cells.all_nodes().len()).is_ok(),
            "less than 2³² nodes of cells"
        );
        let mut starts = vec![0u32; n_nodes + 1];
        for &node in cells.all_nodes() {
            starts[node as usize + 1] += 1;
        }
        for i in 0..n_nodes {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut around = vec![0; cells.all_nodes().len()];
        for c in 0..cells.len() {
            for &node in cells.nodes(c) {
                around[next[node as usize] as usize] = c as u32;
                next[node as usize] += 1;
            }
        }
        Incidence {
            starts,
            cells: around,
        }
    }

    /// Number of nodes.
    pub fn n_nodes(&self) -> usize {
        self.starts.len() - 1
    }

    /// The cells that have a node, increasing.
    pub fn cells(&self, node: u32) -> &[u32] {
        let node = node as usize;
        &self.cells[self.starts[node] as usize..self.starts[node + 1] as usize]
    }
}
