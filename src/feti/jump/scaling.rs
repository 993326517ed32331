//! The scaled jump operator B_D = (B D⁻¹ Bᵀ)⁺ B D⁻¹, block by block (docs/theory.md, section 3).
//!
//! B_Dᵀ = P_D B⁺ holds, with P_D the D-orthogonal projection along ker B. B⁺ does not depend on the weights, and P_D is
//! an average: jumps of any size in the coefficients cost no digits. Inverting B D⁻¹ Bᵀ would cost digits. B B_Dᵀ B = B
//! follows from B P_D = B.

use crate::linalg::dense::Dense;

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

/// B_D of one block of contact rows.
///
/// `b` is rows × columns (columns are body dofs), `weights` has D of each column summed over its copies, `active`
/// selects the rows that hold (Z^k). Rows that do not hold are zero in the result.
pub fn block(b: &Dense, weights: &[f64], active: &[bool]) -> Dense {
    let (m, n) = (b.rows, b.cols);
    let rows: Vec<usize> = (0..m).filter(|&r| active[r]).collect();
    let mut out = Dense::zeros(m, n);
    if rows.is_empty() {
        return out;
    }
    let held = faer::Mat::from_fn(rows.len(), n, |i, j| b.get(rows[i], j));
    let svd = held
        .svd()
        .expect("an SVD of a tiny finite matrix converges");
    let sigma = svd.S().column_vector();
    let rank = (0..sigma.nrows())
        .filter(|&i| sigma[i] > RANK * sigma[0])
        .count();
    // B⁺ = V Σ⁻¹ Uᵀ, n × rows
    let mut pinv = faer::Mat::<f64>::zeros(n, rows.len());
    for l in 0..rank {
        for j in 0..rows.len() {
            for i in 0..n {
                pinv[(i, j)] += svd.V()[(i, l)] * svd.U()[(j, l)] / sigma[l];
            }
        }
    }
    let projected = match connected_parts(&held, rank) {
        Some(part) => minus_average(&part, weights, &pinv),
        None => remove_kernel(&svd.V().subcols(rank, n - rank).to_owned(), weights, pinv),
    };
    for (i, &r) in rows.iter().enumerate() {
        for j in 0..n {
            out.set(r, j, projected[(j, i)]);
        }
    }
    out
}

/// An orthonormal basis of range B for a matrix of a few rows.
pub fn range(b: &faer::Mat<f64>) -> faer::Mat<f64> {
    let svd = b.svd().expect("an SVD of a tiny finite matrix converges");
    let sigma = svd.S().column_vector();
    let rank = (0..sigma.nrows()).filter(|&i| sigma[i] > RANK * sigma[0]);
    svd.U().subcols(0, rank.count()).to_owned()
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
    let mut names = part.clone();
    names.sort_unstable();
    names.dedup();
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
mod tests {
    use super::*;

    fn incidence(pairs: &[(usize, usize)], n: usize) -> Dense {
        let mut b = Dense::zeros(pairs.len(), n);
        for (r, &(i, j)) in pairs.iter().enumerate() {
            b.set(r, i, 1.0);
            b.set(r, j, -1.0);
        }
        b
    }

    const CROSS: [(usize, usize); 6] = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];

    #[test]
    fn cross_point_reproduces_the_papers_weights_on_jumps() {
        // On λ = B v the entries ±δ† of [Lee] and those of this code both give v minus its weighted average.
        let weights = [1e6, 1e-6, 2.0, 1e-6];
        let b = incidence(&CROSS, 4);
        let bd = block(&b, &weights, &[true; 6]);
        let v = [0.3, -1.0, 0.7, 2.0];
        let total: f64 = weights.iter().sum();
        let mean: f64 = v.iter().zip(&weights).map(|(v, w)| v * w).sum::<f64>() / total;
        for i in 0..4 {
            let ours: f64 = (0..6)
                .map(|r| bd.get(r, i) * (v[CROSS[r].0] - v[CROSS[r].1]))
                .sum();
            let paper: f64 = (0..6)
                .map(|r| {
                    let (a, c) = CROSS[r];
                    let entry = if i == a {
                        weights[c] / total
                    } else if i == c {
                        -weights[a] / total
                    } else {
                        0.0
                    };
                    entry * (v[a] - v[c])
                })
                .sum();
            assert!((ours - (v[i] - mean)).abs() < 1e-14);
            assert!((ours - paper).abs() < 1e-14);
        }
    }

    #[test]
    fn b_bd_transpose_b_is_b_for_any_active_set() {
        let weights = [1e4, 1.0, 1e-4, 3.0];
        let b = incidence(&CROSS, 4);
        for mask in 1u32..64 {
            let active: Vec<bool> = (0..6).map(|r| mask >> r & 1 == 1).collect();
            let bd = block(&b, &weights, &active);
            for (r, &on) in active.iter().enumerate() {
                for j in 0..4 {
                    // (Z B B_Dᵀ Z B)(r, j)
                    let mut sum = 0.0;
                    for q in (0..6).filter(|&q| active[q]) {
                        let x: f64 = (0..4).map(|i| b.get(r, i) * bd.get(q, i)).sum();
                        sum += x * b.get(q, j);
                    }
                    if on {
                        assert!((sum - b.get(r, j)).abs() < 1e-13, "mask {mask}");
                    } else {
                        assert_eq!(bd.get(r, j), 0.0);
                    }
                }
            }
        }
    }

    #[test]
    fn redundant_pairs_and_the_general_block_agree() {
        let weights = [5.0, 0.25, 1.0];
        let pairs = [(0, 1), (0, 2), (1, 2)];
        let bd = block(&incidence(&pairs, 3), &weights, &[true; 3]);
        for (r, &pair) in pairs.iter().enumerate() {
            for c in 0..3 {
                assert!((pair_entry(&weights, pair, c) - bd.get(r, c)).abs() < 1e-14);
            }
        }
    }
}
