use super::super::shape_functions::shape;
use super::super::testing::{affine, combinations, distorted, elastic, solid_kinds, Random, STEEL};
use super::*;
use crate::cell::{Cure, Plane};
use crate::law::{Law, COMPONENTS};
use faer::{Mat, Side};

/// Strain and stress of a gradient by Hooke's law as textbooks print it: ε = ((1 + ν) σ − ν tr σ)/E.
fn strain_of(stress: &[f64; 6], young: f64, poisson: f64) -> [f64; 6] {
    let trace: f64 = stress[..3].iter().sum();
    std::array::from_fn(|c| {
        let diagonal = if c < 3 { poisson * trace } else { 0.0 };
        ((1.0 + poisson) * stress[c] - diagonal) / young
    })
}

#[test]
fn linear_displacements_have_exact_stresses() {
    let slope = [[0.3, -0.2, 0.5], [0.7, 0.1, -0.3], [-0.6, 0.4, 0.9]];
    for kind in solid_kinds() {
        let dim = kind.dim();
        for (material, integration) in combinations(kind) {
            let points = distorted(kind, 3);
            let c = material.components(dim);
            let value =
                |p: &[f64; 3], i: usize| (0..dim).map(|j| slope[i][j] * p[j]).sum::<f64>() + 0.4;
            let nodal: Vec<f64> = points
                .iter()
                .flat_map(|p| (0..c).map(|i| value(p, i)).collect::<Vec<_>>())
                .collect();
            let mut out = vec![NodeStress::default(); points.len()];
            stress_at_nodes(kind, dim, &points, &material, integration, &nodal, &mut out);
            for node in out {
                match material {
                    Material::Scalar { rho } => {
                        for j in 0..dim {
                            assert!((node.strain[j] - slope[0][j]).abs() < 1e-13, "{kind:?}");
                            assert!(
                                (node.stress[j] - rho * slope[0][j]).abs() < 1e-12,
                                "{kind:?}"
                            );
                        }
                    }
                    Material::Elastic {
                        law: Law::General(tangent),
                        plane,
                        ..
                    } => {
                        for (c, (i, j)) in COMPONENTS.into_iter().enumerate() {
                            if i < dim && j < dim {
                                let expected = 0.5 * (slope[i][j] + slope[j][i]);
                                assert!((node.strain[c] - expected).abs() < 1e-12);
                            }
                        }
                        let [xx, yy, zz, xy, yz, xz] = node.strain;
                        let stress = tangent.stress(&[xx, yy, zz, 2.0 * xy, 2.0 * yz, 2.0 * xz]);
                        for c in 0..6 {
                            assert!((node.stress[c] - stress[c]).abs() < 1e-11, "{kind:?} {c}");
                        }
                        if dim == 2 && plane == Plane::Stress {
                            assert_eq!(node.stress[2], 0.0);
                        }
                    }
                    Material::Elastic {
                        law: Law::Isotropic { young, poisson },
                        plane,
                        ..
                    } => {
                        for (c, (i, j)) in COMPONENTS.into_iter().enumerate() {
                            if i < dim && j < dim {
                                let expected = 0.5 * (slope[i][j] + slope[j][i]);
                                // Next to ν = ½ the modes have rounding times λ/μ.
                                assert!(
                                    (node.strain[c] - expected).abs() < 1e-11,
                                    "{kind:?} {integration:?}"
                                );
                            }
                        }
                        // The law the other way round, also for the components across the plane.
                        let strain = strain_of(&node.stress, young, poisson);
                        for c in 0..6 {
                            assert!(
                                (strain[c] - node.strain[c]).abs() < 1e-11,
                                "{kind:?} {material:?} {c}"
                            );
                        }
                        if dim == 2 {
                            let zero = if plane == Plane::Stress {
                                node.stress[2]
                            } else {
                                node.strain[2]
                            };
                            assert_eq!(zero, 0.0);
                            let other = if plane == Plane::Stress {
                                node.strain[2]
                            } else {
                                node.stress[2]
                            };
                            assert!(poisson == 0.0 || other.abs() > 1e-3);
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn quadratic_displacements_have_exact_stresses_on_affine_cells_of_second_order() {
    // u_i = x·Q_i x/2.
    let mut random = Random::new(6);
    let mut q = [[[0.0; 3]; 3]; 3];
    for matrix in &mut q {
        for i in 0..3 {
            for j in 0..=i {
                matrix[i][j] = random.next();
                matrix[j][i] = matrix[i][j];
            }
        }
    }
    for kind in solid_kinds().filter(|kind| kind.order() == 2) {
        let dim = kind.dim();
        for (material, integration) in combinations(kind) {
            let Material::Elastic {
                law: Law::Isotropic { young, poisson },
                ..
            } = material
            else {
                continue;
            };
            let points = affine(kind);
            let slope =
                |p: &[f64; 3], i: usize, j: usize| (0..dim).map(|k| q[i][j][k] * p[k]).sum::<f64>();
            let value =
                |p: &[f64; 3], i: usize| 0.5 * (0..dim).map(|j| slope(p, i, j) * p[j]).sum::<f64>();
            let nodal: Vec<f64> = points
                .iter()
                .flat_map(|p| (0..dim).map(|i| value(p, i)).collect::<Vec<_>>())
                .collect();
            let mut out = vec![NodeStress::default(); points.len()];
            stress_at_nodes(kind, dim, &points, &material, integration, &nodal, &mut out);
            for (node, p) in out.iter().zip(&points) {
                for (c, (i, j)) in COMPONENTS.into_iter().enumerate() {
                    if i < dim && j < dim {
                        let expected = 0.5 * (slope(p, i, j) + slope(p, j, i));
                        assert!(
                            (node.strain[c] - expected).abs() < 1e-12,
                            "{kind:?} {integration:?}"
                        );
                    }
                }
                let strain = strain_of(&node.stress, young, poisson);
                for c in 0..6 {
                    assert!(
                        (strain[c] - node.strain[c]).abs() < 1e-10,
                        "{kind:?} {material:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn bending_has_exact_stresses_with_incompatible_modes() {
    for kind in [CellKind::Quad4, CellKind::Hex8] {
        let dim = kind.dim();
        let points: Vec<[f64; 3]> = super::super::shape_functions::reference_nodes(kind)
            .into_iter()
            .map(|[x, y, z]| [2.0 * x, 0.3 * y, z])
            .collect();
        let material = elastic(3.0, 0.0, Plane::Stress, Cure::None);
        let value = |&[x, y, _]: &[f64; 3], i: usize| [x * y, -0.5 * x * x, 0.0][i];
        let nodal: Vec<f64> = points
            .iter()
            .flat_map(|p| (0..dim).map(|i| value(p, i)).collect::<Vec<_>>())
            .collect();
        let mut out = vec![NodeStress::default(); points.len()];
        stress_at_nodes(
            kind,
            dim,
            &points,
            &material,
            Integration::Incompatible,
            &nodal,
            &mut out,
        );
        for (node, p) in out.iter().zip(&points) {
            let expected = [3.0 * p[1], 0.0, 0.0, 0.0, 0.0, 0.0];
            for c in 0..6 {
                assert!(
                    (node.stress[c] - expected[c]).abs() < 1e-13,
                    "{kind:?} {node:?}"
                );
            }
        }
    }
}

#[test]
fn extrapolation_and_shape_functions_agree_where_stresses_are_taken() {
    // The polynomials of second order cells are those of the linear kind: between the nodes its functions give the
    // values at the points back.
    for kind in [
        CellKind::Triangle6,
        CellKind::Quad8,
        CellKind::Tet10,
        CellKind::Hex20,
        CellKind::Quad4,
    ] {
        let (purpose, rows) = extrapolation(kind, Integration::Full);
        let table = table(kind, purpose);
        let n = table.at.len();
        for (q, &at) in table.at.iter().enumerate() {
            let values = shape(kind.linear(), at).value;
            for p in 0..n {
                let back: f64 = (0..kind.corners())
                    .map(|a| values[a] * rows[a * n + p])
                    .sum();
                let expected = f64::from(u8::from(p == q));
                assert!((back - expected).abs() < 1e-13, "{kind:?} {p} {q}");
            }
        }
    }
}

#[test]
fn with_a_cure_the_pressure_takes_the_mean_dilatation() {
    let points = distorted(CellKind::Hex8, 1);
    let nodal: Vec<f64> = (0..24).map(|i| ((i * 7 + 1) % 5) as f64).collect();
    let mut out = [NodeStress::default(); 8];
    let material = elastic(3.0, 0.49, Plane::Strain, Cure::Selective);
    stress_at_nodes(
        CellKind::Hex8,
        3,
        &points,
        &material,
        Integration::Full,
        &nodal,
        &mut out,
    );
    let (_, mu) = material.lame(3);
    let spherical = |node: &NodeStress| node.stress[0] - 2.0 * mu * node.strain[0];
    for node in &out {
        assert!((spherical(node) / spherical(&out[0]) - 1.0).abs() < 1e-10);
    }
    let material = elastic(3.0, 0.49, Plane::Strain, Cure::None);
    stress_at_nodes(
        CellKind::Hex8,
        3,
        &points,
        &material,
        Integration::Full,
        &nodal,
        &mut out,
    );
    assert!((spherical(&out[1]) / spherical(&out[0]) - 1.0).abs() > 1e-3);
}

#[test]
fn principal_stresses_are_eigenvalues() {
    let mut random = Random::new(9);
    for trial in 0..300 {
        let size = 10_f64.powi(trial % 13 - 6);
        let mut stress: [f64; 6] = std::array::from_fn(|_| size * random.next());
        if trial % 5 == 0 {
            stress[4] = 0.0;
            stress[5] = 0.0;
        }
        if trial % 7 == 0 {
            stress[3] = 1e-9 * size;
            stress[1] = stress[0];
        }
        let found = principal_stresses(&stress);
        let matrix = Mat::from_fn(3, 3, |i, j| {
            let c = COMPONENTS
                .iter()
                .position(|&(p, q)| (p, q) == (i, j) || (q, p) == (i, j));
            stress[c.expect("a component")]
        });
        let values = matrix
            .self_adjoint_eigenvalues(Side::Lower)
            .expect("eigenvalues");
        for k in 0..3 {
            assert!(
                (found[k] - values[2 - k]).abs() < 1e-14 * size,
                "{found:?} {values:?}"
            );
        }
        let [a, b, c] = found;
        let expected = (0.5 * ((a - b).powi(2) + (b - c).powi(2) + (c - a).powi(2))).sqrt();
        assert!((von_mises(&stress) - expected).abs() < 1e-13 * size);
    }
    assert_eq!(principal_stresses(&[0.0; 6]), [0.0; 3]);
    assert_eq!(
        principal_stresses(&[1.0, 3.0, 2.0, 0.0, 0.0, 0.0]),
        [3.0, 2.0, 1.0]
    );
}

#[test]
fn uniaxial_tension_has_its_stress_as_von_mises() {
    assert_eq!(von_mises(&[5.0, 0.0, 0.0, 0.0, 0.0, 0.0]), 5.0);
    assert!((von_mises(&[0.0, 0.0, 0.0, 2.0, 0.0, 0.0]) - 2.0 * 3_f64.sqrt()).abs() < 1e-15);
    assert_eq!(von_mises(&[4.0, 4.0, 4.0, 0.0, 0.0, 0.0]), 0.0);
    let _ = STEEL;
}
