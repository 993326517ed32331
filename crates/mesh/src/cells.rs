//! A list of cells of any kind.

use base::linalg::lists::Lists;
use elements::kind::CellKind;

/// Cells of any kind, one after the other: the kind and the nodes of each.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cells {
    kinds: Vec<CellKind>,
    /// Where the nodes of each cell begin in `nodes`, and the end of the last.
    starts: Vec<usize>,
    nodes: Vec<u32>,
}

impl Default for Cells {
    fn default() -> Cells {
        Cells {
            kinds: Vec::new(),
            starts: vec![0],
            nodes: Vec::new(),
        }
    }
}

impl Cells {
    /// Adds a cell.
    ///
    /// # Panics
    /// When the kind has another number of nodes.
    pub fn push(&mut self, kind: CellKind, nodes: &[u32]) {
        assert_eq!(nodes.len(), kind.nodes(), "a {}", kind.name());
        self.kinds.push(kind);
        self.nodes.extend_from_slice(nodes);
        self.starts.push(self.nodes.len());
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.kinds.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.kinds.is_empty()
    }

    /// The kind of cell `c`.
    pub fn kind(&self, c: usize) -> CellKind {
        self.kinds[c]
    }

    /// The kinds of all cells.
    pub fn kinds(&self) -> &[CellKind] {
        &self.kinds
    }

    /// The nodes of cell `c`.
    pub fn nodes(&self, c: usize) -> &[u32] {
        &self.nodes[self.starts[c]..self.starts[c + 1]]
    }

    /// The nodes of cell `c`, to put them into another order.
    pub(super) fn nodes_mut(&mut self, c: usize) -> &mut [u32] {
        &mut self.nodes[self.starts[c]..self.starts[c + 1]]
    }

    /// The nodes of all cells, one cell after the other.
    pub fn all_nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// One more than the highest number of a node.
    pub fn n_nodes(&self) -> usize {
        self.nodes.iter().max().map_or(0, |&k| k as usize + 1)
    }

    /// Kind and nodes of all cells, in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (CellKind, &[u32])> {
        (0..self.len()).map(|c| (self.kinds[c], self.nodes(c)))
    }

    /// The cells that have each of the nodes 0..`n_nodes`, increasing.
    ///
    /// # Panics
    /// When a cell has a node beyond `n_nodes`.
    pub fn around_nodes(&self, n_nodes: usize) -> Lists {
        let of_cell = |c: usize| self.nodes(c).iter().map(move |&k| (k as usize, c as u32));
        Lists::of(n_nodes, (0..self.len()).flat_map(of_cell))
    }

    /// The nodes of side `side` of cell `c`, in the order of [`CellKind::sides`].
    pub fn side_nodes(&self, c: usize, side: usize) -> impl ExactSizeIterator<Item = u32> + '_ {
        let nodes = self.nodes(c);
        let places = self.kind(c).sides()[side].nodes;
        places.iter().map(move |&p| nodes[usize::from(p)])
    }
}
