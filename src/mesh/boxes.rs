//! A body: an axis-aligned box cut into equal rectangles and partitioned into a grid of subdomains.

use std::ops::RangeInclusive;

/// A box of `elements[0]` × `elements[1]` rectangles in `subdomains[0]` × `subdomains[1]` equal blocks.
///
/// Nodes are numbered row by row from the lower left corner, x running fastest; so are elements and subdomains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoxMesh {
    /// Lower left corner.
    pub origin: [f64; 2],
    /// Width and height, > 0.
    pub size: [f64; 2],
    /// Elements in x and y, each a multiple of `subdomains`.
    pub elements: [usize; 2],
    /// Subdomains in x and y, ≥ 1.
    pub subdomains: [usize; 2],
}

/// The elements of one subdomain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Block {
    /// Column and row of the subdomain in the body.
    pub place: [usize; 2],
    /// Its first element (and first node) in x and y.
    pub first: [usize; 2],
    /// Its number of elements in x and y.
    pub elements: [usize; 2],
}

impl BoxMesh {
    /// Width and height of an element.
    pub fn step(&self) -> [f64; 2] {
        [0, 1].map(|d| self.size[d] / self.elements[d] as f64)
    }

    /// Nodes in x and y.
    pub fn nodes(&self) -> [usize; 2] {
        self.elements.map(|n| n + 1)
    }

    /// Number of nodes.
    pub fn n_nodes(&self) -> usize {
        let [nx, ny] = self.nodes();
        nx * ny
    }

    /// Number of subdomains.
    pub fn n_subdomains(&self) -> usize {
        self.subdomains[0] * self.subdomains[1]
    }

    /// Elements of a subdomain in x and y.
    pub fn block_elements(&self) -> [usize; 2] {
        [0, 1].map(|d| self.elements[d] / self.subdomains[d])
    }

    /// The elements of subdomain `s`, in 0..n_subdomains.
    pub fn block(&self, s: usize) -> Block {
        let elements = self.block_elements();
        let place = [s % self.subdomains[0], s / self.subdomains[0]];
        Block {
            place,
            first: [place[0] * elements[0], place[1] * elements[1]],
            elements,
        }
    }

    /// Number of the node in column `i` and row `j`.
    pub fn node(&self, [i, j]: [usize; 2]) -> usize {
        j * (self.elements[0] + 1) + i
    }

    /// Column and row of node `node`.
    pub fn place(&self, node: usize) -> [usize; 2] {
        let width = self.elements[0] + 1;
        [node % width, node / width]
    }

    /// Position of the node in column `i` and row `j`. The last column and row lie on the box's far sides exactly.
    pub fn position(&self, place: [usize; 2]) -> [f64; 2] {
        [0, 1].map(|d| self.origin[d] + self.size[d] * (place[d] as f64 / self.elements[d] as f64))
    }

    /// Upper right corner.
    pub fn end(&self) -> [f64; 2] {
        [0, 1].map(|d| self.origin[d] + self.size[d])
    }

    /// The subdomain columns (d = 0) or rows (d = 1) that contain node column or row `k`: one, or two on a line
    /// between them.
    fn touching(&self, d: usize, k: usize) -> RangeInclusive<usize> {
        let each = self.block_elements()[d];
        let last = self.subdomains[d] - 1;
        let high = (k / each).min(last);
        let low = if k % each == 0 && k > 0 {
            (k / each - 1).min(last)
        } else {
            high
        };
        low..=high
    }

    /// The subdomain of lowest number that contains the node.
    pub fn owner(&self, [i, j]: [usize; 2]) -> usize {
        *self.touching(1, j).start() * self.subdomains[0] + *self.touching(0, i).start()
    }

    /// Number of subdomains that contain the node: 1, 2 or 4.
    pub fn multiplicity(&self, [i, j]: [usize; 2]) -> usize {
        self.touching(0, i).count() * self.touching(1, j).count()
    }

    /// Whether the node is a corner of a subdomain: the ends of subdomain edges on the body's boundary and the corners of
    /// the body included. Continuity inside the body is primal where [`BoxMesh::multiplicity`] > 1; a corner of the body belongs
    /// to one subdomain only, but matters where bodies meet.
    pub fn is_vertex(&self, place: [usize; 2]) -> bool {
        let each = self.block_elements();
        (0..2).all(|d| place[d] % each[d] == 0)
    }

    /// The sides on which the node lies, as indices into `left, right, bottom, top`.
    pub fn sides(&self, [i, j]: [usize; 2]) -> impl Iterator<Item = usize> {
        let on = [i == 0, i == self.elements[0], j == 0, j == self.elements[1]];
        (0..4).filter(move |&s| on[s])
    }

    /// The nodes on the boundary of the box, in increasing order.
    pub fn boundary(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        let [nx, ny] = self.elements;
        (0..=ny).flat_map(move |j| {
            let step = if j == 0 || j == ny { 1 } else { nx };
            (0..=nx).step_by(step).map(move |i| [i, j])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh() -> BoxMesh {
        BoxMesh {
            origin: [1.0, -1.0],
            size: [3.0, 2.0],
            elements: [6, 4],
            subdomains: [3, 2],
        }
    }

    #[test]
    fn owners_and_multiplicities_agree_with_the_blocks() {
        let m = mesh();
        for node in 0..m.n_nodes() {
            let place = m.place(node);
            assert_eq!(m.node(place), node);
            let holders: Vec<usize> = (0..m.n_subdomains())
                .filter(|&s| {
                    let b = m.block(s);
                    (0..2).all(|d| (b.first[d]..=b.first[d] + b.elements[d]).contains(&place[d]))
                })
                .collect();
            assert_eq!(m.owner(place), holders[0]);
            assert_eq!(m.multiplicity(place), holders.len());
        }
    }

    #[test]
    fn vertices_are_shared_except_at_the_corners_of_the_body() {
        let m = mesh();
        let vertices = |shared: bool| -> Vec<[usize; 2]> {
            (0..m.n_nodes())
                .map(|n| m.place(n))
                .filter(|&p| m.is_vertex(p) && (m.multiplicity(p) > 1) == shared)
                .collect()
        };
        let shared = [
            [2, 0],
            [4, 0],
            [0, 2],
            [2, 2],
            [4, 2],
            [6, 2],
            [2, 4],
            [4, 4],
        ];
        assert_eq!(vertices(true), shared);
        assert_eq!(vertices(false), [[0, 0], [6, 0], [0, 4], [6, 4]]);
    }

    #[test]
    fn the_boundary_is_walked_once_in_order() {
        let m = mesh();
        let walked: Vec<usize> = m.boundary().map(|p| m.node(p)).collect();
        let expected: Vec<usize> = (0..m.n_nodes())
            .filter(|&n| m.sides(m.place(n)).next().is_some())
            .collect();
        assert_eq!(walked, expected);
        assert_eq!(m.position([6, 4]), [4.0, 1.0]);
        assert_eq!(m.sides([6, 0]).collect::<Vec<_>>(), vec![1, 2]);
    }
}
