//! Shape functions at the points of a rule, computed once per kind and purpose.

use super::quadrature::{rule, Purpose};
use super::shape_functions::shape;
use crate::kind::CellKind;
use std::sync::OnceLock;

/// The values of a cell's shape functions at the points of a rule.
pub(super) struct ShapeTable {
    nodes: usize,
    dim: usize,
    /// The points in the reference cell.
    pub at: Vec<[f64; 3]>,
    /// The weights of the rule.
    pub weights: Vec<f64>,
    /// N_a, a row per point.
    values: Vec<f64>,
    /// ∂N_a/∂s_j, for each point a row per direction j.
    slopes: Vec<f64>,
}

impl ShapeTable {
    fn new(kind: CellKind, purpose: Purpose) -> ShapeTable {
        let (nodes, dim) = (kind.nodes(), kind.dim());
        let mut table = ShapeTable {
            nodes,
            dim,
            at: Vec::new(),
            weights: Vec::new(),
            values: Vec::new(),
            slopes: Vec::new(),
        };
        for (at, weight) in rule(kind, purpose) {
            let shape = shape(kind, at);
            table.at.push(at);
            table.weights.push(weight);
            table.values.extend_from_slice(&shape.value[..nodes]);
            for row in &shape.slope[..dim] {
                table.slopes.extend_from_slice(&row[..nodes]);
            }
        }
        table
    }

    /// N_a at point q.
    #[inline]
    pub fn values(&self, q: usize) -> &[f64] {
        &self.values[q * self.nodes..][..self.nodes]
    }

    /// ∂N_a/∂s_j at point q.
    #[inline]
    pub fn slopes(&self, q: usize, j: usize) -> &[f64] {
        &self.slopes[(q * self.dim + j) * self.nodes..][..self.nodes]
    }
}

const KINDS: usize = CellKind::ALL.len();
const PURPOSES: usize = Purpose::ALL.len();

/// The table of a kind for a purpose.
pub(super) fn table(kind: CellKind, purpose: Purpose) -> &'static ShapeTable {
    static TABLES: [OnceLock<ShapeTable>; KINDS * PURPOSES] =
        [const { OnceLock::new() }; KINDS * PURPOSES];
    TABLES[kind as usize * PURPOSES + purpose as usize]
        .get_or_init(|| ShapeTable::new(kind, purpose))
}
