//! Copies of a mesh: the same cells of the same nodes, moved, turned or mirrored.
//!
//! A program that copies a part keeps the order of its nodes and cells. In a mirrored copy the nodes of each cell stand
//! in another order, as its orientation would be negative otherwise. A partitioner that goes by the order of sides cuts
//! such a copy in another way.

use super::cell_mesh::CellMesh;
use crate::linalg::orthogonal::fit;

/// Nodes of a copy may be this far from their places, relative to the extent of the mesh. It is a question of where to
/// cut, and not of equal matrices: files with few digits will do.
const PLACED: f64 = 1e-6;

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
#[path = "../../tests/inside/mesh/congruent.rs"]
mod tests;
