//! Tetrahedra over a triangulated region of the plane.

use std::collections::HashMap;

use super::planform::Planform;
use base::linalg::vec3::{cross, dot, minus};

/// Corners of the edges in the order of their middle nodes ([`CellKind::Tet10`](elements::kind::CellKind::Tet10)).
const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]];

/// Tetrahedra of 4 or 10 nodes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Solid {
    /// Positions of the nodes.
    pub points: Vec<[f64; 3]>,
    /// The nodes of each cell, corners first.
    pub cells: Vec<Vec<u32>>,
    /// The triangle of the plane over which each cell stands.
    pub over: Vec<usize>,
}

impl Solid {
    /// `layers` layers over the plane, from z = 0 to `height`(x, y).
    pub fn over(plan: &Planform, layers: usize, height: impl Fn([f64; 2]) -> f64) -> Solid {
        let n = plan.points.len();
        let level = |k: usize| {
            let height = &height;
            let raise = move |&[x, y]: &[f64; 2]| [x, y, height([x, y]) * k as f64 / layers as f64];
            plan.points.iter().map(raise)
        };
        let mut solid = Solid {
            points: (0..=layers).flat_map(level).collect(),
            cells: Vec::with_capacity(3 * layers * plan.triangles.len()),
            over: Vec::with_capacity(3 * layers * plan.triangles.len()),
        };
        for k in 0..layers {
            for (t, corners) in plan.triangles.iter().enumerate() {
                // A prism is cut by the order of the numbers of its corners, so that neighbours fit.
                let mut v = *corners;
                v.sort_unstable();
                let [a, b, c] = v.map(|p| p + k * n);
                let [d, e, f] = [a + n, b + n, c + n];
                for cell in [[a, b, c, f], [a, b, e, f], [a, d, e, f]] {
                    let cell = solid.upright(cell).map(|node| node as u32);
                    solid.cells.push(cell.to_vec());
                    solid.over.push(t);
                }
            }
        }
        solid
    }

    /// The corners in an order with positive volume.
    fn upright(&self, [a, b, c, d]: [usize; 4]) -> [usize; 4] {
        let [p, q, r, s] = [a, b, c, d].map(|n| self.points[n]);
        let [u, v, w] = [q, r, s].map(|x| minus(x, p));
        if dot(cross(u, v), w) > 0.0 {
            [a, b, c, d]
        } else {
            [b, a, c, d]
        }
    }

    /// These cells with nodes in the middles of their edges.
    pub fn quadratic(mut self) -> Solid {
        let mut middles = HashMap::new();
        for cell in &mut self.cells {
            for ends in EDGES {
                let [p, q] = ends.map(|e| cell[e]);
                let points = &mut self.points;
                let node = *middles.entry([p.min(q), p.max(q)]).or_insert_with(|| {
                    let [p, q] = [p, q].map(|n| points[n as usize]);
                    points.push([0, 1, 2].map(|d| 0.5 * (p[d] + q[d])));
                    points.len() as u32 - 1
                });
                cell.push(node);
            }
        }
        self
    }
}
