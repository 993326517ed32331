//! Unit tests of `crates/elements/src/cell/stress.rs`.

use super::super::testing::{combinations, distorted, elastic, Grid, Random};
use super::super::Cure;
use super::*;
use crate::cell::Plane;
use crate::law::Law;

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
                    law: Law::Isotropic { young, poisson },
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
                        let strain = ((1.0 + poisson) * got.stress[i][j] - poisson * unit) / young;
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
