//! The scaled jump operator B_D = (B D⁻¹ Bᵀ)⁺ B D⁻¹, block by block (docs/theory.md, section 3).
//!
//! B_Dᵀ = P_D B⁺ holds, with P_D the D-orthogonal projection along ker B. B⁺ does not depend on the weights, and P_D is
//! an average: jumps of any size in the coefficients cost no digits. Inverting B D⁻¹ Bᵀ would cost digits. B B_Dᵀ B = B
//! follows from B P_D = B.

use std::borrow::Cow;

use rustc_hash::FxHashMap;

use base::linalg::dense::Dense;
use base::linalg::sorted::distinct;

/// Rank tolerance of a block: singular values below this, relative to the largest, are zero. Entries of B are of order
/// one, and nonzero singular values are far larger.
const RANK: f64 = 1e-10;

/// B_D for the fully redundant ±1 pairs between q copies of one dof: entry of row (a, b) on copy c.
pub fn pair_entry(weights: &[f64], (a, b): (usize, usize), c: usize) -> f64 {
    let total: f64 = weights.iter().sum();
    if weights.len() == 2 {
        // δ†_b on a and −δ†_a on b, without cancellation.
        return if c == a {
            weights[b] / total
        } else {
            -weights[a] / total
        };
    }
    // P_D applied to the column (e_a − e_b) / q of B⁺: the value at c minus the weighted average.
    let value = |k: usize| f64::from(u8::from(k == a)) - f64::from(u8::from(k == b));
    let differences = weights
        .iter()
        .enumerate()
        .map(|(k, w)| w * (value(c) - value(k)));
    differences.sum::<f64>() / (total * weights.len() as f64)
}

/// B_D of blocks that are alike to the last bit: a regular scene has few that differ, and each takes an SVD.
#[derive(Debug, Default)]
pub struct ScalingCache(FxHashMap<Vec<u64>, Dense>);

impl ScalingCache {
    /// More than these are no regular scene; they are forgotten.
    const MOST: usize = 2000;

    /// [`block`], computed once.
    pub fn block(&mut self, b: &Dense, weights: &[f64], active: &[bool]) -> Cow<'_, Dense> {
        if active.iter().filter(|on| **on).count() < 2 {
            return Cow::Owned(block(b, weights, active));
        }
        let values = b.data.iter().chain(weights).map(|v| v.to_bits());
        let rows = active.iter().map(|on| u64::from(*on));
        let key: Vec<u64> = rows.chain([b.cols as u64]).chain(values).collect();
        if self.0.len() >= ScalingCache::MOST && !self.0.contains_key(&key) {
            self.0.clear();
        }
        let of = self.0.entry(key);
        Cow::Borrowed(of.or_insert_with(|| block(b, weights, active)))
    }
}

/// B_D of one block of contact rows.
///
/// `b` is rows × columns (columns are body dofs), `weights` has D of each column summed over its copies, `active`
/// selects the rows that hold (Z^k). Rows that do not hold are zero in the result.
pub fn block(b: &Dense, weights: &[f64], active: &[bool]) -> Dense {
    let (m, n) = (b.rows, b.cols);
    let rows: Vec<usize> = (0..m).filter(|&r| active[r]).collect();
    let mut out = Dense::zeros(m, n);
    if let [] | [_] = rows[..] {
        if let [r] = rows[..] {
            let row = single(b, r, weights);
            (0..n).zip(row).for_each(|(j, v)| out.set(r, j, v));
        }
        return out;
    }
    let held = faer::Mat::from_fn(rows.len(), n, |i, j| b.get(rows[i], j));
    let [u, v, sigma] = svd(&held);
    let sigma = sigma.col(0);
    let rank = (0..sigma.nrows())
        .filter(|&i| sigma[i] > RANK * sigma[0])
        .count();
    // B⁺ = V Σ⁻¹ Uᵀ, n × rows
    let mut pinv = faer::Mat::<f64>::zeros(n, rows.len());
    for l in 0..rank {
        for j in 0..rows.len() {
            for i in 0..n {
                pinv[(i, j)] += v[(i, l)] * u[(j, l)] / sigma[l];
            }
        }
    }
    let projected = match connected_parts(&held, rank) {
        Some(part) => minus_average(&part, weights, &pinv),
        None => remove_kernel(&v.subcols(rank, n - rank).to_owned(), weights, pinv),
    };
    for (i, &r) in rows.iter().enumerate() {
        for j in 0..n {
            out.set(r, j, projected[(j, i)]);
        }
    }
    out
}

/// U, V and Σ, as a column, of a matrix of a few rows. The iteration does not always come to its end where rows are
/// nearly parallel; then the rows are taken in another order.
fn svd(b: &faer::Mat<f64>) -> [faer::Mat<f64>; 3] {
    let n = b.nrows();
    let attempt = |first: usize| {
        let moved = faer::Mat::from_fn(n, b.ncols(), |i, j| b[((i + first) % n, j)]);
        let svd = moved.svd().ok()?;
        let u = svd.U();
        let back = faer::Mat::from_fn(n, u.ncols(), |i, l| u[((i + n - first) % n, l)]);
        let sigma = svd.S().column_vector().as_mat().to_owned();
        Some([back, svd.V().to_owned(), sigma])
    };
    let found = (0..n).find_map(attempt);
    found.expect("an SVD of a few rows converges in some order")
}

/// B_D of a single row: D⁻¹bᵀ / (b D⁻¹ bᵀ), zero for a row of zeros. Nothing cancels in it.
fn single(b: &Dense, r: usize, weights: &[f64]) -> Vec<f64> {
    // Weights relative to the smallest one: their inverses are at most one.
    let least = weights.iter().fold(f64::INFINITY, |a, d| a.min(*d));
    let terms = (0..b.cols).map(|j| b.get(r, j) * (least / weights[j]));
    let terms: Vec<f64> = terms.collect();
    let sum: f64 = (0..b.cols).map(|j| b.get(r, j) * terms[j]).sum();
    if sum > 0.0 {
        terms.iter().map(|t| t / sum).collect()
    } else {
        terms
    }
}

/// An orthonormal basis of range B for a matrix of a few rows.
pub fn range(b: &faer::Mat<f64>) -> faer::Mat<f64> {
    let [u, _, sigma] = svd(b);
    let sigma = sigma.col(0);
    let rank = (0..sigma.nrows()).filter(|&i| sigma[i] > RANK * sigma[0]);
    u.subcols(0, rank.count()).to_owned()
}

/// The connected component of each column if the rows only take differences within components. Indicators of the
/// components then span ker B. `None` for other rows.
fn connected_parts(b: &faer::Mat<f64>, rank: usize) -> Option<Vec<usize>> {
    let n = b.ncols();
    let mut part: Vec<usize> = (0..n).collect();
    for r in 0..b.nrows() {
        let touched: Vec<usize> = (0..n).filter(|&j| b[(r, j)] != 0.0).collect();
        for w in touched.windows(2) {
            let (keep, drop) = (part[w[0]], part[w[1]]);
            part.iter_mut()
                .filter(|p| **p == drop)
                .for_each(|p| *p = keep);
        }
    }
    let names = distinct(part.clone());
    let differences = (0..b.nrows()).all(|r| {
        let sum = |p: &usize| {
            (0..n)
                .filter(|&j| part[j] == *p)
                .map(|j| b[(r, j)])
                .sum::<f64>()
        };
        names.iter().all(|p| sum(p).abs() <= RANK)
    });
    (differences && names.len() == n - rank).then_some(part)
}

/// P_D x if indicators span ker B: x minus its weighted average over each component. It is computed from differences,
/// so that the small values of heavy columns keep all their digits.
fn minus_average(part: &[usize], d: &[f64], x: &faer::Mat<f64>) -> faer::Mat<f64> {
    faer::Mat::from_fn(x.nrows(), x.ncols(), |j, c| {
        let together = (0..part.len()).filter(|&k| part[k] == part[j]);
        let (mut sum, mut total) = (0.0, 0.0);
        for k in together {
            sum += d[k] * (x[(j, c)] - x[(k, c)]);
            total += d[k];
        }
        sum / total
    })
}

/// P_D x = x − N (Nᵀ D N)⁻¹ Nᵀ D x with ker B = range N.
fn remove_kernel(n: &faer::Mat<f64>, d: &[f64], x: faer::Mat<f64>) -> faer::Mat<f64> {
    use faer::linalg::solvers::Solve;
    let dn = faer::Mat::from_fn(n.nrows(), n.ncols(), |i, j| d[i] * n[(i, j)]);
    let gram = n.transpose() * &dn;
    let coefficients = gram.partial_piv_lu().solve(dn.transpose() * &x);
    x - n * coefficients
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/jump/scaling.rs"]
mod tests;
