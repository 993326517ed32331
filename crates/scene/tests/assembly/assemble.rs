//! Unit tests of `crates/scene/src/assembly/assemble.rs`.

use super::*;
use crate::assembly::load_vector;
use elements::form::Form;
use elements::q1;
use elements::q1::Quadrature;

/// A 3 × 2 mesh of elements 0.5 × 0.25 with varying ρ; the nodes in `fixed` carry the given values.
fn mesh(fixed: &[(usize, f64)]) -> SubdomainMesh {
    let elements = [3, 2, 0];
    let step = [0.5, 0.25, 0.0];
    let n = 12;
    let mut dof = vec![0; n];
    let mut prescribed = vec![0.0; n];
    for &(node, value) in fixed {
        dof[node] = SubdomainMesh::PRESCRIBED;
        prescribed[node] = value;
    }
    let mut next = 0;
    for d in &mut dof {
        if *d != SubdomainMesh::PRESCRIBED {
            *d = next;
            next += 1;
        }
    }
    SubdomainMesh {
        index: 0,
        body: 0,
        dim: 2,
        form: Form::default(),
        elements: SubdomainElements::Grid(Grid {
            elements,
            step: Some(step),
        }),
        points: (0..n)
            .map(|k| [(k % 4) as f64 * step[0], (k / 4) as f64 * step[1], 0.0])
            .collect(),
        dof,
        prescribed,
        rho: (0..6).map(|e| 1.0 + e as f64).collect(),
        poisson: Vec::new(),
        laws: Default::default(),
        heat: None,
        integration: Vec::new(),
        spring: Vec::new(),
    }
}

/// K and the load with the given values eliminated.
fn assemble(mesh: &SubdomainMesh, load: &[f64]) -> (Csr, Vec<f64>) {
    (matrix(mesh), free_load(mesh, &given_columns(mesh), load))
}

#[test]
fn the_matrix_is_the_sum_of_element_matrices() {
    let m = mesh(&[]);
    let (k, f) = assemble(&m, &[0.0; 12]);
    let mut dense = [[0.0; 12]; 12];
    let element = q1::stiffness(0.5, 0.25);
    for e in 0..6 {
        let nodes = m.grid().unwrap().element_nodes([e % 3, e / 3, 0]);
        for a in 0..4 {
            for b in 0..4 {
                dense[nodes[a]][nodes[b]] += m.rho[e] * element[a][b];
            }
        }
    }
    assert_eq!(f, vec![0.0; 12]);
    for (i, row) in dense.iter().enumerate() {
        let (col, _) = k.row(i);
        assert!(col.windows(2).all(|w| w[0] < w[1]));
        for (j, &value) in row.iter().enumerate() {
            assert!((k.get(i, j) - value).abs() < 1e-13);
            assert_eq!(k.get(i, j), k.get(j, i));
        }
    }
}

#[test]
fn constants_are_in_the_kernel_of_a_floating_subdomain() {
    let (k, _) = assemble(&mesh(&[]), &[0.0; 12]);
    let mut y = [0.0; 12];
    k.mul(&[1.0; 12], &mut y);
    assert!(y.iter().all(|v| v.abs() < 1e-13), "{y:?}");
}

#[test]
fn linear_functions_pass_the_patch_test() {
    // ρ = 1: with u = 1 + 2x − 3y prescribed on the boundary, K_FF u_F = f_F for the two inner nodes.
    let linear = |p: [f64; 3]| 1.0 + 2.0 * p[0] - 3.0 * p[1];
    let plain = mesh(&[]);
    let fixed: Vec<(usize, f64)> = (0..12)
        .filter(|k| ![5, 6].contains(k))
        .map(|k| (k, linear(plain.points[k])))
        .collect();
    let mut m = mesh(&fixed);
    m.rho = vec![1.0; 6];
    let (k, f) = assemble(&m, &[0.0; 12]);
    assert_eq!(k.n(), 2);
    let u = m.free(&m.points.iter().map(|&p| linear(p)).collect::<Vec<_>>());
    let mut y = [0.0; 2];
    k.mul(&u, &mut y);
    assert!((y[0] - f[0]).abs() < 1e-13 && (y[1] - f[1]).abs() < 1e-13);
    assert_eq!(m.nodal(&u)[6], linear(m.points[6]));
}

#[test]
fn both_rules_integrate_what_they_should() {
    let m = mesh(&[]);
    let area = 1.5 * 0.5;
    for rule in [Quadrature::Midpoint, Quadrature::Gauss] {
        let total: f64 = load_vector(&m, rule, |_, _| [2.0, 0.0, 0.0]).iter().sum();
        assert!((total - 2.0 * area).abs() < 1e-14);
    }
    // ∫ x² over [0, 1.5] × [0, 0.5], exact with two Gauss points only.
    let exact = 1.5_f64.powi(3) / 3.0 * 0.5;
    let total: f64 = load_vector(&m, Quadrature::Gauss, |_, p| [p[0] * p[0], 0.0, 0.0])
        .iter()
        .sum();
    assert!((total - exact).abs() < 1e-14);
}
