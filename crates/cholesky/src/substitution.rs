//! Forward and backward substitution for one right-hand side.

use super::multifrontal::PartialCholesky;
use super::panel::LOT;
use super::sweep::SweepValue;

impl PartialCholesky {
    /// Forward elimination: `b` (length n, by dof) becomes [L_II⁻¹ b_I; b_Γ − L_ΓI L_II⁻¹ b_I].
    ///
    /// The interface part is the condensed load g = f_Γ − K_ΓI K_II⁻¹ f_I.
    pub fn forward(&self, b: &mut [f64]) {
        let mut y = self.in_order(b);
        self.lower(&mut y);
        self.by_dof(&y, b);
    }

    /// Back substitution: given [y_I; u_Γ] with y_I from [`forward`](Self::forward), leaves [u_I; u_Γ].
    pub fn backward(&self, b: &mut [f64]) {
        let mut y = self.in_order(b);
        self.upper(&mut y);
        self.by_dof(&y, b);
    }

    /// `b` ← [K_II⁻¹ b_I; 0].
    pub fn solve(&self, b: &mut [f64]) {
        let mut y = self.in_order(b);
        self.lower(&mut y);
        y[self.symbolic.n_interior()..].fill(0.0);
        self.upper(&mut y);
        self.by_dof(&y, b);
    }

    pub(super) fn in_order(&self, b: &[f64]) -> Vec<f64> {
        self.symbolic.dofs().map(|i| b[i as usize]).collect()
    }

    pub(super) fn by_dof(&self, y: &[f64], b: &mut [f64]) {
        for (y, i) in y.iter().zip(self.symbolic.dofs()) {
            b[i as usize] = *y;
        }
    }
}

impl SweepValue for f64 {
    fn add(&mut self, other: &f64) {
        *self += other;
    }

    fn eliminate<const N: usize>(group: &[f64], work: &mut [f64]) {
        let (square, below) = group.split_at(N * N);
        let (x, rest) = work.split_at_mut(N);
        let inverse = reciprocals::<N>(square);
        let mut minus = [0.0; N];
        for k in 0..N {
            x[k] *= inverse[k];
            for i in k + 1..N {
                x[i] -= square[k * N + i] * x[k];
            }
            minus[k] = -x[k];
        }
        let below = &below[..N * rest.len()];
        let (mut lots, mut rows) = (below.chunks_exact(N * LOT), rest.chunks_exact_mut(LOT));
        for (l, y) in (&mut lots).zip(&mut rows) {
            let y: &mut EntryChunk = y.try_into().expect("as long");
            let mut sum = *y;
            for (k, x) in minus.iter().enumerate() {
                let l = lot(l, k);
                for i in 0..LOT {
                    sum[i] = l[i].mul_add(*x, sum[i]);
                }
            }
            *y = sum;
        }
        let (l, y) = (lots.remainder(), rows.into_remainder());
        let r = y.len();
        for (i, y) in y.iter_mut().enumerate() {
            for (k, x) in minus.iter().enumerate() {
                *y = l[k * r + i].mul_add(*x, *y);
            }
        }
    }

    fn substitute<const N: usize>(group: &[f64], work: &mut [f64]) {
        let (square, below) = group.split_at(N * N);
        let (x, rest) = work.split_at_mut(N);
        let whole = rest.len() / LOT * LOT;
        let (lots, l) = below[..N * rest.len()].split_at(N * whole);
        let (rows, w) = rest.split_at(whole);
        let r = w.len();
        let mut last = [0.0; N];
        for (i, w) in w.iter().enumerate() {
            for (k, last) in last.iter_mut().enumerate() {
                *last = l[k * r + i].mul_add(*w, *last);
            }
        }
        // From the end to the start, as the groups come: memory is read in one direction.
        let mut sums = [[0.0; LOT]; N];
        let lots = lots.chunks_exact(N * LOT).rev();
        for (l, w) in lots.zip(rows.chunks_exact(LOT).rev()) {
            let w = lot(w, 0);
            for (k, sum) in sums.iter_mut().enumerate() {
                let l = lot(l, k);
                for i in 0..LOT {
                    sum[i] = l[i].mul_add(w[i], sum[i]);
                }
            }
        }
        let inverse = reciprocals::<N>(square);
        for k in (0..N).rev() {
            let [a, b, c, d, e, f, g, h] = sums[k];
            let sum = ((a + e) + (c + g)) + ((b + f) + (d + h));
            let inside: f64 = (k + 1..N).map(|i| square[k * N + i] * x[i]).sum();
            x[k] = (x[k] - (sum + last[k]) - inside) * inverse[k];
        }
    }
}

/// The reciprocals of the pivots in a square, computed first: these divisions do not depend on each other.
fn reciprocals<const N: usize>(square: &[f64]) -> [f64; N] {
    std::array::from_fn(|k| 1.0 / square[k * (N + 1)])
}

/// A fixed number of entries that are processed together.
type EntryChunk = [f64; LOT];

/// Lot `k` of `values`.
fn lot(values: &[f64], k: usize) -> &EntryChunk {
    values[k * LOT..][..LOT].try_into().expect("as long")
}

#[cfg(test)]
#[path = "../tests/substitution.rs"]
mod tests;
