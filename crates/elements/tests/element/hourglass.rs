//! The mean gradient and the modes; the matrices are compared with those of CalculiX elsewhere.

use super::super::testing::{distorted, matrix, STEEL};
use super::super::Integration;
use super::*;
use faer::Mat;

#[test]
fn the_mean_gradient_is_that_of_the_sides() {
    // ∫ ∂_i N_a is ∫ N_a n_i over the sides.
    for kind in [CellKind::Quad4, CellKind::Hex8] {
        let dim = kind.dim();
        let points = distorted(kind, 1);
        let mut expected = vec![[0.0; 3]; kind.nodes()];
        for side in kind.sides() {
            let nodes: Vec<usize> = side.nodes.iter().map(|&a| usize::from(a)).collect();
            let at: Vec<[f64; 3]> = nodes.iter().map(|&a| points[a]).collect();
            let weights = super::super::side_weights(side.kind, dim, &at);
            for (&a, normal) in nodes.iter().zip(weights.normal) {
                for i in 0..3 {
                    expected[a][i] += normal[i];
                }
            }
        }
        let check = |i: usize, a: usize, found: f64| {
            assert!((found - expected[a][i]).abs() < 1e-14, "{kind:?} {i} {a}");
        };
        if dim == 2 {
            let (mean, volume) = mean_gradient::<2, 4>(kind, &points);
            (0..8).for_each(|k| check(k % 2, k / 2, volume * mean[k % 2][k / 2]));
        } else {
            let (mean, volume) = mean_gradient::<3, 8>(kind, &points);
            (0..24).for_each(|k| check(k % 3, k / 3, volume * mean[k % 3][k / 3]));
        }
    }
}

#[test]
fn hourglasses_are_soft_but_not_free() {
    for kind in [CellKind::Quad4, CellKind::Hex8] {
        let dim = kind.dim();
        let points = super::super::shape_functions::reference_nodes(kind);
        let energy = |integration, mode: &dyn Fn([f64; 3]) -> f64| {
            let k = matrix(kind, &points, &STEEL, integration);
            let u = Mat::from_fn(k.nrows(), 1, |row, _| match row % dim {
                0 => mode(points[row / dim]),
                _ => 0.0,
            });
            (u.transpose() * &k * &u)[(0, 0)]
        };
        let hourglass = |[x, y, _]: [f64; 3]| x * y;
        let ratio =
            energy(Integration::Reduced, &hourglass) / energy(Integration::Full, &hourglass);
        assert!(ratio > 1e-3 && ratio < 0.05, "{kind:?}: {ratio}");
        // What is linear has the same energy.
        let linear = |[x, y, _]: [f64; 3]| x + 0.5 * y;
        let ratio = energy(Integration::Reduced, &linear) / energy(Integration::Full, &linear);
        assert!((ratio - 1.0).abs() < 1e-14, "{kind:?}: {ratio}");
    }
}
