//! Which subdomains have which nodes.

use crate::cells::Cells;
use base::linalg::lists::Lists;

/// The subdomains that have each node.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Sharing {
    parts: Lists,
    /// Number of subdomains.
    pub n: usize,
}

impl Sharing {
    /// For nodes in 0..`n_nodes`, and cells in the parts 0..`n`.
    ///
    /// # Panics
    /// When a part is not below `n`, or a node not below `n_nodes`.
    pub fn new(cells: &Cells, part: &[u32], n: usize, n_nodes: usize) -> Sharing {
        assert_eq!(cells.len(), part.len(), "the part of every cell");
        let numbered = part.iter().zip(0..);
        let members = Lists::of(n, numbered.map(|(&p, c)| (p as usize, c)));
        let of_part = |p: usize| {
            let nodes = members.at(p).iter().flat_map(|&c| cells.nodes(c as usize));
            nodes.map(move |&node| (node as usize, p as u32))
        };
        // Parts follow each other, so that a node of several cells of a part was there last.
        let mut last = vec![u32::MAX; n_nodes];
        let new = move |&(node, p): &(usize, u32)| std::mem::replace(&mut last[node], p) != p;
        Sharing {
            parts: Lists::of(n_nodes, (0..n).flat_map(of_part).filter(new)),
            n,
        }
    }

    /// The subdomains that have a node, increasing.
    pub fn of(&self, node: u32) -> &[u32] {
        self.parts.at(node as usize)
    }

    /// Number of nodes.
    pub fn n_nodes(&self) -> usize {
        self.parts.len()
    }

    /// The nodes that two subdomains or more have, increasing.
    pub fn shared(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.n_nodes() as u32).filter(|&node| self.of(node).len() > 1)
    }
}
