//! Rigid motions of elastic bodies.

/// Number of rigid motions of an elastic body: 3 or 6.
pub fn rigid_count(dim: usize) -> usize {
    dim * (dim + 1) / 2
}

/// The displacements at `point` in the rigid motions: translations along the axes, then rotations (in 2D one; in 3D
/// about x, y, z).
///
/// Rotations are (infinitesimal) about `centre` and divided by `scale`, a length like the body's radius, so that all
/// entries are of order one. Only the first [`rigid_count`] motions and the first `dim` components are meant.
pub fn rigid_motions(dim: usize, centre: [f64; 3], scale: f64, point: [f64; 3]) -> [[f64; 3]; 6] {
    let [x, y, z] = std::array::from_fn(|i| (point[i] - centre[i]) / scale);
    let mut motions = [[0.0; 3]; 6];
    for (i, motion) in motions.iter_mut().enumerate().take(dim) {
        motion[i] = 1.0;
    }
    if dim == 2 {
        motions[2] = [-y, x, 0.0];
    } else {
        motions[3] = [0.0, -z, y];
        motions[4] = [z, 0.0, -x];
        motions[5] = [-y, x, 0.0];
    }
    motions
}

#[cfg(test)]
mod tests {
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
}
