//! The equation of a scene and its finite elements.

use super::cell::{Cure, Element, Material, Plane};

/// The bilinear form of a scene and its discretisation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Form {
    /// The equation.
    pub physics: Physics,
    /// The elements.
    pub element: Element,
}

/// The equation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Physics {
    /// −∇·(ρ ∇u) = f.
    Scalar,
    /// −∇·σ(u) = f, linear elasticity.
    Elasticity {
        /// Plane strain or plane stress; ignored in three dimensions.
        plane: Plane,
        /// The cure of volumetric locking.
        cure: Cure,
    },
}

impl Default for Form {
    /// The scalar equation with bilinear (trilinear) elements.
    fn default() -> Form {
        Form {
            physics: Physics::Scalar,
            element: Element::Q1,
        }
    }
}

impl Form {
    /// Number C of components of the field in dimension `dim`.
    pub fn components(&self, dim: usize) -> usize {
        match self.physics {
            Physics::Scalar => 1,
            Physics::Elasticity { .. } => dim,
        }
    }

    /// The material with coefficient ρ, or Young's modulus and Poisson's ratio.
    pub fn material(&self, rho: f64, poisson: f64) -> Material {
        match self.physics {
            Physics::Scalar => Material::Scalar { rho },
            Physics::Elasticity { plane, cure } => Material::Elastic {
                young: rho,
                poisson,
                plane,
                cure,
            },
        }
    }

    /// Whether the unknowns are displacements.
    pub fn is_elastic(&self) -> bool {
        self.physics != Physics::Scalar
    }
}
