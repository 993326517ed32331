//! The subdomains of a mesh of cells: their cells, their nodes, and what they share.

use super::cells::Cells;
use super::lists::Lists;

/// Nodes that subdomains share, by what they become in the method.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SharedNodes {
    /// Nodes at which continuity is primal, increasing.
    pub vertices: Vec<u32>,
    /// Open edges of a solid: nodes, increasing.
    pub edges: Vec<Vec<u32>>,
    /// Open faces of a solid: nodes, increasing.
    pub faces: Vec<Vec<u32>>,
}

/// A partition of a mesh of cells into subdomains.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Parts {
    /// The subdomain of every cell.
    of_cell: Vec<u32>,
    cells: Lists,
    nodes: Lists,
    sharers: Lists,
    owned: Lists,
    /// The place of every node among those that its owner owns.
    rank: Vec<u32>,
    vertex: Vec<bool>,
    /// Dimension and nodes of every shared edge and face.
    entities: Vec<(usize, Vec<u32>)>,
    /// The shared edges and faces of every subdomain.
    beside: Lists,
}

impl Parts {
    /// The partition into `n` subdomains, given the subdomain of every cell and the roles of shared nodes.
    pub fn new(
        cells: &Cells,
        n_nodes: usize,
        of_cell: Vec<u32>,
        n: usize,
        shared: SharedNodes,
    ) -> Parts {
        let numbered = of_cell.iter().enumerate();
        let in_part = Lists::of(n, numbered.map(|(c, &s)| (s as usize, c as u32)));
        let mut nodes = Lists::default();
        let mut seen = vec![u32::MAX; n_nodes];
        for s in 0..n {
            let mut list = Vec::new();
            for &c in in_part.at(s) {
                for &node in cells.nodes(c as usize) {
                    if seen[node as usize] != s as u32 {
                        seen[node as usize] = s as u32;
                        list.push(node);
                    }
                }
            }
            list.sort_unstable();
            nodes.push(list);
        }
        let pairs = (0..n).flat_map(|s| nodes.at(s).iter().map(move |&k| (k as usize, s as u32)));
        let sharers = Lists::of(n_nodes, pairs);
        let owner = |node: usize| sharers.at(node).first().map(|&s| s as usize);
        let owners = (0..n_nodes).filter_map(|k| Some((owner(k)?, k as u32)));
        let owned = Lists::of(n, owners);
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
            let sharers = list
                .first()
                .map_or(&[][..], |&node| sharers.at(node as usize));
            sharers.iter().map(move |&s| (s as usize, e as u32))
        });
        let beside = Lists::of(n, beside);
        Parts {
            of_cell,
            cells: in_part,
            nodes,
            owned,
            rank,
            vertex,
            entities,
            beside,
            sharers,
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
        self.sharers.at(node)
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
