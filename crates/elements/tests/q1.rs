//! Unit tests of `crates/elements/src/q1.rs`.

use super::*;

/// ∂N_a/∂s and ∂N_a/∂t of the bilinear shape functions at (s, t) ∈ \[0,1\]².
fn shape_gradient(s: f64, t: f64) -> [[f64; 2]; 4] {
    [[t - 1.0, s - 1.0], [1.0 - t, -s], [-t, 1.0 - s], [t, s]]
}

#[test]
fn the_unit_square_has_the_textbook_matrix() {
    // 1/6 of [4 −1 −1 −2; −1 4 −2 −1; −1 −2 4 −1; −2 −1 −1 4].
    let expected = [
        [4.0, -1.0, -1.0, -2.0],
        [-1.0, 4.0, -2.0, -1.0],
        [-1.0, -2.0, 4.0, -1.0],
        [-2.0, -1.0, -1.0, 4.0],
    ];
    let k = stiffness(0.25, 0.25);
    for a in 0..4 {
        for b in 0..4 {
            assert!((k[a][b] - expected[a][b] / 6.0).abs() < 1e-15);
        }
    }
}

#[test]
fn a_rectangle_agrees_with_quadrature_of_the_gradients() {
    let (dx, dy) = (0.3, 1.7);
    let k = stiffness(dx, dy);
    for a in 0..4 {
        for b in 0..4 {
            let mut sum = 0.0;
            for (s, ws) in GAUSS2 {
                for (t, wt) in GAUSS2 {
                    let g = shape_gradient(s, t);
                    sum += ws
                        * wt
                        * dx
                        * dy
                        * (g[a][0] * g[b][0] / (dx * dx) + g[a][1] * g[b][1] / (dy * dy));
                }
            }
            assert!((k[a][b] - sum).abs() < 1e-14, "{a} {b}: {} {sum}", k[a][b]);
        }
    }
}

#[test]
fn rules_are_exact_for_their_degree() {
    let integrate =
        |rule: &[(f64, f64)], p: i32| -> f64 { rule.iter().map(|(x, w)| w * x.powi(p)).sum() };
    for p in 0..4 {
        assert!((integrate(&GAUSS2, p) - 1.0 / f64::from(p + 1)).abs() < 1e-15);
    }
    for p in 0..8 {
        assert!((integrate(&GAUSS4, p) - 1.0 / f64::from(p + 1)).abs() < 1e-15);
    }
    assert!((integrate(&GAUSS4, 8) - 1.0 / 9.0).abs() > 1e-8);
}
