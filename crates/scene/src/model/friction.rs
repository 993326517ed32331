//! Friction of a contact or an obstacle, as plain data.

use super::profile::Profile;

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
