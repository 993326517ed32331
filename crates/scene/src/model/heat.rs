//! Expansion by heat.

use super::field::Field;
use std::sync::Arc;

/// The strain α ΔT of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatSpec {
    /// α along the axes of the material, per degree: one for the body, or one for every cell of a mesh; empty: none is
    /// given.
    pub expansion: Vec<[f64; 3]>,
    /// The temperature; `None`: the one without strain.
    pub temperature: Option<Temperature>,
    /// The temperature without strain.
    pub reference: f64,
}

/// A temperature over a body.
#[derive(Debug, Clone, PartialEq)]
pub enum Temperature {
    /// By points of space.
    Field(Field),
    /// By node of a mesh.
    AtNodes(Arc<Vec<f64>>),
}

impl Default for HeatSpec {
    /// A body that does not expand.
    fn default() -> HeatSpec {
        HeatSpec {
            expansion: Vec::new(),
            temperature: None,
            reference: 0.0,
        }
    }
}

impl HeatSpec {
    /// α of a cell.
    pub fn of(&self, cell: usize) -> [f64; 3] {
        match self.expansion.len() {
            0 => [0.0; 3],
            1 => self.expansion[0],
            _ => self.expansion[cell],
        }
    }
}
