//! Columns of rounding, by themselves and in combination.

use super::*;

/// GᵀG of rows n (t, ω × x) at points around a pin of radius 1 whose normals are turned by `off`, about `centre`.
fn pin(off: f64, centre: [f64; 2]) -> Dense {
    let mut a = Dense::zeros(3, 3);
    for k in 0..24 {
        let angle = f64::from(k) / 24.0 * std::f64::consts::TAU;
        let turned = angle + off * if k % 3 == 0 { 1.0 } else { -0.4 };
        let n = [turned.cos(), turned.sin()];
        let x = [angle.cos() - centre[0], angle.sin() - centre[1]];
        let row = [n[0], n[1], n[1] * x[0] - n[0] * x[1]];
        for (i, p) in row.iter().enumerate() {
            for (j, q) in row.iter().enumerate() {
                a.set(i, j, a.get(i, j) + p * q);
            }
        }
    }
    a
}

#[test]
fn a_turn_that_only_rounding_resists_is_weak() {
    let noise = |angle: f64| 24.0 * angle * angle;
    assert_eq!(weak_columns(&pin(1e-9, [0.0; 2]), noise(1e-8)), [2]);
    assert_eq!(weak_columns(&pin(0.0, [0.0; 2]), noise(1e-8)), [2]);
    // Normals are off by more than the digits say: the pin is no circle.
    assert!(weak_columns(&pin(1e-6, [0.0; 2]), noise(1e-8)).is_empty());
    assert!(weak_columns(&pin(1e-9, [0.0; 2]), 0.0).is_empty());
    // About another point the turn is a combination of columns.
    assert_eq!(weak_columns(&pin(1e-7, [0.3, -0.2]), noise(1e-6)).len(), 1);
}
