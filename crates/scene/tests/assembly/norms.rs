//! Unit tests of `crates/scene/src/assembly/norms.rs`.

use super::*;
use elements::form::Form;

#[test]
fn norms_of_a_known_difference() {
    // u_h = 0 against u = x y on [0,2] × [0,1] with ρ = 3: ∫x²y² = 8/9, ∫|∇u|² = ∫x² + y² = 8/3 + 2/3.
    let mesh = SubdomainMesh {
        index: 0,
        body: 0,
        dim: 2,
        form: Form::default(),
        elements: SubdomainElements::Grid(Grid {
            elements: [2, 1, 0],
            step: Some([1.0, 1.0, 0.0]),
        }),
        points: (0..6)
            .map(|k| [(k % 3) as f64, (k / 3) as f64, 0.0])
            .collect(),
        dof: (0..6).collect(),
        prescribed: vec![0.0; 6],
        rho: vec![3.0; 2],
        poisson: Vec::new(),
        laws: Default::default(),
        heat: None,
        integration: Vec::new(),
        spring: Vec::new(),
    };
    let exact = |[x, y, _]: [f64; 3]| ([x * y, 0.0, 0.0], [[y, x, 0.0], [0.0; 3], [0.0; 3]]);
    let squares = error_squares(&mesh, &[0.0; 6], exact);
    let norms = ErrorNorms::from_squares(squares);
    assert!((norms.l2 - (8.0_f64 / 9.0).sqrt()).abs() < 1e-14);
    assert!((norms.h1 - (10.0_f64 / 3.0).sqrt()).abs() < 1e-14);
    assert!((norms.energy - 10.0_f64.sqrt()).abs() < 1e-14);
    // The bilinear interpolant of x y is x y itself.
    let nodal: Vec<f64> = mesh.points.iter().map(|p| p[0] * p[1]).collect();
    let squares = error_squares(&mesh, &nodal, exact);
    assert!(squares.iter().all(|s| *s < 1e-28));
}
