//! Unit tests of `crates/elements/src/cell/rigid.rs`.

use super::*;

#[test]
fn the_motions_are_of_order_one_and_strain_nothing() {
    let centre = [1e3, -2e3, 5e2];
    let scale = 4.0;
    for dim in [2, 3] {
        let at = |p: [f64; 3]| {
            let p = std::array::from_fn(|i| centre[i] + scale * p[i]);
            rigid_motions(dim, centre, scale, p)
        };
        let unit = |i: usize| std::array::from_fn(|j| f64::from(i == j));
        let origin = at([0.0; 3]);
        for mode in 0..rigid_count(dim) {
            // Linear in the point: the differences along the axes are the gradient, which is skew.
            for i in 0..dim {
                for j in 0..dim {
                    let slope = at(unit(j))[mode][i] - origin[mode][i];
                    let turned = at(unit(i))[mode][j] - origin[mode][j];
                    assert!((slope + turned).abs() < 1e-15);
                }
                assert!(at([1.0; 3])[mode][i].abs() <= 1.0);
            }
            let moves = at([1.0, 2.0, 3.0])[mode];
            assert!(moves.iter().any(|v| v.abs() >= 1.0));
        }
    }
}
