//! Nonnegative least squares by Lawson and Hanson (1974), for small feasibility problems.

use super::dense::Dense;

/// Gradients below this, relative to ‖b‖ and the column, are zero; and columns are dependent if a pivot is below this,
/// relative to the largest one.
const ROUNDING: f64 = 1e-12;

/// Minimises ‖A x − b‖₂ with x_j ≥ 0 where `free[j]` is false. Returns x and the residual b − A x. The residual is a
/// certificate in the sense of Farkas' lemma: it is orthogonal to the free columns, has no positive product with the
/// others, and is zero if and only if b is in the cone.
pub fn nnls(a: &Dense, b: &[f64], free: &[bool]) -> (Vec<f64>, Vec<f64>) {
    nnls_within(a, b, free, ROUNDING)
}

/// [`nnls`] for columns that are known to `noise`, relative to the largest one: what less than this tells apart is one
/// direction. The x of two directions that differ by δ is as large as ‖b‖/δ, and rounding of the residual as ε‖b‖/δ.
pub fn nnls_within(a: &Dense, b: &[f64], free: &[bool], noise: f64) -> (Vec<f64>, Vec<f64>) {
    let (m, n) = (a.rows, a.cols);
    let mut passive: Vec<usize> = (0..n).filter(|&j| free[j]).collect();
    let mut x = vec![0.0; n];
    let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let dot = |p: &[f64], q: &[f64]| p.iter().zip(q).map(|(p, q)| p * q).sum::<f64>();
    let residual = |x: &[f64]| {
        let mut r = b.to_vec();
        for (j, &xj) in x.iter().enumerate().filter(|(_, xj)| **xj != 0.0) {
            r.iter_mut().zip(a.col(j)).for_each(|(r, a)| *r -= a * xj);
        }
        r
    };
    let size = norm(b);
    if !passive.is_empty() {
        let z = least_squares(a, b, &passive, noise);
        passive.iter().zip(&z).for_each(|(&j, &z)| x[j] = z);
    }
    // Each round lowers the residual, hence no passive set comes back; the bound on the rounds guards against rounding.
    for _ in 0..3 * (m + n) + 10 {
        let r = residual(&x);
        let gain = |j: usize| dot(a.col(j), &r) / norm(a.col(j)).max(f64::MIN_POSITIVE);
        let open = (0..n).filter(|j| !passive.contains(j));
        let best = open.max_by(|&i, &j| gain(i).total_cmp(&gain(j)));
        let Some(j) = best.filter(|&j| gain(j) > noise * size) else {
            break;
        };
        passive.push(j);
        loop {
            let z = least_squares(a, b, &passive, noise);
            // The part of the way to z on which column j stays in the cone.
            let way = |&(&j, &z): &(&usize, &f64)| {
                if !free[j] && z <= 0.0 {
                    x[j] / (x[j] - z)
                } else {
                    f64::INFINITY
                }
            };
            let ways: Vec<f64> = passive.iter().zip(&z).map(|pair| way(&pair)).collect();
            let step = ways.iter().fold(f64::INFINITY, |a, b| a.min(*b));
            if step.is_infinite() {
                passive.iter().zip(&z).for_each(|(&j, &z)| x[j] = z);
                break;
            }
            for (&j, &z) in passive.iter().zip(&z) {
                x[j] += step * (z - x[j]);
            }
            // Whoever ends the way leaves, even where rounding keeps x above zero: each round of this loop has fewer
            // columns than the one before. (A way that is not a number is 0 / 0.)
            let ends = |way: f64| way.is_nan() || way <= step;
            let last: Vec<usize> = (passive.iter().zip(&ways))
                .filter(|(_, way)| ends(**way))
                .map(|(&j, _)| j)
                .collect();
            last.iter().for_each(|&j| x[j] = 0.0);
            passive.retain(|&j| free[j] || x[j] > 0.0);
            let left = (0..n).filter(|j| !passive.contains(j));
            left.for_each(|j| x[j] = 0.0);
            if passive.is_empty() {
                break;
            }
        }
    }
    let r = residual(&x);
    (x, r)
}

/// Minimises ‖A z − b‖ over the given columns; returns the shortest minimiser where they are dependent. A Π = Q [R₁; 0]
/// with pivoted columns, then R₁ᵀ = Q₂ R₂ and z = Π Q₂ R₂⁻ᵀ Q₁ᵀ b. This takes a tenth of the time of singular values.
fn least_squares(a: &Dense, b: &[f64], columns: &[usize], noise: f64) -> Vec<f64> {
    let part = faer::Mat::from_fn(a.rows, columns.len(), |i, k| a.get(i, columns[k]));
    let pivoted = part.col_piv_qr();
    let (q, r) = (pivoted.compute_thin_Q(), pivoted.thin_R());
    let diagonal = 0..r.nrows().min(r.ncols());
    let largest = if diagonal.is_empty() {
        0.0
    } else {
        r[(0, 0)].abs()
    };
    let rank = diagonal.take_while(|&i| r[(i, i)].abs() > noise * largest);
    let rank = rank.count();
    let across = faer::Mat::from_fn(
        columns.len(),
        rank,
        |i, k| if k <= i { r[(k, i)] } else { 0.0 },
    );
    let second = across.qr();
    let (q2, r2) = (second.compute_thin_Q(), second.thin_R());
    let mut c: Vec<f64> = Vec::with_capacity(rank);
    for k in 0..rank {
        let own: f64 = (0..a.rows).map(|i| q[(i, k)] * b[i]).sum();
        let known: f64 = (0..k).map(|l| r2[(l, k)] * c[l]).sum();
        c.push((own - known) / r2[(k, k)]);
    }
    let (order, _) = pivoted.P().arrays();
    let mut z = vec![0.0; columns.len()];
    for (k, &column) in order.iter().enumerate() {
        z[column] = (0..rank).map(|l| q2[(k, l)] * c[l]).sum();
    }
    z
}

#[cfg(test)]
#[path = "../../tests/linalg/nnls.rs"]
mod tests;
