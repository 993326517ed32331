//! Copies of a mesh: the same cells of the same nodes, moved, turned or mirrored.
//!
//! A program that copies a part keeps the order of its nodes and cells. In a mirrored copy the nodes of each cell stand
//! in another order, as its orientation would be negative otherwise. A partitioner that goes by the order of sides cuts
//! such a copy in another way.

use super::cell_mesh::CellMesh;
use base::linalg::orthogonal::fit;
use base::linalg::vec3::{minus, norm};

/// Nodes of a copy may be this far from their places, relative to the extent of the mesh. It is a question of where to
/// cut, and not of equal matrices: files with few digits will do.
const PLACED: f64 = 1e-6;

/// Distances that are the same in copies, up to the digits of a file. They tell meshes that are no copies apart in
/// less time than [`congruent`] takes.
#[derive(Debug, Clone, Copy)]
pub struct MeshFingerprint {
    /// The largest distance from the first node.
    reach: f64,
    /// The mean distances from the first node, one in the middle of the list, and the last.
    means: [f64; 3],
}

impl MeshFingerprint {
    /// The outline of a mesh with nodes.
    pub fn new(mesh: &CellMesh) -> MeshFingerprint {
        let n = mesh.points.len();
        let distances = |from: usize| {
            mesh.points.iter().map(move |point| {
                let mut along = minus(*point, mesh.points[from]);
                along[mesh.dim..].fill(0.0);
                norm(along)
            })
        };
        MeshFingerprint {
            reach: distances(0).fold(0.0, f64::max),
            means: [0, n / 2, n - 1].map(|from| distances(from).sum::<f64>() / n as f64),
        }
    }

    /// Whether meshes with these outlines may be copies of each other.
    pub fn may_be(&self, other: &MeshFingerprint) -> bool {
        // Each end of a distance may be away by PLACED of the extent, which is less than twice the reach. The other
        // half is for rounding.
        let near = 8.0 * PLACED * self.reach;
        let pairs = self.means.iter().zip(&other.means);
        let mut all = pairs.chain([(&self.reach, &other.reach)]);
        all.all(|(a, b)| (a - b).abs() <= near)
    }
}

/// Whether `b` is a copy of `a`. Boundary groups and numbers in the file do not count.
pub fn congruent(a: &CellMesh, b: &CellMesh) -> bool {
    let sizes = |m: &CellMesh| (m.dim, m.points.len(), m.cells.len());
    sizes(a) == sizes(b) && a.cells.kinds() == b.cells.kinds() && same_nodes(a, b) && placed(a, b)
}

/// Whether the cells have the same nodes each, in any order.
fn same_nodes(a: &CellMesh, b: &CellMesh) -> bool {
    let sorted = |nodes: &[u32]| {
        let mut nodes = nodes.to_vec();
        nodes.sort_unstable();
        nodes
    };
    let mut cells = a.cells.iter().zip(b.cells.iter());
    cells.all(|((_, a), (_, b))| a == b || sorted(a) == sorted(b))
}

/// Whether a motion or reflection takes the nodes of one to those of the other.
fn placed(a: &CellMesh, b: &CellMesh) -> bool {
    let found = fit(a.points.len(), a.dim, |k| [a.points[k], b.points[k]]);
    found.is_some_and(|fit| fit.far <= PLACED)
}

#[cfg(test)]
#[path = "../tests/congruent.rs"]
mod tests;
