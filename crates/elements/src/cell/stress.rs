//! Strain and stress at the centre of a cell, for output.

use super::map::{centre_sample, for_each_sample_of, CellSample};
use super::reference::Rule;
use super::{stress_of_gradient, Element, Material, NodeStress};
use crate::law::COMPONENT;

/// Strain and stress, with the components out of the plane in 2D.
///
/// For a scalar material the first row of `strain` is ∇u and that of `stress` is ρ∇u; the rest is zero.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CellStress {
    /// ε = (∇u + ∇uᵀ)/2.
    pub strain: [[f64; 3]; 3],
    /// σ, in the unit of Young's modulus; tension is positive.
    pub stress: [[f64; 3]; 3],
}

impl CellStress {
    /// −tr σ/3: positive under compression.
    pub fn pressure(&self) -> f64 {
        -(0..3).map(|i| self.stress[i][i]).sum::<f64>() / 3.0
    }

    /// The equivalent stress of von Mises, (3/2 s:s)^½ with the deviator s = σ + pI.
    pub fn von_mises(&self) -> f64 {
        let pressure = self.pressure();
        let mut sum = 0.0;
        for (i, row) in self.stress.iter().enumerate() {
            for (j, value) in row.iter().enumerate() {
                let deviator = if i == j { value + pressure } else { *value };
                sum += deviator * deviator;
            }
        }
        (1.5 * sum).sqrt()
    }
}

/// Strain and stress at the centre of a cell; with P1 their mean over the simplices.
///
/// The dilatation in the stress is the one of the stiffness: with a cure its mean over the cell, which keeps the
/// pressure from oscillating by λ times an error.
///
/// # Panics
/// When `dim` is not 2 or 3, a length is wrong, or the material is refused by [`Material::check`] for its cure.
pub fn centre_stress(
    dim: usize,
    points: &[[f64; 3]],
    element: Element,
    material: &Material,
    nodal: &[f64],
) -> CellStress {
    let n = points.len() * material.components(dim);
    assert_eq!(nodal.len(), n, "a cell has {n} degrees of freedom");
    let components = material.components(dim);
    let mut mean = [[0.0; 3]; 3];
    let mut volume = 0.0;
    for_each_sample_of(dim, points, element, Rule::Stiffness, |s| {
        volume += s.weight;
        add_gradient(s, s.weight, components, nodal, &mut mean);
    });
    let mean = mean.map(|row| row.map(|v| v / volume));
    let mut gradient = mean;
    if element == Element::Q1 {
        gradient = [[0.0; 3]; 3];
        let sample = centre_sample(dim, points);
        add_gradient(&sample, 1.0, components, nodal, &mut gradient);
    }
    let trace = mean[0][0] + mean[1][1] + mean[2][2];
    if let Material::Scalar { rho } = material {
        let mut out = CellStress::default();
        out.strain[0] = gradient[0];
        out.stress[0] = gradient[0].map(|v| rho * v);
        return out;
    }
    let moduli = material.moduli(dim, element);
    let NodeStress { strain, stress } = stress_of_gradient(dim, material, moduli, &gradient, trace);
    let tensor = |c: &[f64; 6]| COMPONENT.map(|row| row.map(|k| c[k]));
    CellStress {
        strain: tensor(&strain),
        stress: tensor(&stress),
    }
}

/// Adds `weight` times ∇u, `[i][j]` = ∂u_i/∂x_j.
fn add_gradient(
    s: &CellSample,
    weight: f64,
    components: usize,
    nodal: &[f64],
    gradient: &mut [[f64; 3]; 3],
) {
    for (a, node) in nodal.chunks_exact(components).enumerate() {
        for (i, value) in node.iter().enumerate() {
            for j in 0..3 {
                gradient[i][j] += weight * value * s.gradient[j][a];
            }
        }
    }
}

#[cfg(test)]
#[path = "../../tests/cell/stress.rs"]
mod tests;
