//! The graph that is dissected: dofs that no separator can part are one vertex.

use base::linalg::csr::Csr;

const NONE: u32 = u32::MAX;

/// The graph of the nodes: dofs whose rows have the same pattern, such as the components at a node of a mesh, are one
/// vertex. An elastic solid has a third of the vertices and a ninth of the edges.
pub(crate) struct Nodes {
    /// Its pattern; the values are zero.
    pub graph: Csr,
    /// The dofs of each node, increasing.
    pub members: Vec<Vec<u32>>,
}

impl Nodes {
    /// The nodes of these dofs.
    pub fn new(k: &Csr, interior: &[u32]) -> Nodes {
        // Dofs with the same pattern are neighbours of each other: each looks for the first one among its own.
        let mut node = vec![NONE; k.n()];
        let mut members: Vec<Vec<u32>> = Vec::new();
        for &i in interior {
            let col = k.row(i as usize).0;
            let like = |j: &&u32| node[**j as usize] != NONE && k.row(**j as usize).0 == col;
            let found = col.iter().find(like).map(|&j| node[j as usize]);
            let own = found.unwrap_or(members.len() as u32);
            if found.is_none() {
                members.push(Vec::new());
            }
            node[i as usize] = own;
            members[own as usize].push(i);
        }
        let mut graph = Csr {
            row_ptr: vec![0],
            ..Csr::default()
        };
        for dofs in &members {
            let (col, _) = k.row(dofs[0] as usize);
            let of = col.iter().map(|&j| (j, node[j as usize]));
            let first = of.filter(|&(j, v)| v != NONE && members[v as usize][0] == j);
            graph.col.extend(first.map(|(_, v)| v));
            graph.row_ptr.push(graph.col.len());
        }
        graph.val = vec![0.0; graph.col.len()];
        Nodes { graph, members }
    }
}
