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
#[path = "../../tests/cell/rigid.rs"]
mod tests;
