//! Symmetric positive semidefinite dense systems with rank detection.
//!
//! They arise where columns of a basis may be linearly dependent (Z_cᵀ S̃ Z_c, Gᵀ Q G). Dependent columns are dropped,
//! which gives a generalised inverse on the span of the others.

use super::dense::{Dense, Scratch};
use crate::linalg::dense;

/// After scaling to unit diagonal, a pivot below this means that the column depends on those before it. Rounding in
/// sums of many subdomains' contributions leaves about 1e-14.
pub const DEPENDENT: f64 = 1e-10;

/// A column whose diagonal entry is below this fraction of the largest one is zero: no coefficient scaling is that
/// small.
pub const ZERO: f64 = 1e-30;

/// Steps of inverse iteration that tell whether a matrix is singular.
const INVERSE: usize = 3;

/// A factored semidefinite matrix A (n × n).
#[derive(Debug)]
pub struct Semidefinite {
    n: usize,
    /// Columns that are not zero.
    nonzero: usize,
    /// Indices of the independent columns, increasing.
    pub kept: Vec<usize>,
    /// 1/√A_ii of the kept columns.
    scale: Vec<f64>,
    /// Cholesky factor of the scaled kept part.
    l: Dense,
}

impl Semidefinite {
    /// Number of columns that are not zero.
    pub fn nonzero(&self) -> usize {
        self.nonzero
    }

    /// Factors `a`; reads the lower triangle.
    pub fn new(a: &Dense) -> Semidefinite {
        Semidefinite::above(a, DEPENDENT)
    }

    /// Factors `a`, and drops columns whose pivots are below `dependent` relative to their diagonal entries.
    pub fn above(a: &Dense, dependent: f64) -> Semidefinite {
        let n = a.rows;
        let largest = (0..n).map(|i| a.get(i, i)).fold(0.0, f64::max);
        // Zero columns are dropped first.
        let nonzero: Vec<usize> = (0..n).filter(|&i| a.get(i, i) > ZERO * largest).collect();
        let known = |out: Semidefinite| Semidefinite {
            nonzero: nonzero.len(),
            ..out
        };
        // Without a choice of pivots a dependent column need not show: the last pivot is rounding over the square of
        // its coefficient in the combination that vanishes.
        let regular = Self::factor(a, &nonzero, dependent);
        if let Some(out) = regular.filter(|out| out.weakest() > dependent) {
            return known(out);
        }
        let mut kept = independent(a, &nonzero, dependent);
        kept.sort_unstable();
        // This order differs from the pivoted one, which may make a pivot slightly smaller: only its sign matters now.
        loop {
            if let Some(out) = Self::factor(a, &kept, 0.0) {
                return known(out);
            }
            kept.pop();
        }
    }

    fn factor(a: &Dense, kept: &[usize], tolerance: f64) -> Option<Semidefinite> {
        let scale: Vec<f64> = kept.iter().map(|&i| 1.0 / a.get(i, i).sqrt()).collect();
        let mut l = Dense::zeros(kept.len(), kept.len());
        for (j, &kj) in kept.iter().enumerate() {
            for (i, &ki) in kept.iter().enumerate().skip(j) {
                l.set(i, j, a.get(ki, kj) * scale[i] * scale[j]);
            }
        }
        dense::cholesky(l.view_mut(), &mut Scratch::default()).ok()?;
        let regular = (0..kept.len()).all(|j| l.get(j, j).powi(2) > tolerance);
        regular.then(|| Semidefinite {
            n: a.rows,
            nonzero: kept.len(),
            kept: kept.to_vec(),
            scale,
            l,
        })
    }

    /// An upper bound of the smallest eigenvalue of the scaled kept part, near it as a rule: inverse iteration.
    fn weakest(&self) -> f64 {
        let norm = |x: &Dense| x.data.iter().map(|v| v * v).sum::<f64>().sqrt();
        let mut x = Dense::from_fn(self.kept.len(), 1, |i, _| {
            1.0 + ((i * 7919) % 13) as f64 / 13.0
        });
        let mut least = f64::INFINITY;
        for _ in 0..INVERSE {
            let before = norm(&x);
            dense::solve_lower(self.l.view(), x.view_mut());
            dense::solve_lower_transpose(self.l.view(), x.view_mut());
            let after = norm(&x);
            least = least.min(before / after);
            x.data.iter_mut().for_each(|v| *v /= after);
        }
        least
    }

    /// Rank of the matrix.
    pub fn rank(&self) -> usize {
        self.kept.len()
    }

    /// Indices of the columns that were dropped, increasing.
    pub fn dropped(&self) -> Vec<usize> {
        let kept = &self.kept;
        (0..self.n)
            .filter(|i| kept.binary_search(i).is_err())
            .collect()
    }

    /// x ← A⁺ x (zero in the dropped entries).
    pub fn solve(&self, x: &mut [f64]) {
        let mut y = Dense::zeros(self.kept.len(), 1);
        for ((y, &i), s) in y.data.iter_mut().zip(&self.kept).zip(&self.scale) {
            *y = x[i] * s;
        }
        dense::solve_lower(self.l.view(), y.view_mut());
        dense::solve_lower_transpose(self.l.view(), y.view_mut());
        x.fill(0.0);
        for ((y, &i), s) in y.data.iter().zip(&self.kept).zip(&self.scale) {
            x[i] = y * s;
        }
    }
}

/// Independent columns by Cholesky factorisation with diagonal pivoting.
fn independent(a: &Dense, among: &[usize], dependent: f64) -> Vec<usize> {
    let m = among.len();
    let scale: Vec<f64> = among.iter().map(|&i| 1.0 / a.get(i, i).sqrt()).collect();
    let entry = |i: usize, j: usize| {
        let (p, q) = (among[i].max(among[j]), among[i].min(among[j]));
        a.get(p, q) * scale[i] * scale[j]
    };
    let mut left: Vec<f64> = vec![1.0; m];
    let mut columns: Vec<Vec<f64>> = Vec::new();
    let mut kept = Vec::new();
    loop {
        let best = (0..m).max_by(|&i, &j| left[i].total_cmp(&left[j]).then(j.cmp(&i)));
        let Some(p) = best.filter(|&p| left[p] > dependent) else {
            return kept;
        };
        let root = left[p].sqrt();
        let column: Vec<f64> = (0..m)
            .map(|i| {
                let known: f64 = columns.iter().map(|c| c[i] * c[p]).sum();
                (entry(i, p) - known) / root
            })
            .collect();
        for (l, c) in left.iter_mut().zip(&column) {
            *l -= c * c;
        }
        left[p] = f64::NEG_INFINITY;
        kept.push(among[p]);
        columns.push(column);
    }
}

#[cfg(test)]
#[path = "../../tests/linalg/semidefinite.rs"]
mod tests;
