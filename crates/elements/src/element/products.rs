//! Integrals of products of gradients over a cell: with them a stiffness is a few additions per entry, whatever the
//! material.

use super::map::fma;
use crate::cell::{IsotropicModuli, Moduli};
use crate::law::Tangent;

/// Points that are taken together: sums are then loaded and stored once for all of them.
const BATCH: usize = 4;

/// Numbers that the processor takes together; rows are made of them, and padded with zeros.
type GradientLane = [f64; 4];

/// Integrals of products of gradients. A row has `L` lanes for the `N` nodes, 4 · L ≥ N.
pub(super) struct GradientProducts<const D: usize, const N: usize, const L: usize> {
    /// `[pair(i, j)][a][b]` = ∫ ∂_i N_a ∂_j N_b for i ≤ j; the others are their transposes. For i = j only b ≥ a is
    /// meant.
    products: [[[GradientLane; L]; N]; 6],
    /// `[i][a]` = ∫ ∂_i N_a.
    mean: [[f64; N]; D],
    volume: f64,
    /// Gradients that are not yet in the sums, and their weights.
    waiting: [[[GradientLane; L]; D]; BATCH],
    weights: [f64; BATCH],
    count: usize,
}

/// sum + x h, by value: the compiler then knows that what is read is not what is written.
#[inline(always)]
fn add(x: f64, h: GradientLane, sum: GradientLane) -> GradientLane {
    [0, 1, 2, 3].map(|c| fma(x, h[c], sum[c]))
}

/// The place of i ≤ j among the pairs.
#[inline(always)]
const fn pair(i: usize, j: usize) -> usize {
    // 00 01 11 02 12 22: the pairs of the plane come first.
    j * (j + 1) / 2 + i
}

impl<const D: usize, const N: usize, const L: usize> GradientProducts<D, N, L> {
    #[inline(always)]
    pub fn new() -> Self {
        const { assert!(4 * L >= N) };
        GradientProducts {
            products: [[[[0.0; 4]; L]; N]; 6],
            mean: [[0.0; N]; D],
            volume: 0.0,
            waiting: [[[[0.0; 4]; L]; D]; BATCH],
            weights: [0.0; BATCH],
            count: 0,
        }
    }

    /// Adds a point of the rule.
    #[inline(always)]
    pub fn add(&mut self, weight: f64, gradient: &[[f64; N]; D]) {
        self.volume += weight;
        for i in 0..D {
            for a in 0..N {
                self.mean[i][a] = fma(weight, gradient[i][a], self.mean[i][a]);
                self.waiting[self.count][i][a / 4][a % 4] = gradient[i][a];
            }
        }
        self.weights[self.count] = weight;
        self.count += 1;
        if self.count == BATCH {
            self.flush();
        }
    }

    /// Adds those that wait to the sums.
    #[inline(always)]
    fn flush(&mut self) {
        let [p, q, r, s] = &self.waiting;
        for j in 0..D {
            for i in 0..=j {
                let product = &mut self.products[pair(i, j)];
                for (a, row) in product.iter_mut().enumerate() {
                    let left = |gradient: &[[GradientLane; L]; D], weight| {
                        weight * gradient[i][a / 4][a % 4]
                    };
                    let x = left(p, self.weights[0]);
                    let y = left(q, self.weights[1]);
                    let z = left(r, self.weights[2]);
                    let w = left(s, self.weights[3]);
                    for l in if i == j { a / 4 } else { 0 }..L {
                        let sum = add(x, p[j][l], row[l]);
                        let sum = add(y, q[j][l], sum);
                        let sum = add(z, r[j][l], sum);
                        row[l] = add(w, s[j][l], sum);
                    }
                }
            }
        }
        self.weights = [0.0; BATCH];
        self.count = 0;
    }

    /// The elastic stiffness, into the (D · N)² numbers of `out`.
    #[inline(always)]
    pub fn stiffness(&mut self, moduli: Moduli, out: &mut [f64]) {
        if self.count > 0 {
            self.flush();
        }
        match moduli {
            Moduli::Isotropic(moduli) if moduli.mean == 0.0 => self.upper::<false>(moduli, out),
            Moduli::Isotropic(moduli) => self.upper::<true>(moduli, out),
            Moduli::General(tangent) => self.general(&tangent, out),
        }
        // The lower triangle is a copy.
        let n = D * N;
        for row in 0..n {
            let (upper, lower) = out.split_at_mut((row + 1) * n);
            let source = &upper[row * n + row + 1..];
            for (line, value) in lower.chunks_exact_mut(n).zip(source) {
                line[row] = *value;
            }
        }
    }

    /// The blocks on and above the diagonal.
    #[inline(always)]
    fn upper<const MEAN: bool>(&self, moduli: IsotropicModuli, out: &mut [f64]) {
        let IsotropicModuli { shear, point, mean } = moduli;
        let mean = mean / self.volume;
        let n = D * N;
        for a in 0..N {
            let rows = &mut out[n * D * a..][..n * D];
            for b in a..N {
                let mut block = [[0.0; D]; D];
                let mut trace = 0.0;
                for j in 0..D {
                    for i in 0..=j {
                        let product = &self.products[pair(i, j)];
                        // ∫ ∂_i N_a ∂_j N_b and ∫ ∂_j N_a ∂_i N_b.
                        let here = product[a][b / 4][b % 4];
                        let turned = if i == j {
                            here
                        } else {
                            product[b][a / 4][a % 4]
                        };
                        block[i][j] = point * here + shear * turned;
                        block[j][i] = point * turned + shear * here;
                    }
                    trace += self.products[pair(j, j)][a][b / 4][b % 4];
                }
                for i in 0..D {
                    block[i][i] += shear * trace; // ∫ ∇N_a·∇N_b
                    if MEAN {
                        for j in 0..D {
                            block[i][j] += mean * self.mean[i][a] * self.mean[j][b];
                        }
                    }
                    rows[n * i + D * b..][..D].copy_from_slice(&block[i]);
                }
            }
        }
    }

    /// The blocks on and above the diagonal, Σ C_ijkl ∫ ∂_j N_a ∂_l N_b for the components i and k.
    fn general(&self, tangent: &Tangent, out: &mut [f64]) {
        let n = D * N;
        for a in 0..N {
            for b in a..N {
                let product = |j: usize, l: usize| match j <= l {
                    true => self.products[pair(j, l)][a][b / 4][b % 4],
                    false => self.products[pair(l, j)][b][a / 4][a % 4],
                };
                for i in 0..D {
                    for k in 0..D {
                        let mut sum = 0.0;
                        for j in 0..D {
                            for l in 0..D {
                                sum = fma(tangent.at(i, j, k, l), product(j, l), sum);
                            }
                        }
                        out[n * (D * a + i) + D * b + k] = sum;
                    }
                }
            }
        }
    }
}
