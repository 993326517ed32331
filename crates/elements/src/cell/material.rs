//! Materials: a scalar coefficient, or Young's modulus and Poisson's ratio.

use super::Element;

/// The three-dimensional situation that a 2D elastic cell models.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Plane {
    /// A slice of a long body: ε_zz = 0.
    #[default]
    Strain,
    /// A thin sheet: σ_zz = 0.
    Stress,
    /// A ring: x is the radius, y the axis, ε_zz = u_x/x the strain around. Cells of [`element`](crate::element)
    /// only.
    Axial,
}

/// The cure of the locking of Q1 when Poisson's ratio is close to 1/2.
///
/// Both replace the dilatation ∇·u in a part of the energy by its mean over the cell; see docs/locking.md.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Cure {
    /// Full integration of everything.
    #[default]
    None,
    /// Selective reduced integration: the term λ (∇·u)² takes the mean dilatation. On quadrilaterals and
    /// parallelepipeds this is the one-point rule; on other hexahedra the one-point rule fails the patch test and the
    /// mean does not.
    Selective,
    /// B-bar: the volumetric part of the strain, (∇·u)/3 in every normal direction (also in plane strain), takes the
    /// mean dilatation.
    BBar,
}

/// The material of a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Material {
    /// −∇·(ρ∇u) = f, one unknown per node.
    Scalar {
        /// The coefficient ρ.
        rho: f64,
    },
    /// −∇·σ(u) = f, σ = λ (∇·u) I + 2μ ε(u), one unknown per node and direction.
    Elastic {
        /// Young's modulus E.
        young: f64,
        /// Poisson's ratio ν.
        poisson: f64,
        /// Plane strain, plane stress or axisymmetry; ignored in 3D.
        plane: Plane,
        /// Against locking; Q1 only.
        cure: Cure,
    },
}

/// σ = 2μ ε + (point ∇·u + mean ⟨∇·u⟩) I, where ⟨ ⟩ is the mean over the cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Moduli {
    pub shear: f64,
    pub point: f64,
    pub mean: f64,
}

impl Material {
    /// Unknowns per node: 1, or the dimension.
    pub fn components(&self, dim: usize) -> usize {
        match self {
            Material::Scalar { .. } => 1,
            Material::Elastic { .. } => dim,
        }
    }

    /// The Lamé constants (λ, μ). In plane stress λ is replaced by Eν/(1 − ν²). For a scalar problem (0, ρ).
    pub fn lame(&self, dim: usize) -> (f64, f64) {
        match *self {
            Material::Scalar { rho } => (0.0, rho),
            Material::Elastic {
                young,
                poisson,
                plane,
                ..
            } => {
                let lambda = match (dim, plane) {
                    (2, Plane::Stress) => young * poisson / (1.0 - poisson * poisson),
                    _ => young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)),
                };
                (lambda, young / (2.0 * (1.0 + poisson)))
            }
        }
    }

    /// Whether these numbers make sense with this element.
    ///
    /// # Errors
    /// One clause, without a full stop, that says what was found and what was expected; the caller knows the place.
    pub fn check(&self, dim: usize, element: Element) -> Result<(), String> {
        self.check_numbers()?;
        match *self {
            Material::Elastic {
                plane: Plane::Axial,
                ..
            } if dim == 2 => Err(
                "axisymmetry is given with cells of a box, expected plane strain or plane stress"
                    .into(),
            ),
            _ => self.check_cure(dim, element),
        }
    }

    /// Whether these numbers make sense.
    ///
    /// # Errors
    /// As [`Material::check`].
    pub(crate) fn check_numbers(&self) -> Result<(), String> {
        match *self {
            Material::Scalar { rho } if !(rho > 0.0 && rho.is_finite()) => {
                Err(format!("rho is {rho}, expected a positive number"))
            }
            Material::Scalar { .. } => Ok(()),
            Material::Elastic { young, .. } if !(young > 0.0 && young.is_finite()) => Err(format!(
                "Young's modulus is {young}, expected a positive number"
            )),
            Material::Elastic { poisson, .. } if !(poisson > -1.0 && poisson < 0.5) => Err(
                format!("Poisson's ratio is {poisson}, expected a number above -1 and below 0.5"),
            ),
            Material::Elastic { .. } => Ok(()),
        }
    }

    /// Whether the element takes the cure.
    ///
    /// # Errors
    /// As [`Material::check`].
    pub(crate) fn check_cure(&self, dim: usize, element: Element) -> Result<(), String> {
        match *self {
            Material::Scalar { .. }
            | Material::Elastic {
                cure: Cure::None, ..
            } => Ok(()),
            Material::Elastic { .. } if element == Element::P1 => Err(
                "a cure of locking is given with P1, expected Q1: P1 has no standard one".into(),
            ),
            Material::Elastic {
                plane: Plane::Stress,
                ..
            } if dim == 2 => Err(
                "a cure of locking is given with plane stress, expected none: plane stress does not lock"
                    .into(),
            ),
            Material::Elastic { .. } => Ok(()),
        }
    }

    /// The moduli of an elastic material.
    ///
    /// # Panics
    /// When [`Material::check`] would refuse a cure.
    pub(crate) fn moduli(&self, dim: usize, element: Element) -> Moduli {
        let (lambda, mu) = self.lame(dim);
        let (cure, plane) = match *self {
            Material::Scalar { .. } => (Cure::None, Plane::Strain),
            Material::Elastic { cure, plane, .. } => (cure, plane),
        };
        let refused = element == Element::P1 || (dim == 2 && plane == Plane::Stress);
        assert!(
            cure == Cure::None || !refused,
            "{cure:?} is for Q1 in plane strain or 3D"
        );
        let (point, mean) = match cure {
            Cure::None => (lambda, 0.0),
            Cure::Selective => (0.0, lambda),
            // 2μ dev ε + κ ⟨∇·u⟩ I with dev ε = ε − (∇·u)/3 I and κ = λ + 2μ/3.
            Cure::BBar => (-2.0 / 3.0 * mu, lambda + 2.0 / 3.0 * mu),
        };
        Moduli {
            shear: mu,
            point,
            mean,
        }
    }
}

#[cfg(test)]
#[path = "../../tests/cell/material.rs"]
mod tests;
