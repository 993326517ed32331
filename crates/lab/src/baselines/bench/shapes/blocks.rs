//! Two blocks, one on the other, of tetrahedra: the meshes match on the common face, or do not.

use crate::delaunay::Solid;
use crate::delaunay::{build, GroupNumbers};
use crate::delaunay::{polyline, Planform};
use elements::kind::CellKind;
use mesh::MeshFile;

const LOW: usize = 1;
const HIGH: usize = 2;
const NAMES: &[&str] = &[
    "low",
    "high",
    "bottom",
    "top",
    "left",
    "front",
    "low_face",
    "high_face",
];

/// The height of each block; both are as long and wide as 1.
const HEIGHT: f64 = 0.5;

/// Tetrahedra of 4 nodes with edges about so long in the lower and in the upper block. Blocks of the same edges have
/// the same nodes on the common face, each its own. Groups: `low`, `high`; `bottom`, `low_face` of the lower block,
/// `top`, `left`, `front`, `high_face` of the upper one.
pub(in super::super) fn blocks(edges: [f64; 2]) -> MeshFile {
    let (mut points, mut cells, mut of_cell) = (Vec::new(), Vec::new(), Vec::new());
    for (edge, body) in edges.into_iter().zip([LOW, HIGH]) {
        let solid = block(edge);
        let first = points.len() as u32;
        let base = if body == HIGH { HEIGHT } else { 0.0 };
        points.extend(solid.points.iter().map(|&[x, y, z]| [x, y, base + z]));
        of_cell.extend(solid.cells.iter().map(|_| body));
        for cell in solid.cells {
            cells.push(cell.into_iter().map(|n| first + n).collect());
        }
    }
    let groups = GroupNumbers {
        names: NAMES,
        of_cell,
    };
    let side = |[x, y, z]: [f64; 3], beside: [usize; 2]| match beside[0].max(beside[1]) {
        LOW if z == 0.0 => 3,
        LOW if z == HEIGHT => 7,
        HIGH if z == 2.0 * HEIGHT => 4,
        HIGH if z == HEIGHT => 8,
        HIGH if x == 0.0 => 5,
        HIGH if y == 0.0 => 6,
        _ => 0,
    };
    build("blocks.msh", points, CellKind::Tet4, &cells, &groups, side)
}

/// A block that stands on z = 0.
fn block(edge: f64) -> Solid {
    let across = (1.0 / edge).round() as usize;
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let sides = [0, 1, 2, 3].map(|k| polyline(corners[k], corners[(k + 1) % 4], across));
    let plan = Planform::fill(&sides, edge, |_| true);
    let layers = (HEIGHT / edge).round() as usize;
    Solid::over(&plan, layers, |_| HEIGHT)
}
