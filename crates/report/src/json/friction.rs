//! The record of friction: keys of an interface, and of a load step.

use serde::{Deserialize, Serialize};

/// The friction of an interface or obstacle, or of a load step. Forces are sums over nodes.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct FrictionForce {
    /// The force of friction on the first body, or on the body of an obstacle, by components.
    pub friction: Vec<f64>,
    /// Number of nodes that stick.
    pub sticking: usize,
    /// Number of nodes that slip. The others are apart.
    pub slipping: usize,
    /// The work of friction in the load step: of the forces at its end on the slip in it.
    pub dissipated: f64,
}

/// The largest values of an interface with friction.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct FrictionExtremes {
    /// The largest shear stress: a force of friction over the area of its node. `null` where no area is known.
    pub largest_shear: Option<f64>,
    /// The largest slip in the load step.
    pub largest_slip: f64,
}
