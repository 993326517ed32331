//! Values at single points: probes, and the nodes that a deck prints.

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

/// A table of displacements that a deck asks for (`*NODE PRINT`).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NodePrint {
    /// The node set.
    pub set: String,
    /// The time at the end of the step.
    pub time: f64,
    /// Number of the node, ux, uy, uz; in the system of the node where the deck gives it one (`*TRANSFORM`), unless it
    /// asks for the global one.
    pub nodes: Vec<(u64, f64, f64, f64)>,
    /// Whether each node is in a system of its own.
    #[serde(skip)]
    pub local: Vec<bool>,
}
