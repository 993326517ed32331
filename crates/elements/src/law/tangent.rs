//! The 6 × 6 matrix of a linear elastic law, and what it is along other axes.

use base::linalg::small::invert;

/// Rows and columns of the six components: xx, yy, zz, xy, yz, xz.
pub const COMPONENTS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)];

/// The component of the stress or strain `[i][j]`.
pub const COMPONENT: [[usize; 3]; 3] = [[0, 3, 5], [3, 1, 4], [5, 4, 2]];

/// σ = C γ with the components xx, yy, zz, xy, yz, xz of σ and of γ = (ε_xx, ε_yy, ε_zz, 2ε_xy, 2ε_yz, 2ε_xz): C has
/// the entries C_ijkl of the tensor of elasticity. Symmetric, in the unit of stress.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tangent(pub [[f64; 6]; 6]);

impl Tangent {
    /// That of an isotropic law.
    pub fn isotropic(young: f64, poisson: f64) -> Tangent {
        let lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
        let mu = young / (2.0 * (1.0 + poisson));
        let mut c = [[0.0; 6]; 6];
        for i in 0..3 {
            c[i][..3].fill(lambda);
            c[i][i] += 2.0 * mu;
            c[3 + i][3 + i] = mu;
        }
        Tangent(c)
    }

    /// The inverse of a compliance without coupling of shear: of its normal components, and the shear moduli xy, yz,
    /// xz.
    pub(super) fn of_compliance(normal: [[f64; 3]; 3], shear: [f64; 3]) -> Tangent {
        let (_, inverse) = invert(&normal);
        let mut c = [[0.0; 6]; 6];
        for i in 0..3 {
            for j in 0..3 {
                c[i][j] = 0.5 * (inverse[i][j] + inverse[j][i]);
            }
            c[3 + i][3 + i] = shear[i];
        }
        Tangent(c)
    }

    /// C_ijkl.
    #[inline(always)]
    pub fn at(&self, i: usize, j: usize, k: usize, l: usize) -> f64 {
        self.0[COMPONENT[i][j]][COMPONENT[k][l]]
    }

    /// The law whose axes are the rows of `axes`, orthonormal vectors of space, in the axes of space.
    #[must_use]
    pub fn along(&self, axes: &[[f64; 3]; 3]) -> Tangent {
        // γ along the axes is T γ of space, and σ of space is Tᵀ σ along the axes.
        let mut t = [[0.0; 6]; 6];
        for (row, (p, q)) in COMPONENTS.into_iter().enumerate() {
            for (col, (i, j)) in COMPONENTS.into_iter().enumerate() {
                let both = axes[p][i] * axes[q][j] + axes[p][j] * axes[q][i];
                // ε_pq = Σ a_pi a_qj ε_ij; shear strains count twice in γ.
                let normal = p == q;
                t[row][col] = match (normal, i == j) {
                    (true, true) => axes[p][i] * axes[p][i],
                    (true, false) => axes[p][i] * axes[p][j],
                    (false, true) => 2.0 * axes[p][i] * axes[q][i],
                    (false, false) => both,
                };
            }
        }
        let mut ct = [[0.0; 6]; 6];
        let mut out = [[0.0; 6]; 6];
        for r in 0..6 {
            for c in 0..6 {
                ct[r][c] = (0..6).map(|k| self.0[r][k] * t[k][c]).sum();
            }
        }
        for r in 0..6 {
            for c in r..6 {
                let entry: f64 = (0..6).map(|k| t[k][r] * ct[k][c]).sum();
                out[r][c] = entry;
                out[c][r] = entry;
            }
        }
        Tangent(out)
    }

    /// The law with σ_zz = σ_yz = σ_xz = 0: rows and columns of these are zero, and the strains across the plane follow
    /// from [`across`](Self::across).
    #[must_use]
    pub(crate) fn plane_stress(&self) -> Tangent {
        let mut out = [[0.0; 6]; 6];
        for r in IN_PLANE {
            for c in IN_PLANE {
                let mut gamma = [0.0; 6];
                gamma[c] = 1.0;
                self.across(&mut gamma);
                out[r][c] = (0..6).map(|k| self.0[r][k] * gamma[k]).sum();
            }
        }
        for r in IN_PLANE {
            for c in IN_PLANE {
                let mean = 0.5 * (out[r][c] + out[c][r]);
                (out[r][c], out[c][r]) = (mean, mean);
            }
        }
        Tangent(out)
    }

    /// Sets the strains zz, yz, xz of γ so that the stresses of these components vanish.
    pub(crate) fn across(&self, gamma: &mut [f64; 6]) {
        let c = &self.0;
        let block = ACROSS.map(|r| ACROSS.map(|k| c[r][k]));
        let (_, inverse) = invert(&block);
        let forces = ACROSS.map(|r| IN_PLANE.iter().map(|&k| c[r][k] * gamma[k]).sum::<f64>());
        for (r, &place) in ACROSS.iter().enumerate() {
            gamma[place] = -(0..3).map(|k| inverse[r][k] * forces[k]).sum::<f64>();
        }
    }

    /// Whether strains in the plane leave no shear across it: those of plane problems may not.
    pub fn keeps_the_plane(&self) -> bool {
        let largest = self.0.iter().flatten().fold(0.0f64, |a, v| a.max(v.abs()));
        let coupled = |r: usize| {
            [0, 1, 2, 3]
                .iter()
                .any(|&k| self.0[r][k].abs() > PLANE * largest)
        };
        !coupled(4) && !coupled(5)
    }

    /// σ of γ.
    pub fn stress(&self, gamma: &[f64; 6]) -> [f64; 6] {
        self.0
            .map(|row| row.iter().zip(gamma).map(|(c, g)| c * g).sum())
    }

    /// Young's modulus and Poisson's ratio of the isotropic law that is nearest in the mean over all directions
    /// (Voigt): those of an isotropic law itself, and the same along all axes.
    pub fn mean(&self) -> (f64, f64) {
        let c = &self.0;
        let normal = c[0][0] + c[1][1] + c[2][2];
        let beside = c[0][1] + c[1][2] + c[0][2];
        let bulk = (normal + 2.0 * beside) / 9.0;
        let shear = (normal - beside + 3.0 * (c[3][3] + c[4][4] + c[5][5])) / 15.0;
        let young = 9.0 * bulk * shear / (3.0 * bulk + shear);
        (
            young,
            (3.0 * bulk - 2.0 * shear) / (2.0 * (3.0 * bulk + shear)),
        )
    }

    /// All entries, multiplied.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Tangent {
        Tangent(self.0.map(|row| row.map(|v| factor * v)))
    }

    /// Whether every strain has a positive energy, beyond rounding.
    pub fn is_positive(&self) -> bool {
        let d: [f64; 6] = std::array::from_fn(|i| self.0[i][i]);
        if d.iter().any(|d| !(*d > 0.0 && d.is_finite())) {
            return false;
        }
        // Cholesky of the matrix with ones on its diagonal.
        let mut l = [[0.0; 6]; 6];
        for i in 0..6 {
            for j in 0..=i {
                let known: f64 = (0..j).map(|k| l[i][k] * l[j][k]).sum();
                let rest = self.0[i][j] / (d[i] * d[j]).sqrt() - known;
                if i == j {
                    if rest.is_nan() || rest <= POSITIVE {
                        return false;
                    }
                    l[i][i] = rest.sqrt();
                } else {
                    l[i][j] = rest / l[j][j];
                }
            }
        }
        true
    }
}

/// Components in the plane and across it.
const IN_PLANE: [usize; 3] = [0, 1, 3];
const ACROSS: [usize; 3] = [2, 4, 5];

/// Entries below this part of the largest come from turning the axes.
const PLANE: f64 = 1e-12;

/// Pivots of the scaled matrix from which on it is positive: a Poisson's ratio of 0.4999999 has 1e-7.
const POSITIVE: f64 = 1e-13;

#[cfg(test)]
#[path = "../../tests/law/tangent.rs"]
mod tests;
