//! Strain and stress at the centre of a cell, for output.

use super::map::{centre_sample, for_each_sample, Sample};
use super::reference::Rule;
use super::{Element, Material, Plane};

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
    match dim {
        2 => centre::<2, 4>(points, element, material, nodal),
        3 => centre::<3, 8>(points, element, material, nodal),
        _ => panic!("cells have dimension 2 or 3, not {dim}"),
    }
}

fn centre<const D: usize, const N: usize>(
    points: &[[f64; 3]],
    element: Element,
    material: &Material,
    nodal: &[f64],
) -> CellStress {
    let components = material.components(D);
    let mut mean = [[0.0; 3]; 3];
    let mut volume = 0.0;
    for_each_sample::<D, N>(points, element, Rule::Stiffness, |s| {
        volume += s.weight;
        add_gradient(s, s.weight, components, nodal, &mut mean);
    });
    let mean = mean.map(|row| row.map(|v| v / volume));
    let mut gradient = mean;
    if element == Element::Q1 {
        gradient = [[0.0; 3]; 3];
        let sample = centre_sample::<D, N>(points);
        add_gradient(&sample, 1.0, components, nodal, &mut gradient);
    }
    let mut out = CellStress::default();
    if let Material::Scalar { rho } = material {
        out.strain[0] = gradient[0];
        out.stress[0] = gradient[0].map(|v| rho * v);
        return out;
    }
    let moduli = material.moduli(D, element);
    let trace = |g: &[[f64; 3]; 3]| g[0][0] + g[1][1] + g[2][2];
    let spherical = moduli.point * trace(&gradient) + moduli.mean * trace(&mean);
    for i in 0..3 {
        for j in 0..3 {
            out.strain[i][j] = 0.5 * (gradient[i][j] + gradient[j][i]);
            out.stress[i][j] = 2.0 * moduli.shear * out.strain[i][j];
        }
        out.stress[i][i] += spherical;
    }
    if let (
        2,
        Material::Elastic {
            plane: Plane::Stress,
            poisson,
            ..
        },
    ) = (D, material)
    {
        out.strain[2][2] = -poisson / (1.0 - poisson) * trace(&gradient);
        out.stress[2][2] = 0.0;
    }
    out
}

/// Adds `weight` times ∇u, `[i][j]` = ∂u_i/∂x_j.
fn add_gradient<const D: usize, const N: usize>(
    s: &Sample<D, N>,
    weight: f64,
    components: usize,
    nodal: &[f64],
    gradient: &mut [[f64; 3]; 3],
) {
    for (a, node) in nodal.chunks_exact(components).enumerate() {
        for (i, value) in node.iter().enumerate() {
            for j in 0..D {
                gradient[i][j] += weight * value * s.gradient[j][a];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{combinations, distorted, elastic, Grid, Random};
    use super::super::Cure;
    use super::*;

    /// u = G x at the corners of a cell.
    fn linear(cell: &[[f64; 3]], components: usize, g: &[[f64; 3]; 3]) -> Vec<f64> {
        cell.iter()
            .flat_map(|p| {
                let u = g.map(|r| r[0] * p[0] + r[1] * p[1] + r[2] * p[2]);
                u.into_iter().take(components)
            })
            .collect()
    }

    #[test]
    fn linear_displacements_have_their_exact_stress_on_distorted_cells() {
        let g = [[0.3, -1.1, 0.4], [0.7, 0.5, -0.2], [-0.6, 0.9, 1.3]];
        for dim in [2, 3] {
            let mut g = g;
            if dim == 2 {
                g = g.map(|r| [r[0], r[1], 0.0]);
                g[2] = [0.0; 3];
            }
            for (element, material) in combinations(dim) {
                for seed in 0..3 {
                    let cell = distorted(dim, seed);
                    let nodal = linear(&cell, material.components(dim), &g);
                    let got = centre_stress(dim, &cell, element, &material, &nodal);
                    let Material::Elastic {
                        young,
                        poisson,
                        plane,
                        ..
                    } = material
                    else {
                        assert!((got.stress[0][1] - 2.5 * g[0][1]).abs() < 1e-13);
                        continue;
                    };
                    // The law solved for the strain: E ε = (1 + ν) σ − ν tr σ I.
                    let trace = -3.0 * got.pressure();
                    // Near ν = 1/2 it subtracts large stresses.
                    let bound = 1e-14 * (10.0 + trace.abs() / young);
                    for i in 0..3 {
                        for j in 0..3 {
                            let unit = if i == j { trace } else { 0.0 };
                            let strain =
                                ((1.0 + poisson) * got.stress[i][j] - poisson * unit) / young;
                            assert!((strain - got.strain[i][j]).abs() < bound, "{material:?}");
                            let out_of_plane = dim == 2 && plane == Plane::Stress && i + j == 4;
                            let expected = 0.5 * (g[i][j] + g[j][i]);
                            assert!(out_of_plane || (strain - expected).abs() < bound);
                        }
                    }
                    if dim == 2 && plane == Plane::Stress {
                        assert_eq!(got.stress[2][2], 0.0);
                    }
                }
            }
        }
    }

    #[test]
    fn uniaxial_tension_has_von_mises_stress_and_a_third_of_it_as_tension() {
        let material = elastic(4.0, 0.3, Plane::Strain, Cure::BBar);
        let cell = distorted(3, 1);
        let g = [[0.25, 0.0, 0.0], [0.0, -0.075, 0.0], [0.0, 0.0, -0.075]];
        let got = centre_stress(3, &cell, Element::Q1, &material, &linear(&cell, 3, &g));
        assert!((got.von_mises() - 1.0).abs() < 1e-13);
        assert!((got.pressure() + 1.0 / 3.0).abs() < 1e-13);
    }

    /// The patch test to its end: the linear displacement given on the boundary, solved for inside, constant stress
    /// everywhere.
    #[test]
    fn a_patch_under_constant_strain_has_constant_stress() {
        use super::super::testing::solve;
        let g = [[0.3, -1.1, 0.4], [0.7, 0.5, -0.2], [-0.6, 0.9, 1.3]];
        for dim in [2, 3] {
            let mut random = Random::new(21);
            let grid = Grid::new(dim, [3; 3], |p| {
                p.map(|x| x + f64::from(x > 0.0 && x < 1.0) * 0.05 * random.next())
            });
            for (element, material) in combinations(dim) {
                let c = material.components(dim);
                let exact = linear(&grid.points, c, &g);
                let given: Vec<Option<f64>> = (0..exact.len())
                    .map(|dof| grid.boundary[dof / c].then_some(exact[dof]))
                    .collect();
                let k = grid.assemble(element, &material);
                let u = solve(&k, &vec![0.0; exact.len()], &given);
                let reference = {
                    let corners = grid.corners(0);
                    let nodal = linear(&corners, c, &g);
                    centre_stress(dim, &corners, element, &material, &nodal).stress
                };
                let size = reference
                    .iter()
                    .flatten()
                    .fold(1.0, |m: f64, v| m.max(v.abs()));
                for cell in 0..grid.cells.len() {
                    let nodal: Vec<f64> = grid.dofs(cell, c).iter().map(|&d| u[d]).collect();
                    let corners = grid.corners(cell);
                    let got = centre_stress(dim, &corners, element, &material, &nodal).stress;
                    for (value, expected) in got.iter().flatten().zip(reference.iter().flatten()) {
                        let error = (value - expected).abs() / size;
                        assert!(error < 1e-12, "{element:?} {material:?} {error:e}");
                    }
                }
            }
        }
    }
}
