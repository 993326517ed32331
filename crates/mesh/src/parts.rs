//! The subdomains of a mesh of cells: their cells, their nodes, and what they share.

use super::partition::{Interface, Sharing};
use base::linalg::lists::Lists;

/// A partition of a mesh of cells into subdomains.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MeshPartition {
    /// The subdomain of every cell.
    of_cell: Vec<u32>,
    cells: Lists,
    nodes: Lists,
    sharing: Sharing,
    owned: Lists,
    /// The place of every node among those that its owner owns.
    rank: Vec<u32>,
    vertex: Vec<bool>,
    /// Dimension and nodes of every shared edge and face.
    entities: Vec<(usize, Vec<u32>)>,
    /// The shared edges and faces of every subdomain.
    beside: Lists,
}

impl MeshPartition {
    /// The partition, given the subdomain of every cell, and what the subdomains share.
    pub fn new(of_cell: Vec<u32>, sharing: Sharing, shared: Interface) -> MeshPartition {
        let (n, n_nodes) = (sharing.n, sharing.n_nodes());
        let cells = Lists::of(n, of_cell.iter().zip(0..).map(|(&s, c)| (s as usize, c)));
        let nodes = (0..n_nodes as u32).flat_map(|k| {
            let sharers = sharing.of(k).iter();
            sharers.map(move |&s| (s as usize, k))
        });
        let nodes = Lists::of(n, nodes);
        let owner = |k: u32| sharing.of(k).first().map(|&s| s as usize);
        let owned = Lists::of(n, (0..n_nodes as u32).filter_map(|k| Some((owner(k)?, k))));
        let mut rank = vec![0; n_nodes];
        for list in owned.iter() {
            for (k, &node) in list.iter().enumerate() {
                rank[node as usize] = k as u32;
            }
        }
        let mut vertex = vec![false; n_nodes];
        shared
            .vertices
            .iter()
            .for_each(|&k| vertex[k as usize] = true);
        let edges = shared.edges.into_iter().map(|list| (1, list));
        let faces = shared.faces.into_iter().map(|list| (2, list));
        let entities: Vec<(usize, Vec<u32>)> = edges.chain(faces).collect();
        let beside = entities.iter().enumerate().flat_map(|(e, (_, list))| {
            let sharers = list.first().map_or(&[][..], |&node| sharing.of(node));
            sharers.iter().map(move |&s| (s as usize, e as u32))
        });
        let beside = Lists::of(n, beside);
        MeshPartition {
            of_cell,
            cells,
            nodes,
            owned,
            rank,
            vertex,
            entities,
            beside,
            sharing,
        }
    }

    /// Makes some shared nodes, in increasing order, vertices: they leave the edges and faces that they are on.
    pub fn make_vertices(&mut self, nodes: &[u32]) {
        nodes.iter().for_each(|&k| self.vertex[k as usize] = true);
        for (_, list) in &mut self.entities {
            list.retain(|k| nodes.binary_search(k).is_err());
        }
    }

    /// Number of subdomains.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The subdomain of a cell.
    pub fn of_cell(&self, cell: usize) -> usize {
        self.of_cell[cell] as usize
    }

    /// The cells of a subdomain, increasing.
    pub fn cells(&self, s: usize) -> &[u32] {
        self.cells.at(s)
    }

    /// The nodes of a subdomain, increasing.
    pub fn nodes(&self, s: usize) -> &[u32] {
        self.nodes.at(s)
    }

    /// The subdomains that contain a node, increasing.
    pub fn sharers(&self, node: usize) -> &[u32] {
        self.sharing.of(node as u32)
    }

    /// The nodes that a subdomain owns: those that no subdomain of lower number contains.
    pub fn owned(&self, s: usize) -> &[u32] {
        self.owned.at(s)
    }

    /// The place of a node among those of its owner.
    pub fn rank(&self, node: usize) -> usize {
        self.rank[node] as usize
    }

    /// Whether continuity at the node is primal.
    pub fn is_vertex(&self, node: usize) -> bool {
        self.vertex[node]
    }

    /// The shared edges (dimension 1) and faces (2) of a subdomain: number, dimension and nodes.
    pub fn entities(&self, s: usize) -> impl Iterator<Item = (usize, usize, &[u32])> {
        let list = self.beside.at(s).iter();
        list.map(|&e| {
            let (dim, nodes) = &self.entities[e as usize];
            (e as usize, *dim, &nodes[..])
        })
    }

    /// Dimension and nodes of all shared edges and faces.
    pub fn all_entities(&self) -> &[(usize, Vec<u32>)] {
        &self.entities
    }
}
