//! A body: an axis-aligned box cut into equal rectangles or bricks and partitioned into a grid of subdomains.
//!
//! Two and three dimensions are one code: a plane box has no elements in z, one layer of nodes and one of subdomains.

use std::ops::RangeInclusive;

/// A box of `elements[0]` × `elements[1]` (× `elements[2]`) equal cells in `subdomains[0]` × `subdomains[1]` (×
/// `subdomains[2]`) equal blocks.
///
/// Nodes are numbered layer by layer and row by row from the lower left corner, x running fastest; so are elements and
/// subdomains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoxMesh {
    /// Lower left corner; z is 0 in the plane.
    pub origin: [f64; 3],
    /// Edge lengths, > 0; 0 in z in the plane.
    pub size: [f64; 3],
    /// Elements in x, y and z, each a multiple of `subdomains`; 0 in z in the plane.
    pub elements: [usize; 3],
    /// Subdomains in x, y and z, ≥ 1.
    pub subdomains: [usize; 3],
}

/// The elements of one subdomain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ElementBlock {
    /// Place of the subdomain in the body.
    pub place: [usize; 3],
    /// Its first element (and first node) in x, y and z.
    pub first: [usize; 3],
    /// Its number of elements in x, y and z (0 in the plane).
    pub elements: [usize; 3],
}

impl ElementBlock {
    /// Nodes in x, y and z.
    pub fn nodes(&self) -> [usize; 3] {
        self.elements.map(|n| n + 1)
    }

    /// The nodes of the block, as places in the body, x running fastest.
    pub fn places(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        places(self.nodes()).map(|p| [0, 1, 2].map(|d| self.first[d] + p[d]))
    }
}

/// All places of a grid of `counts` points, x running fastest.
pub fn places(counts: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    let [nx, ny, nz] = counts;
    (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])))
}

impl BoxMesh {
    /// A plane box.
    pub fn plane(
        origin: [f64; 2],
        size: [f64; 2],
        elements: [usize; 2],
        subdomains: [usize; 2],
    ) -> BoxMesh {
        BoxMesh {
            origin: [origin[0], origin[1], 0.0],
            size: [size[0], size[1], 0.0],
            elements: [elements[0], elements[1], 0],
            subdomains: [subdomains[0], subdomains[1], 1],
        }
    }

    /// The dimension, 2 or 3.
    pub fn dim(&self) -> usize {
        if self.elements[2] > 0 {
            3
        } else {
            2
        }
    }

    /// Edge lengths of an element; 0 in z in the plane.
    pub fn step(&self) -> [f64; 3] {
        [0, 1, 2].map(|d| match self.elements[d] {
            0 => 0.0,
            n => self.size[d] / n as f64,
        })
    }

    /// Nodes in x, y and z.
    pub fn nodes(&self) -> [usize; 3] {
        self.elements.map(|n| n + 1)
    }

    /// Number of nodes.
    pub fn n_nodes(&self) -> usize {
        self.nodes().iter().product()
    }

    /// Number of elements.
    pub fn n_elements(&self) -> usize {
        self.elements.iter().map(|&n| n.max(1)).product()
    }

    /// Number of subdomains.
    pub fn n_subdomains(&self) -> usize {
        self.subdomains.iter().product()
    }

    /// Elements of a subdomain in x, y and z.
    pub fn block_elements(&self) -> [usize; 3] {
        [0, 1, 2].map(|d| self.elements[d] / self.subdomains[d])
    }

    /// The elements of subdomain `s`, in 0..n_subdomains.
    pub fn block(&self, s: usize) -> ElementBlock {
        let elements = self.block_elements();
        let [sx, sy, _] = self.subdomains;
        let place = [s % sx, s / sx % sy, s / (sx * sy)];
        ElementBlock {
            place,
            first: [0, 1, 2].map(|d| place[d] * elements[d]),
            elements,
        }
    }

    /// Number of the node at a place.
    pub fn node(&self, [i, j, k]: [usize; 3]) -> usize {
        let [nx, ny, _] = self.nodes();
        (k * ny + j) * nx + i
    }

    /// Place of node `node`.
    pub fn place(&self, node: usize) -> [usize; 3] {
        let [nx, ny, _] = self.nodes();
        [node % nx, node / nx % ny, node / (nx * ny)]
    }

    /// Position of the node at a place; the last nodes lie on the box's far sides exactly.
    pub fn position(&self, place: [usize; 3]) -> [f64; 3] {
        [0, 1, 2].map(|d| match self.elements[d] {
            0 => self.origin[d],
            n => self.origin[d] + self.size[d] * (place[d] as f64 / n as f64),
        })
    }

    /// The corner of greatest coordinates.
    pub fn end(&self) -> [f64; 3] {
        [0, 1, 2].map(|d| self.origin[d] + self.size[d])
    }

    /// The subdomains along direction `d` that contain node line `k`: one, or two on a line between them.
    fn touching(&self, d: usize, k: usize) -> RangeInclusive<usize> {
        let each = self.block_elements()[d];
        if each == 0 {
            return 0..=0;
        }
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
    pub fn owner(&self, place: [usize; 3]) -> usize {
        let [sx, sy, _] = self.subdomains;
        let [i, j, k] = [0, 1, 2].map(|d| *self.touching(d, place[d]).start());
        (k * sy + j) * sx + i
    }

    /// Number of subdomains that contain the node: 1, 2, 4 or 8.
    pub fn multiplicity(&self, place: [usize; 3]) -> usize {
        (0..3).map(|d| self.touching(d, place[d]).count()).product()
    }

    /// Whether the node is a corner of a subdomain. This includes the ends of subdomain edges on the body's boundary
    /// and the corners of the body. Inside the body, continuity is primal where [`BoxMesh::multiplicity`] > 1. A corner
    /// of the body belongs to one subdomain only, but matters where bodies meet.
    pub fn is_vertex(&self, place: [usize; 3]) -> bool {
        let each = self.block_elements();
        (0..self.dim()).all(|d| place[d] % each[d] == 0)
    }

    /// The sides on which the node lies, as indices into `left, right, bottom, top, back, front`.
    pub fn sides(&self, place: [usize; 3]) -> impl Iterator<Item = usize> {
        let (elements, n) = (self.elements, 2 * self.dim());
        (0..n).filter(move |s| place[s / 2] == [0, elements[s / 2]][s % 2])
    }

    /// The nodes on a side, x running fastest.
    pub fn side_nodes(&self, side: usize) -> impl Iterator<Item = [usize; 3]> {
        let d = side / 2;
        let mut counts = self.nodes();
        counts[d] = 1;
        let level = [0, self.elements[d]][side % 2];
        places(counts).map(move |mut p| {
            p[d] = level;
            p
        })
    }

    /// The nodes on the boundary of the box, in increasing order.
    pub fn boundary(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        let ([nx, ny, nz], dim) = (self.elements, self.dim());
        (0..=nz).flat_map(move |k| {
            let end = dim == 3 && (k == 0 || k == nz);
            (0..=ny).flat_map(move |j| {
                let whole = end || j == 0 || j == ny;
                let step = if whole { 1 } else { nx };
                (0..=nx).step_by(step).map(move |i| [i, j, k])
            })
        })
    }
}

#[cfg(test)]
#[path = "../tests/boxes.rs"]
mod tests;
