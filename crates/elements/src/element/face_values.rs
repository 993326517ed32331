//! Shape functions of sides at any point, with the position and the tangents there.

use super::shape_functions::{reference_nodes, shape};
use crate::kind::CellKind;

/// A point of a side.
#[derive(Debug, Clone, Copy)]
pub struct FaceValues {
    /// N_a; zero from the number of nodes on.
    pub values: [f64; 9],
    /// The position.
    pub x: [f64; 3],
    /// ∂x/∂s_j.
    pub tangents: [[f64; 3]; 2],
}

/// Where the nodes of a side lie in its reference cell.
pub fn nodes(kind: CellKind) -> Vec<[f64; 3]> {
    reference_nodes(kind)
}

/// The values of a side with nodes at `points` in the point `at` of its reference cell.
pub fn at(kind: CellKind, points: impl Iterator<Item = [f64; 3]>, at: [f64; 3]) -> FaceValues {
    let here = shape(kind, at);
    let mut out = FaceValues {
        values: [0.0; 9],
        x: [0.0; 3],
        tangents: [[0.0; 3]; 2],
    };
    out.values.copy_from_slice(&here.value[..9]);
    for (a, point) in points.enumerate() {
        for i in 0..3 {
            out.x[i] += here.value[a] * point[i];
            for j in 0..kind.dim() {
                out.tangents[j][i] += here.slope[j][a] * point[i];
            }
        }
    }
    out
}
