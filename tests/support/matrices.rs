//! Small matrices and vectors for unit tests.

use base::linalg::csr::Csr;

/// The 5-point Neumann Laplacian on nx × ny nodes plus `shift` times the identity, with node positions.
pub fn grid_laplacian(nx: usize, ny: usize, shift: f64) -> (Csr, Vec<[f64; 3]>) {
    let mut triplets = Vec::new();
    let mut positions = Vec::new();
    let index = |x: usize, y: usize| (x + y * nx) as u32;
    for y in 0..ny {
        for x in 0..nx {
            positions.push([x as f64, y as f64, 0.0]);
            triplets.push((index(x, y), index(x, y), shift));
            let mut edge = |j: u32| {
                let i = index(x, y);
                triplets.extend([(i, i, 1.0), (j, j, 1.0), (i, j, -1.0), (j, i, -1.0)]);
            };
            if x + 1 < nx {
                edge(index(x + 1, y));
            }
            if y + 1 < ny {
                edge(index(x, y + 1));
            }
        }
    }
    (Csr::from_triplets(nx * ny, &triplets), positions)
}

/// The same matrix, dense.
pub fn dense_of(k: &Csr) -> faer::Mat<f64> {
    faer::Mat::from_fn(k.n(), k.n(), |i, j| k.get(i, j))
}

/// The largest difference of two vectors of one length.
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let far = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    far.fold(0.0, f64::max)
}

/// Reproducible numbers in (−1, 1).
pub fn random(n: usize, seed: u64) -> Vec<f64> {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    (0..n)
        .map(|_| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        })
        .collect()
}
