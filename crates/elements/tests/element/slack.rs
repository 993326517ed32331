//! Unit tests of `crates/elements/src/element/slack.rs`.

use super::super::shape_functions::reference_nodes;
use super::super::stiffness;
use super::super::testing::{distorted, elastic};
use super::*;
use crate::cell::{Cure, Plane};
use crate::form::Physics;

fn form(plane: Plane) -> Form {
    Form {
        physics: Physics::Elasticity {
            plane,
            cure: Cure::None,
        },
        ..Form::default()
    }
}

/// The stiffness of a cell by rows, and its eigenvalues, the smallest first.
fn matrix(kind: CellKind, points: &[[f64; 3]], plane: Plane) -> (Vec<f64>, Vec<f64>) {
    let n = kind.nodes() * kind.dim();
    let mut k = vec![0.0; n * n];
    let material = elastic(1.0, 0.3, plane, Cure::None);
    stiffness(
        kind,
        kind.dim(),
        points,
        &material,
        Integration::Reduced,
        &mut k,
    );
    let matrix = faer::Mat::from_fn(n, n, |i, j| k[n * i + j]);
    let eigen = matrix
        .self_adjoint_eigen(faer::Side::Lower)
        .expect("eigenvalues");
    let values = eigen.S().column_vector().iter().copied().collect();
    (k, values)
}

/// As many motions as the matrix has eigenvalues zero beyond the rigid ones, and each of them has no energy: on
/// undistorted cells, needles, oblique, turned and distorted ones, of which most wedges have none.
#[test]
fn motions_are_those_of_the_matrix() {
    let reduced = [
        (CellKind::Quad8, Plane::Strain, Some(1)),
        // Its motion has no radial part at the points of integration of an upright cell.
        (CellKind::Quad8, Plane::Axial, None),
        (CellKind::Hex20, Plane::Strain, Some(6)),
        (CellKind::Wedge6, Plane::Strain, Some(1)),
        (CellKind::Wedge15, Plane::Strain, Some(0)),
    ];
    for (kind, plane, known) in reduced {
        let away = if plane == Plane::Axial { 3.0 } else { 0.0 };
        let moved = |f: &dyn Fn([f64; 3]) -> [f64; 3]| -> Vec<[f64; 3]> {
            let nodes = reference_nodes(kind).into_iter().map(f);
            nodes.map(|[x, y, z]| [x + away, y, z]).collect()
        };
        let mut shapes = vec![
            moved(&|p| p),
            moved(&|[x, y, z]| [x, 1e-3 * y, 50.0 * z]),
            moved(&|[x, y, z]| [x + 0.4 * y + 0.3 * z, y - 0.2 * z, z]),
            moved(&|[x, y, z]| [0.6 * x - 0.8 * y, 0.8 * x + 0.6 * y, z]),
        ];
        let affine = shapes.len();
        for seed in 0..6 {
            let points = distorted(kind, seed).into_iter();
            shapes.push(points.map(|[x, y, z]| [x + away, y, z]).collect());
        }
        for (s, points) in shapes.iter().enumerate() {
            let (k, values) = matrix(kind, points, plane);
            let largest = values.last().expect("eigenvalues");
            let zeros = values.iter().filter(|v| **v < 1e-11 * largest).count();
            let form = form(plane);
            let found = slack(&form, kind, points, Integration::Reduced);
            let rigid = rigid_of(&form, kind.dim(), points);
            // Needles have small eigenvalues of their own.
            if s != 1 {
                assert_eq!(found.len() + rigid.len(), zeros, "{kind:?} {plane:?} {s}");
            }
            if let Some(known) = known.filter(|_| s < affine) {
                assert_eq!(found.len(), known, "{kind:?} {plane:?} {s}");
            }
            let n = points.len() * kind.dim();
            for u in &found {
                let row = |i: usize| (0..n).map(|j| k[n * i + j] * u[j]).sum::<f64>();
                let energy: f64 = (0..n).map(|i| u[i] * row(i)).sum();
                assert!(energy.abs() < 1e-11 * largest, "{kind:?} {s}: {energy:e}");
                assert!(strain_of(&form, kind, points, Integration::Reduced, u) < 1e-11);
                assert!((u.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-12);
                for r in &rigid {
                    let both: f64 = u.iter().zip(r).map(|(a, b)| a * b).sum();
                    assert!(both.abs() < 1e-10, "{kind:?} {s}: {both:e}");
                }
            }
        }
    }
}

/// With full integration, or a stiffness against hourglasses, nothing is looked for.
#[test]
fn other_rules_leave_none() {
    let form = form(Plane::Strain);
    for kind in [CellKind::Hex20, CellKind::Wedge6] {
        assert!(slack(&form, kind, &reference_nodes(kind), Integration::Full).is_empty());
    }
    let cube = reference_nodes(CellKind::Hex8);
    assert!(slack(&form, CellKind::Hex8, &cube, Integration::Reduced).is_empty());
}
