//! Forward and backward substitution for up to eight right-hand sides at once. Equal subdomains share a factor, and
//! solve together.
//!
//! With a single right-hand side, each entry of the factor is read from memory and used once. Here eight right-hand
//! sides are stored side by side, row by row: each entry of the factor multiplies eight numbers in a vector register.

use super::multifrontal::PartialCholesky;
use super::panel;

/// Number of right-hand sides that are solved together.
pub const LANES: usize = 8;

type Lane = [f64; LANES];

fn subtract(y: &mut Lane, l: f64, x: &Lane) {
    y.iter_mut()
        .zip(x)
        .for_each(|(y, x)| *y = (-l).mul_add(*x, *y));
}

fn scale(y: &mut Lane, by: f64) {
    y.iter_mut().for_each(|y| *y *= by);
}

impl PartialCholesky {
    /// Applies [`forward`](Self::forward) to at most [`LANES`] vectors, each of length n, by dof.
    pub fn forward_many(&self, columns: &mut [Vec<f64>]) {
        let mut x = self.gather(columns);
        self.lower_lanes(&mut x);
        self.scatter(&x, columns);
    }

    /// Applies [`backward`](Self::backward) to at most [`LANES`] vectors, each of length n, by dof.
    pub fn backward_many(&self, columns: &mut [Vec<f64>]) {
        let mut x = self.gather(columns);
        self.upper_lanes(&mut x);
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
            self.lower_lanes(&mut x);
            x[self.symbolic.n_interior()..].fill([0.0; LANES]);
            self.upper_lanes(&mut x);
            self.scatter(&x, lanes);
        }
    }

    fn lower_lanes(&self, x: &mut [Lane]) {
        for front in &self.symbolic.fronts {
            let (width, size) = (front.width(), front.size());
            let panel = &self.panels[front.panel..];
            let (head, below) = x.split_at_mut(front.end);
            let pivots = &mut head[front.start..];
            for j in 0..width {
                let (start, first) = panel::column(j, size);
                let l = &panel[start..][..width - first];
                let (done, rest) = pivots.split_at_mut(j + 1);
                scale(&mut done[j], 1.0 / l[j - first]);
                for (y, &l) in rest.iter_mut().zip(&l[j + 1 - first..]) {
                    subtract(y, l, &done[j]);
                }
            }
            for j in (0..width).step_by(panel::COLUMNS) {
                let rows = size - j;
                let group = &panel[panel::group(j, size)..];
                let at = |k: usize| &group[k * rows + width - j..(k + 1) * rows];
                if j + panel::COLUMNS <= width {
                    let (l0, l1, l2, l3) = (at(0), at(1), at(2), at(3));
                    for (k, &p) in front.below.iter().enumerate() {
                        let y = &mut below[p as usize - front.end];
                        subtract(y, l0[k], &pivots[j]);
                        subtract(y, l1[k], &pivots[j + 1]);
                        subtract(y, l2[k], &pivots[j + 2]);
                        subtract(y, l3[k], &pivots[j + 3]);
                    }
                } else {
                    for (k, pivot) in pivots[j..].iter().enumerate() {
                        for (&p, &l) in front.below.iter().zip(at(k)) {
                            subtract(&mut below[p as usize - front.end], l, pivot);
                        }
                    }
                }
            }
        }
    }

    fn upper_lanes(&self, x: &mut [Lane]) {
        for front in self.symbolic.fronts.iter().rev() {
            let (width, size) = (front.width(), front.size());
            let panel = &self.panels[front.panel..];
            let (head, below) = x.split_at_mut(front.end);
            let pivots = &mut head[front.start..];
            let column = |j: usize| {
                let (start, first) = panel::column(j, size);
                &panel[start + j - first..start + size - first]
            };
            for (j, y) in pivots.iter_mut().enumerate() {
                let mut sum = *y;
                for (&p, &l) in front.below.iter().zip(&column(j)[width - j..]) {
                    subtract(&mut sum, l, &below[p as usize - front.end]);
                }
                *y = sum;
            }
            for j in (0..width).rev() {
                let l = column(j);
                let (first, done) = pivots.split_at_mut(j + 1);
                let y = &mut first[j];
                for (x, &l) in done.iter().zip(&l[1..width - j]) {
                    subtract(y, l, x);
                }
                scale(y, 1.0 / l[0]);
            }
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

#[cfg(test)]
#[path = "../../tests/inside/cholesky/lanes.rs"]
mod tests;
