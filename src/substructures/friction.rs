//! Friction at a node: the bound of the force of friction, and the rows that belong together.
//!
//! ```text
//!     stick    |λ_t| ≤ g,    w = 0                slip    λ_t = g w/|w|
//!     Coulomb  g = μ λ_n     Tresca  g given      limit   g = min(μ λ_n, limit)
//! ```
//!
//! w = B_t u − c_t is the slip of the load step: c_t is where the sides stood at its beginning, and λ_t is the force
//! with which the first side drags the other along.

/// The bound g ≥ 0 of the force of friction, as a force: stresses have been multiplied by the area of the node.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum FrictionBound {
    /// g = min(μ λ_n, limit).
    Coulomb {
        /// μ ≥ 0.
        coefficient: f64,
        /// A force; ∞ where there is no limit.
        limit: f64,
    },
    /// A given g, whether or not the node touches.
    Tresca(f64),
}

/// A node with friction, by the places of its rows among those that its rank provides.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct FrictionNode {
    /// The normal row.
    pub normal: usize,
    /// The tangential rows: one in the plane, two in space, with perpendicular directions of unit length.
    pub tangential: Vec<usize>,
    /// The bound of the force.
    pub bound: FrictionBound,
}

impl FrictionBound {
    /// g where the normal row has the multiplier λ_n.
    pub fn at(self, normal: f64) -> f64 {
        match self {
            FrictionBound::Coulomb { coefficient, limit } => {
                (coefficient * normal.max(0.0)).min(limit)
            }
            FrictionBound::Tresca(g) => g,
        }
    }

    /// Whether a node that does not touch has friction all the same.
    pub fn acts_apart(self) -> bool {
        match self {
            FrictionBound::Coulomb { .. } => false,
            FrictionBound::Tresca(_) => true,
        }
    }
}

impl FrictionNode {
    /// The node of these rows.
    ///
    /// # Panics
    /// If there is no tangential row, or more than two.
    pub fn new(normal: usize, tangential: Vec<usize>, bound: FrictionBound) -> FrictionNode {
        assert!((1..=2).contains(&tangential.len()));
        FrictionNode {
            normal,
            tangential,
            bound,
        }
    }
}

#[cfg(test)]
#[path = "../../tests/inside/substructures/friction.rs"]
mod tests;
