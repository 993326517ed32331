//! The laws of a contact or an obstacle beside hard contact without friction, as plain data.

use super::profile::Profile;

/// The law at the nodes of an entry.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct ContactLaw {
    /// Friction; `None`: none.
    pub friction: Option<FrictionSpec>,
    /// Soft contact: the pressure over the overclosure; `None`: hard.
    pub stiffness: Option<Profile>,
    /// Elastic slip: the shear stress over the slip of a node that sticks; `None`: none.
    pub stick_stiffness: Option<Profile>,
}

/// Friction at the nodes of an entry.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum FrictionSpec {
    /// |τ| ≤ min(μ p, limit), with the pressure p.
    Coulomb {
        /// μ ≥ 0.
        coefficient: Profile,
        /// A shear stress.
        limit: Option<Profile>,
    },
    /// |τ| ≤ the given shear stress, whether or not the node touches.
    Tresca(Profile),
}
