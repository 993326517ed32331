//! Strain and stress at a point, from the gradient of the displacement there.

use super::material::{engineering, IsotropicModuli, Moduli};
use super::{Material, Plane};
use crate::law::{Law, COMPONENTS};

/// Strain and stress at a point, components xx, yy, zz, xy, yz, xz; in plane problems with those across the plane, zz,
/// which of rings are those around.
///
/// For a scalar material the first three of `strain` are ∇u and those of `stress` ρ∇u; the rest is zero.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct NodeStress {
    /// ε = (∇u + ∇uᵀ)/2: shear strains are half the engineering ones.
    pub strain: [f64; 6],
    /// σ, in the unit of Young's modulus; tension is positive.
    pub stress: [f64; 6],
}

/// Whether a material is in plane stress.
pub(crate) fn is_plane_stress(dim: usize, material: &Material) -> bool {
    let Material::Elastic { plane, .. } = material else {
        return false;
    };
    dim == 2 && *plane == Plane::Stress
}

/// Strain and stress where the displacement has this gradient, `[i][j]` = ∂u_i/∂x_j, and its cell this mean of ∇·u.
pub(crate) fn stress_of_gradient(
    dim: usize,
    material: &Material,
    moduli: Moduli,
    gradient: &[[f64; 3]; 3],
    mean_dilatation: f64,
) -> NodeStress {
    let mut out = NodeStress::default();
    let law = match material {
        Material::Scalar { rho } => {
            out.strain[..3].copy_from_slice(&gradient[0]);
            out.stress[..3].copy_from_slice(&gradient[0].map(|g| rho * g));
            return out;
        }
        Material::Elastic { law, .. } => law,
    };
    let flat = is_plane_stress(dim, material);
    let dilatation = gradient[0][0] + gradient[1][1] + gradient[2][2];
    for (c, (i, j)) in COMPONENTS.into_iter().enumerate() {
        out.strain[c] = 0.5 * (gradient[i][j] + gradient[j][i]);
    }
    match (law, moduli) {
        (Law::General(tangent), _) => {
            let mut gamma = engineering(gradient);
            if flat {
                tangent.across(&mut gamma);
                out.strain[2] = gamma[2];
            }
            out.stress = tangent.stress(&gamma);
            if flat {
                out.stress[2] = 0.0;
            }
        }
        (Law::Isotropic { poisson, .. }, Moduli::Isotropic(moduli)) => {
            let IsotropicModuli { shear, point, mean } = moduli;
            let spherical = point * dilatation + mean * mean_dilatation;
            for (c, (i, j)) in COMPONENTS.into_iter().enumerate() {
                out.stress[c] = 2.0 * shear * out.strain[c] + if i == j { spherical } else { 0.0 };
            }
            if flat {
                out.strain[2] = -poisson / (1.0 - poisson) * dilatation;
                out.stress[2] = 0.0;
            }
        }
        (Law::Isotropic { .. }, Moduli::General(_)) => {
            unreachable!("an isotropic law has isotropic moduli")
        }
    }
    out
}
