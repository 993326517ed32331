//! The equation of a scene and its finite elements.

use super::cell::{rigid_count, Cure, Element, Material, Plane};
use super::law::Law;
use std::f64::consts::TAU;
use std::ops::Range;

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
        /// Plane strain, plane stress or axisymmetry; ignored in three dimensions.
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

    /// The material with coefficient ρ, or the isotropic law of Young's modulus and Poisson's ratio.
    pub fn material(&self, rho: f64, poisson: f64) -> Material {
        match self.physics {
            Physics::Scalar => Material::Scalar { rho },
            Physics::Elasticity { .. } => self.elastic(Law::Isotropic {
                young: rho,
                poisson,
            }),
        }
    }

    /// The material of an elastic law.
    ///
    /// # Panics
    /// For a scalar problem.
    pub fn elastic(&self, law: Law) -> Material {
        let Physics::Elasticity { plane, cure } = self.physics else {
            panic!("a scalar problem has no elastic law");
        };
        Material::Elastic { law, plane, cure }
    }

    /// Whether bodies are rings around the axis x = 0: x is the radius, y runs along the axis.
    pub fn is_axial(&self) -> bool {
        let Physics::Elasticity { plane, .. } = self.physics else {
            return false;
        };
        plane == Plane::Axial
    }

    /// The factor of a piece of a plane cell or side at this point: the way around the axis in rings, else 1.
    pub fn around(&self, point: [f64; 3]) -> f64 {
        if self.is_axial() {
            TAU * point[0]
        } else {
            1.0
        }
    }

    /// Which of the [`rigid_motions`](super::cell::rigid_motions) take no energy; rings have the one along the axis.
    pub fn rigid(&self, dim: usize) -> Range<usize> {
        if self.is_axial() {
            1..2
        } else {
            0..rigid_count(dim)
        }
    }

    /// Whether the unknowns are displacements.
    pub fn is_elastic(&self) -> bool {
        self.physics != Physics::Scalar
    }
}
