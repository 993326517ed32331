//! Bending; the matrices are compared with those of CalculiX elsewhere.

use super::super::testing::{distorted, elastic, matrix, STEEL};
use super::super::Integration;
use super::*;
use crate::cell::{Cure, Plane};
use faer::{Mat, Side};

/// ½ uᵀ K u of a beam's cell with sides `length` and `height` that is bent with curvature 1.
fn bending(kind: CellKind, length: f64, height: f64, integration: Integration) -> f64 {
    let dim = kind.dim();
    let points: Vec<[f64; 3]> = super::super::shape_functions::reference_nodes(kind)
        .into_iter()
        .map(|[x, y, z]| [0.5 * length * x, 0.5 * height * y, 0.5 * z])
        .collect();
    // Plane stress, and a beam in space whose sides are free, with ν = 0: the energy is that of beams.
    let material = elastic(3.0, 0.0, Plane::Stress, Cure::None);
    let k = matrix(kind, &points, &material, integration);
    let u = Mat::from_fn(k.nrows(), 1, |row, _| {
        let [x, y, _] = points[row / dim];
        match row % dim {
            0 => x * y,
            1 => -0.5 * x * x,
            _ => 0.0,
        }
    });
    0.5 * (u.transpose() * &k * &u)[(0, 0)]
}

#[test]
fn beams_bend_as_beams() {
    for kind in [CellKind::Quad4, CellKind::Hex8] {
        let (length, height) = (5.0_f64, 0.5_f64);
        let exact = 0.5 * 3.0 * height.powi(3) / 12.0 * length;
        let energy = bending(kind, length, height, Integration::Incompatible);
        assert!(
            (energy / exact - 1.0).abs() < 1e-12,
            "{kind:?}: {}",
            energy / exact
        );
        // The same cell without modes locks: 1 + (length/height)²/2 times as stiff with ν = 0.
        let locked = bending(kind, length, height, Integration::Full);
        let factor = 1.0 + 0.5 * (length / height).powi(2);
        assert!(
            (locked / exact / factor - 1.0).abs() < 1e-12,
            "{kind:?}: {}",
            locked / exact
        );
    }
}

#[test]
fn modes_minimise_the_energy() {
    // The gradients with modes have the energy of the condensed stiffness.
    for kind in [CellKind::Quad4, CellKind::Hex8] {
        let dim = kind.dim();
        let points = distorted(kind, 8);
        let k = matrix(kind, &points, &STEEL, Integration::Incompatible);
        let nodal: Vec<f64> = (0..k.nrows())
            .map(|i| ((i * 7 + 3) % 5) as f64 - 2.0)
            .collect();
        let u = Mat::from_fn(k.nrows(), 1, |i, _| nodal[i]);
        let expected = (u.transpose() * &k * &u)[(0, 0)];
        let moduli =
            super::super::integration::moduli(kind, dim, &STEEL, Integration::Incompatible);
        let mut weights = Vec::new();
        super::super::loads::for_each_weight(kind, &points, table(kind, Purpose::Full), |_, w| {
            weights.push(w)
        });
        let mut energy = 0.0;
        for_each_gradient(kind, &points, moduli, &nodal, |q, g| {
            energy += weights[q] * moduli.energy(&g);
        });
        assert!((energy / expected - 1.0).abs() < 1e-12, "{kind:?}");
        let full = matrix(kind, &points, &STEEL, Integration::Full);
        let softer = (full - k)
            .self_adjoint_eigenvalues(Side::Lower)
            .expect("eigenvalues");
        assert!(softer[0] > -1e-12 * softer[softer.len() - 1], "{kind:?}");
    }
}
