//! Materials: a scalar coefficient, or an elastic law.

use super::Element;
use crate::law::{Law, Tangent, COMPONENTS};

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
#[allow(clippy::large_enum_variant)] // made for every cell anew: it must not allocate
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Material {
    /// −∇·(ρ∇u) = f, one unknown per node.
    Scalar {
        /// The coefficient ρ.
        rho: f64,
    },
    /// −∇·σ(u) = f, one unknown per node and direction.
    Elastic {
        /// σ of ε(u).
        law: Law,
        /// Plane strain, plane stress or axisymmetry; ignored in 3D.
        plane: Plane,
        /// Against locking; Q1 only.
        cure: Cure,
    },
}

/// σ of ε, as the elements take it.
#[allow(clippy::large_enum_variant)] // made for every cell anew: it must not allocate
#[derive(Debug, Clone, Copy)]
pub(crate) enum Moduli {
    /// An isotropic law, with the mean dilatation where it is cured of locking.
    Isotropic(IsotropicModuli),
    /// Any other law; in plane stress the one that is left of it.
    General(Tangent),
}

/// σ = 2μ ε + (point ∇·u + mean ⟨∇·u⟩) I, where ⟨ ⟩ is the mean over the cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct IsotropicModuli {
    pub shear: f64,
    pub point: f64,
    pub mean: f64,
}

impl Moduli {
    /// The factor of ⟨∇·u⟩².
    pub fn mean(&self) -> f64 {
        match self {
            Moduli::Isotropic(moduli) => moduli.mean,
            Moduli::General(_) => 0.0,
        }
    }

    /// σ : ε at a point, without the part of the mean dilatation, of a displacement with this gradient.
    pub fn energy(&self, gradient: &[[f64; 3]; 3]) -> f64 {
        match self {
            Moduli::Isotropic(IsotropicModuli { shear, point, .. }) => {
                let divergence = gradient[0][0] + gradient[1][1] + gradient[2][2];
                let mut strain = 0.0;
                for i in 0..3 {
                    for j in 0..3 {
                        strain += (0.5 * (gradient[i][j] + gradient[j][i])).powi(2);
                    }
                }
                2.0 * shear * strain + point * divergence * divergence
            }
            Moduli::General(tangent) => {
                let gamma = engineering(gradient);
                let stress = tangent.stress(&gamma);
                stress.iter().zip(&gamma).map(|(s, g)| s * g).sum()
            }
        }
    }
}

/// The strains xx, yy, zz, 2xy, 2yz, 2xz of a displacement with this gradient.
pub(crate) fn engineering(gradient: &[[f64; 3]; 3]) -> [f64; 6] {
    COMPONENTS.map(|(i, j)| match i == j {
        true => gradient[i][i],
        false => gradient[i][j] + gradient[j][i],
    })
}

impl Material {
    /// Unknowns per node: 1, or the dimension.
    pub fn components(&self, dim: usize) -> usize {
        match self {
            Material::Scalar { .. } => 1,
            Material::Elastic { .. } => dim,
        }
    }

    /// The Lamé constants (λ, μ), of a law that is not isotropic those of its mean over all directions. In plane stress
    /// λ is replaced by Eν/(1 − ν²). For a scalar problem (0, ρ).
    pub fn lame(&self, dim: usize) -> (f64, f64) {
        let (law, plane) = match self {
            Material::Scalar { rho } => return (0.0, *rho),
            Material::Elastic { law, plane, .. } => (law, *plane),
        };
        let (young, poisson) = match law {
            Law::Isotropic { young, poisson } => (*young, *poisson),
            Law::General(tangent) => tangent.mean(),
        };
        let lambda = match (dim, plane) {
            (2, Plane::Stress) => young * poisson / (1.0 - poisson * poisson),
            _ => young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)),
        };
        (lambda, young / (2.0 * (1.0 + poisson)))
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
        match self {
            Material::Scalar { rho } if !(*rho > 0.0 && rho.is_finite()) => {
                Err(format!("rho is {rho}, expected a positive number"))
            }
            Material::Scalar { .. } => Ok(()),
            Material::Elastic { law, .. } => law.check(),
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
                law: Law::General(_),
                ..
            } => Err(
                "a cure of locking is given with a law that is not isotropic, expected none: cures take the \
                 dilatation apart"
                    .into(),
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

    /// The moduli of an elastic material; of a scalar one those with 2 shear = 2ρ.
    ///
    /// # Panics
    /// When [`Material::check`] refuses the cure.
    pub(crate) fn moduli(&self, dim: usize, element: Element) -> Moduli {
        let isotropic =
            |shear, point, mean| Moduli::Isotropic(IsotropicModuli { shear, point, mean });
        let (law, plane, cure) = match *self {
            Material::Scalar { rho } => return isotropic(rho, 0.0, 0.0),
            Material::Elastic { law, plane, cure } => (law, plane, cure),
        };
        if let Err(clause) = self.check_cure(dim, element) {
            panic!("{clause}");
        }
        let flat = dim == 2 && plane == Plane::Stress;
        if let Law::General(tangent) = law {
            return Moduli::General(if flat {
                tangent.plane_stress()
            } else {
                tangent
            });
        }
        let (lambda, mu) = self.lame(dim);
        match cure {
            Cure::None => isotropic(mu, lambda, 0.0),
            Cure::Selective => isotropic(mu, 0.0, lambda),
            // 2μ dev ε + κ ⟨∇·u⟩ I with dev ε = ε − (∇·u)/3 I and κ = λ + 2μ/3.
            Cure::BBar => isotropic(mu, -2.0 / 3.0 * mu, lambda + 2.0 / 3.0 * mu),
        }
    }
}

#[cfg(test)]
#[path = "../../tests/cell/material.rs"]
mod tests;
