//! Forward and backward substitution for up to eight right-hand sides at once. Equal subdomains share a factor, and
//! solve together.
//!
//! With a single right-hand side, each entry of the factor is read from memory and used once. Here eight right-hand
//! sides are stored side by side, row by row: each entry of the factor multiplies eight numbers in a vector register.

use super::multifrontal::PartialCholesky;
use super::panel::LOT;
use super::sweep::SweepValue;

/// Number of right-hand sides that are solved together.
pub const LANES: usize = 8;

/// The values of one unknown.
pub type Lane = [f64; LANES];

// Iterators over pairs would be calls of functions where the compiler does not see them.
#[inline(always)]
fn subtract(y: &mut Lane, l: f64, x: &Lane) {
    for i in 0..LANES {
        y[i] = (-l).mul_add(x[i], y[i]);
    }
}

#[inline(always)]
fn scale(y: &mut Lane, by: f64) {
    for y in y {
        *y *= by;
    }
}

impl PartialCholesky {
    /// Applies [`forward`](Self::forward) to at most [`LANES`] vectors, each of length n, by dof.
    pub fn forward_many(&self, columns: &mut [Vec<f64>]) {
        let mut x = self.gather(columns);
        self.lower(&mut x);
        self.scatter(&x, columns);
    }

    /// Applies [`backward`](Self::backward) to at most [`LANES`] vectors, each of length n, by dof.
    pub fn backward_many(&self, columns: &mut [Vec<f64>]) {
        let mut x = self.gather(columns);
        self.upper(&mut x);
        self.scatter(&x, columns);
    }

    /// Applies [`solve`](Self::solve) to any number of vectors, each of length n, by dof.
    pub fn solve_many(&self, columns: &mut [Vec<f64>]) {
        for lanes in columns.chunks_mut(LANES) {
            if let [one] = lanes {
                self.solve(one);
                continue;
            }
            let mut x = self.gather(lanes);
            self.lower(&mut x);
            x[self.symbolic.n_interior()..].fill([0.0; LANES]);
            self.upper(&mut x);
            self.scatter(&x, lanes);
        }
    }

    /// Gathers the columns side by side, rows in the order of elimination; unused lanes are zero.
    fn gather(&self, columns: &[Vec<f64>]) -> Vec<Lane> {
        debug_assert!(columns.len() <= LANES);
        let mut x = vec![[0.0; LANES]; self.symbolic.n()];
        for (c, column) in columns.iter().enumerate() {
            for (x, dof) in x.iter_mut().zip(self.symbolic.dofs()) {
                x[c] = column[dof as usize];
            }
        }
        x
    }

    fn scatter(&self, x: &[Lane], columns: &mut [Vec<f64>]) {
        for (c, column) in columns.iter_mut().enumerate() {
            for (x, dof) in x.iter().zip(self.symbolic.dofs()) {
                column[dof as usize] = x[c];
            }
        }
    }
}

impl SweepValue for Lane {
    #[inline(always)]
    fn add(&mut self, other: &Lane) {
        for i in 0..LANES {
            self[i] += other[i];
        }
    }

    fn eliminate<const N: usize>(group: &[f64], work: &mut [Lane]) {
        let (square, below) = group.split_at(N * N);
        let (pivots, rest) = work.split_at_mut(N);
        let mut x = [[0.0; LANES]; N];
        for k in 0..N {
            scale(&mut pivots[k], 1.0 / square[k * (N + 1)]);
            x[k] = pivots[k];
            for i in k + 1..N {
                subtract(&mut pivots[i], square[k * N + i], &x[k]);
            }
        }
        let whole = rest.len() / LOT * LOT;
        let (lots, last) = below[..N * rest.len()].split_at(N * whole);
        let (rows, few) = rest.split_at_mut(whole);
        for (l, rows) in lots.chunks_exact(N * LOT).zip(rows.chunks_exact_mut(LOT)) {
            for i in 0..LOT {
                let mut y = rows[i];
                for k in 0..N {
                    subtract(&mut y, l[k * LOT + i], &x[k]);
                }
                rows[i] = y;
            }
        }
        let r = few.len();
        for (i, y) in few.iter_mut().enumerate() {
            for k in 0..N {
                subtract(y, last[k * r + i], &x[k]);
            }
        }
    }

    fn substitute<const N: usize>(group: &[f64], work: &mut [Lane]) {
        let (square, below) = group.split_at(N * N);
        let (pivots, rest) = work.split_at_mut(N);
        let mut x = [[0.0; LANES]; N];
        x.copy_from_slice(pivots);
        let whole = rest.len() / LOT * LOT;
        let (lots, last) = below[..N * rest.len()].split_at(N * whole);
        let (rows, few) = rest.split_at(whole);
        for (l, rows) in lots.chunks_exact(N * LOT).zip(rows.chunks_exact(LOT)) {
            // The sums of a column stay in registers for a lot.
            for k in 0..N {
                let (l, mut sum) = (&l[k * LOT..][..LOT], x[k]);
                for i in 0..LOT {
                    subtract(&mut sum, l[i], &rows[i]);
                }
                x[k] = sum;
            }
        }
        for (i, w) in few.iter().enumerate() {
            for k in 0..N {
                subtract(&mut x[k], last[k * few.len() + i], w);
            }
        }
        for k in (0..N).rev() {
            for i in k + 1..N {
                let done = x[i];
                subtract(&mut x[k], square[k * N + i], &done);
            }
            scale(&mut x[k], 1.0 / square[k * (N + 1)]);
        }
        pivots.copy_from_slice(&x);
    }
}

#[cfg(test)]
#[path = "../tests/lanes.rs"]
mod tests;
