//! Values at single points: probes, and the nodes that a deck prints.

use deck::{DatQuantity, DatTable, TableRow};
use serde::{Deserialize, Serialize};

/// The values at a probe.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProbeValue {
    /// Its name.
    pub name: String,
    /// The body in which it lies.
    pub body: String,
    /// The point, by coordinates.
    pub point: Vec<f64>,
    /// u by components.
    pub u: Vec<f64>,
    /// The stress in its cell, components xx, yy, zz, xy, yz, xz; empty in scalar problems.
    pub stress: Vec<f64>,
}

/// The values that a `*NODE PRINT` of a deck asks for. Vectors are in the system of the node where the deck gives it
/// one (`*TRANSFORM`), unless it asks for the global one.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct NodePrint {
    /// The node set.
    pub set: String,
    /// The time at the end of the step.
    pub time: f64,
    /// Number of the node, ux, uy, uz; empty if no displacements are asked for.
    pub nodes: Vec<(u64, f64, f64, f64)>,
    /// Number of the node and the force that acts on it: loads, reactions, and the forces of ties and equations.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub forces: Vec<(u64, f64, f64, f64)>,
    /// The sum of the forces, in the global system.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub total_force: Option<[f64; 3]>,
    /// The tables from which it is made, for a `.dat` file.
    #[serde(skip)]
    pub tables: Vec<DatTable>,
}

impl NodePrint {
    /// From the tables of one `*NODE PRINT`.
    pub fn new(tables: Vec<DatTable>) -> NodePrint {
        let mut out = NodePrint::default();
        for table in &tables {
            out.set.clone_from(&table.set);
            out.time = table.time;
            let row = |row: &TableRow| {
                let [x, y, z] = row.vector;
                (row.id, x, y, z)
            };
            let rows = table.rows.iter().map(row);
            match table.quantity {
                DatQuantity::Displacement => out.nodes = rows.collect(),
                DatQuantity::Force => out.forces = rows.collect(),
                DatQuantity::TotalForce => out.total_force = table.rows.first().map(|r| r.vector),
            }
        }
        NodePrint { tables, ..out }
    }
}
