//! Which subdomains have which nodes.

use crate::mesh::cells::Cells;

/// The subdomains that have each node.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Sharing {
    starts: Vec<u32>,
    parts: Vec<u32>,
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
        let mut starts = vec![0u32; n_nodes + 1];
        for (node, _) in pairs(cells, part, n, n_nodes) {
            starts[node as usize + 1] += 1;
        }
        for i in 0..n_nodes {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut parts = vec![0; starts[n_nodes] as usize];
        for (node, p) in pairs(cells, part, n, n_nodes) {
            let place = &mut next[node as usize];
            parts[*place as usize] = p;
            *place += 1;
        }
        Sharing { starts, parts, n }
    }

    /// The subdomains that have a node, increasing.
    pub fn of(&self, node: u32) -> &[u32] {
        let node = node as usize;
        &self.parts[self.starts[node] as usize..self.starts[node + 1] as usize]
    }

    /// Number of nodes.
    pub fn n_nodes(&self) -> usize {
        self.starts.len() - 1
    }

    /// The nodes that two subdomains or more have, increasing.
    pub fn shared(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.n_nodes() as u32).filter(|&node| self.of(node).len() > 1)
    }

    /// The copies of nodes that the cuts make: all nodes of all subdomains, less the nodes of the mesh.
    pub fn copies(&self) -> usize {
        self.shared().map(|node| self.of(node).len() - 1).sum()
    }
}

/// Every node of every part once, parts in increasing order.
fn pairs<'a>(
    cells: &'a Cells,
    part: &'a [u32],
    n: usize,
    n_nodes: usize,
) -> impl Iterator<Item = (u32, u32)> + 'a {
    let mut starts = vec![0usize; n + 1];
    part.iter().for_each(|&p| starts[p as usize + 1] += 1);
    for p in 0..n {
        starts[p + 1] += starts[p];
    }
    let mut order = vec![0u32; part.len()];
    for (&p, c) in part.iter().zip(0..) {
        order[starts[p as usize]] = c;
        starts[p as usize] += 1;
    }
    let mut last = vec![u32::MAX; n_nodes];
    let all = order.into_iter().flat_map(move |c| {
        let p = part[c as usize];
        cells.nodes(c as usize).iter().map(move |&node| (node, p))
    });
    all.filter(move |&(node, p)| std::mem::replace(&mut last[node as usize], p) != p)
}
