//! Floating bodies, found from their matrices.
//!
//! A body floats in the directions that every one of its subdomain matrices maps to zero. Where candidates N for these
//! directions are known (constants; rigid body modes), the test is row by row: |K N c| is compared with the size of the
//! terms that should cancel in that row. This test sees a boundary condition or a spring in the softest corner of a
//! body with coefficient jumps of any size. Eigenvalues of the whole matrix would hide it. Without candidates, the
//! kernel of the body's primal matrix S_Π decides.
//!
//! Matrices have no rows for given values, so N is known at free dofs only. Where every node has one component given,
//! the translation along it has N c = 0. That is no motion, although K N c = 0: such c are taken out first.

use std::sync::Arc;

use base::linalg::csr::Csr;
use base::linalg::dense::Dense;
use cholesky::multifrontal::PartialCholesky;
use cholesky::symbolic::Symbolic;
use parallel::parcels::Parcels;

use crate::substructures::Subdomain;

/// A row belongs to a free body if its terms cancel to less than this, relative to their size. Rounding leaves 1e-15, a
/// spring of 1e-8 of a row's stiffness leaves 1e-8.
const FREE: f64 = 1e-11;

/// A combination c with |N c| below this fraction of the largest moves no free dof. Entries of N are of order one;
/// coordinates leave rounding of 1e-16 times the distance of the body from the origin, relative to the body. What is
/// above is a motion, and its rows of K N are compared with [`FREE`].
const MOVES: f64 = 1e-10;

/// Eigenvalues of the scaled S_Π below this count as zero. S_Π carries the rounding of the local elimination, about
/// 1e-14 times the subdomain's condition number.
const FREE_SPECTRUM: f64 = 1e-10;

/// Eigenvalues of a larger S_Π are looked for only where its pivots leave room for a kernel.
pub const LARGE: usize = 300;

/// Pivots of S_Π that stay above this part of their diagonal entries leave no kernel. Rounding leaves 1e-14.
const HELD: f64 = 1e-8;

/// Whether a Cholesky factorisation shows that S_Π has no kernel.
pub fn is_held(s_pi: &Csr) -> bool {
    let symbolic = Arc::new(Symbolic::new(s_pi, &[], None));
    let factor = PartialCholesky::new(s_pi, symbolic);
    factor.is_ok_and(|(factor, _)| factor.weakest_pivot() > HELD)
}

/// The [`motion_factors`] of subdomains as ranks send them, with the body of each.
pub type SentFactors = Parcels<usize, f64>;

/// Adds the motion factors of a subdomain; without candidates for the kernel there are none.
pub fn push_factors(to: &mut SentFactors, sub: &Subdomain) {
    let columns = sub.near_kernel.as_deref().unwrap_or(&[]);
    to.push(sub.body, motion_factors(&sub.k, columns).data);
}

/// The motion factors of these entries.
pub fn received_factors(entries: &[f64]) -> Dense {
    let k = (entries.len() / 2).isqrt();
    Dense {
        rows: 2 * k,
        cols: k,
        data: entries.to_vec(),
    }
}

/// One subdomain's contribution to the kernel of its body: the triangular factor of the row-scaled K N and below it
/// that of N, 2k × k together.
///
/// `columns` has the k columns of N, entries of order one.
pub fn motion_factors(k: &Csr, columns: &[Vec<f64>]) -> Dense {
    let (n, m) = (k.n(), columns.len());
    let mut rows = faer::Mat::<f64>::zeros(n.max(m), m);
    let mut first = 0;
    for group in columns.chunks(SIDE) {
        // Numbers of candidates of a scalar field, of plane and of solid elasticity.
        match group.len() {
            1 => residuals::<1>(k, group, &mut rows, first),
            2..=3 => residuals::<3>(k, group, &mut rows, first),
            _ => residuals::<SIDE>(k, group, &mut rows, first),
        }
        first += group.len();
    }
    let motions = faer::Mat::from_fn(n.max(m), m, |i, j| {
        columns[j].get(i).copied().unwrap_or(0.0)
    });
    let mut out = Dense::zeros(2 * m, m);
    for (first, rows) in [(0, rows), (m, motions)] {
        if m == 1 {
            // The usual scalar case needs no Householder reflections.
            out.set(first, 0, rows.norm_l2());
            continue;
        }
        let r = rows.qr();
        let r = r.thin_R();
        for j in 0..m {
            for i in 0..=j {
                out.set(first + i, j, r[(i, j)]);
            }
        }
    }
    out
}

/// Number of columns that meet an entry of K at once.
const SIDE: usize = 6;

/// Rows of K N divided by the row sums of |K|, for at most `W` columns, into `rows` from column `first`.
fn residuals<const W: usize>(
    k: &Csr,
    columns: &[Vec<f64>],
    rows: &mut faer::Mat<f64>,
    first: usize,
) {
    // The rows of N, filled up with zeros to the same length.
    let entry = |i: usize, c: usize| columns.get(c).map_or(0.0, |x| x[i]);
    let by_row: Vec<[f64; W]> = (0..k.n())
        .map(|i| std::array::from_fn(|c| entry(i, c)))
        .collect();
    for i in 0..k.n() {
        let (col, val) = k.row(i);
        let (mut sums, mut size) = ([0.0; W], 0.0);
        for (&j, &v) in col.iter().zip(val) {
            let x = &by_row[j as usize];
            (0..W).for_each(|c| sums[c] += v * x[c]);
            size += v.abs();
        }
        if size > 0.0 {
            for (c, sum) in sums[..columns.len()].iter().enumerate() {
                rows[(i, first + c)] = sum / size;
            }
        }
    }
}

/// A basis of the combinations c (k × defect) with K N c = 0 in all subdomains of a body and N c ≠ 0 in some, from
/// their [`motion_factors`]. It is orthogonal, to those with N c = 0 as well.
pub fn null_combinations(factors: &[Dense]) -> Dense {
    let Some(k) = factors.first().map(|f| f.cols) else {
        return Dense::default();
    };
    // Singular values in decreasing order, and the right singular vectors. Left ones are not needed; there are as many
    // as rows.
    let decompose = |a: &faer::Mat<f64>| {
        let svd = a
            .thin_svd()
            .expect("an SVD of a small finite matrix converges");
        let values: Vec<f64> = svd.S().column_vector().iter().copied().collect();
        (values, svd.V().to_owned())
    };
    let stacked = |first: usize| {
        faer::Mat::from_fn(factors.len() * k, k, |i, j| {
            factors[i / k].get(first + i % k, j)
        })
    };
    let (sizes, v) = decompose(&stacked(k));
    let largest = sizes.first().copied().unwrap_or(0.0);
    let moving = sizes.iter().filter(|s| **s > MOVES * largest).count();
    // Where everything moves, as usual, V would only change the basis.
    let basis = if moving == k {
        faer::Mat::identity(k, k)
    } else {
        v.get(.., ..moving).to_owned()
    };
    if moving == 0 {
        return Dense::zeros(k, 0);
    }
    let residuals = stacked(0);
    let (sigma, v) = decompose(&(&residuals * &basis));
    let scale = ((factors.len() * k) as f64).sqrt();
    let rank = sigma.iter().filter(|s| **s > FREE * scale).count();
    // Candidates that are motions themselves are the better basis: rows of G have fewer entries
    // (`projector/blocks.rs`).
    let own = (0..k).filter(|&c| residuals.col(c).norm_l2() <= FREE * scale);
    let own: Vec<usize> = own.collect();
    let null = if moving == k && own.len() == k - rank {
        faer::Mat::from_fn(k, own.len(), |i, j| f64::from(u8::from(i == own[j])))
    } else {
        &basis * v.get(.., rank..)
    };
    let mut out = Dense::zeros(k, moving - rank);
    for j in 0..out.cols {
        for i in 0..k {
            out.set(i, j, null[(i, j)]);
        }
    }
    out
}

/// A diagonal entry of S_Π below this fraction of the body's stiffness is rounding: its dof is held by nothing else.
const NOTHING: f64 = 1e-12;

/// A basis of the kernel of the body's primal matrix (n × n, both triangles): n × defect. `stiffness` is the largest
/// diagonal entry of K in the body, or a number of that size.
pub fn null_space(s_pi: &Dense, stiffness: f64) -> Dense {
    let n = s_pi.rows;
    // A body with one primal dof that nothing holds has a 1 × 1 matrix of rounding. It is small only compared with K.
    let alone = if stiffness > 0.0 { stiffness } else { 1.0 };
    let safe = |i: usize| match s_pi.get(i, i) {
        d if d > NOTHING * stiffness => d.sqrt(),
        _ => alone.sqrt(),
    };
    let a = faer::Mat::from_fn(n, n, |i, j| s_pi.get(i, j) / (safe(i) * safe(j)));
    let eigen = a
        .self_adjoint_eigen(faer::Side::Lower)
        .expect("eigenvalues of a small symmetric finite matrix converge");
    let values = eigen.S().column_vector();
    let defect = (0..n).filter(|&i| values[i] < FREE_SPECTRUM).count();
    let mut out = Dense::zeros(n, defect);
    for c in 0..defect {
        let column: Vec<f64> = (0..n).map(|i| eigen.U()[(i, c)] / safe(i)).collect();
        let size = column.iter().fold(0.0, |a: f64, &b| a.max(b.abs()));
        for (i, v) in column.iter().enumerate() {
            out.set(i, c, v / size);
        }
    }
    out
}

/// The rows of `z` (n × defect) whose dofs are fixed to hold the body, as many as columns. The largest remaining row is
/// taken first (Gram–Schmidt on rows), which spreads the dofs.
pub fn fixing_rows(z: &Dense) -> Vec<usize> {
    let mut rest: Vec<Vec<f64>> = (0..z.rows)
        .map(|i| (0..z.cols).map(|j| z.get(i, j)).collect())
        .collect();
    let mut chosen = Vec::new();
    for _ in 0..z.cols {
        let size = |r: &Vec<f64>| r.iter().map(|v| v * v).sum::<f64>();
        let best = (0..rest.len())
            .filter(|i| !chosen.contains(i))
            .max_by(|&a, &b| size(&rest[a]).total_cmp(&size(&rest[b])).then(b.cmp(&a)));
        let Some(best) = best else { break };
        let pivot = rest[best].clone();
        let norm = size(&pivot);
        chosen.push(best);
        if norm > 0.0 {
            for row in &mut rest {
                let factor = row.iter().zip(&pivot).map(|(a, b)| a * b).sum::<f64>() / norm;
                row.iter_mut()
                    .zip(&pivot)
                    .for_each(|(a, b)| *a -= factor * b);
            }
        }
    }
    chosen
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/primal/kernel.rs"]
mod tests;
