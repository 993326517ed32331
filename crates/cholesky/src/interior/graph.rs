//! The graph of the interior and its elimination tree in a given order.

use base::linalg::csr::Csr;
use petsc::ordering::Graph;

/// No vertex.
pub const NONE: u32 = u32::MAX;

/// The graph of `k` on the dofs of `inside`, which become the vertices 0, 1, ….
pub fn graph_of(k: &Csr, inside: &[u32]) -> Graph {
    let mut vertex = vec![NONE; k.n()];
    for (v, &i) in inside.iter().enumerate() {
        vertex[i as usize] = v as u32;
    }
    let mut graph = Graph {
        row: vec![0],
        col: Vec::with_capacity(k.nnz()),
    };
    // Dofs of `inside` increase, so columns come out sorted.
    for (v, &i) in inside.iter().enumerate() {
        let neighbours = k.row(i as usize).0.iter().map(|&j| vertex[j as usize]);
        let others = neighbours.filter(|&w| w != NONE && w as usize != v);
        graph.col.extend(others.map(|w| w as i32));
        graph.row.push(graph.col.len() as i32);
    }
    graph
}

/// The neighbours of a vertex.
pub fn neighbours(graph: &Graph, v: u32) -> &[i32] {
    let v = v as usize;
    &graph.col[graph.row[v] as usize..graph.row[v + 1] as usize]
}

/// The elimination tree (Liu 1990) of an order of the vertices; its entries are positions in this order.
pub struct Tree {
    /// The parent, `NONE` at a root.
    pub parent: Vec<u32>,
    /// The vertices in the order.
    pub order: Vec<u32>,
    place: Vec<u32>,
}

impl Tree {
    /// The tree of `order`.
    pub fn new(graph: &Graph, order: Vec<u32>) -> Tree {
        let n = order.len();
        let mut place = vec![0; n];
        for (p, &v) in order.iter().enumerate() {
            place[v as usize] = p as u32;
        }
        let (mut parent, mut ancestor) = (vec![NONE; n], vec![NONE; n]);
        for (p, &v) in order.iter().enumerate() {
            let p = p as u32;
            for &w in neighbours(graph, v) {
                let mut q = place[w as usize];
                // Walks up to the root and shortens the path on the way.
                while q < p {
                    let next = std::mem::replace(&mut ancestor[q as usize], p);
                    if next == NONE {
                        parent[q as usize] = p;
                        break;
                    }
                    q = next;
                }
            }
        }
        Tree {
            parent,
            order,
            place,
        }
    }

    /// The same tree in postorder: the fill is the same, and columns of similar pattern are adjacent.
    pub fn postordered(self, graph: &Graph) -> Tree {
        let n = self.order.len();
        let (mut first, mut next) = (vec![NONE; n], vec![NONE; n]);
        let mut roots = NONE;
        // Goes from the last position to the first, which makes the lists of children increase.
        for p in (0..n).rev() {
            let head = match self.parent[p] {
                NONE => &mut roots,
                q => &mut first[q as usize],
            };
            next[p] = std::mem::replace(head, p as u32);
        }
        let mut order = Vec::with_capacity(n);
        let mut path = Vec::new();
        let mut at = roots;
        loop {
            // Goes down to a leaf, then back up past all finished vertices.
            while at != NONE {
                path.push(at);
                at = first[at as usize];
            }
            let Some(p) = path.pop() else { break };
            order.push(self.order[p as usize]);
            at = next[p as usize];
        }
        Tree::new(graph, order)
    }

    /// Entries of each column of L, the diagonal included.
    pub fn counts(&self, graph: &Graph) -> Vec<u32> {
        let n = self.order.len();
        let mut counts = vec![1; n];
        let mut seen = vec![NONE; n];
        for (p, &v) in self.order.iter().enumerate() {
            // Row p of L is the part of the tree between p and its neighbours.
            seen[p] = p as u32;
            for &w in neighbours(graph, v) {
                let mut q = self.place[w as usize] as usize;
                while q < p && seen[q] != p as u32 {
                    seen[q] = p as u32;
                    counts[q] += 1;
                    q = self.parent[q] as usize;
                }
            }
        }
        counts
    }
}

#[cfg(test)]
#[path = "../../tests/interior/graph.rs"]
mod tests;
