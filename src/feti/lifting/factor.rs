//! A⁺ = (Z_cᵀ S̃ Z_c)⁺ of one body. The factor is sparse if the body has many columns and each meets few others; it is
//! dense if there are few columns or if they depend on each other.

use std::ops::Range;
use std::sync::Arc;

use crate::feti::primal::matrix::Blocks;
use base::linalg::csr::Csr;
use base::linalg::dense::Dense;
use base::linalg::semidefinite::{Semidefinite, DEPENDENT, ZERO};
use base::linalg::sorted::distinct;
use cholesky::multifrontal::PartialCholesky;
use cholesky::symbolic::Symbolic;

/// Number of columns below which a dense factor is used: it stays in the cache.
const MANY: usize = 200;

/// Largest fraction of nonzero entries of A at which a sparse factor is tried.
const FILLED: f64 = 0.25;

/// A of one body.
pub(crate) struct BodyFactor {
    /// Its columns among this rank's primal dofs.
    at: Vec<usize>,
    factor: LiftingFactor,
}

/// The form of A⁺.
enum LiftingFactor {
    /// A sparse factor: columns far from each other do not interact.
    Sparse(PartialCholesky),
    /// A dense factor that determines the rank.
    Dense(Semidefinite),
}

/// The contribution of a subdomain to A: columns, and the lower triangle of its block, column after column.
pub(crate) type LiftingBlock<'a> = (&'a [u32], &'a [f64]);

/// The shares of each owned body, in the order of the ranks: `owned` has its primal dofs, those of this rank begin at
/// `first`. `received` has the sums that ranks sent.
pub(crate) fn shares<'a>(
    received: &'a [Blocks],
    owned: &[Range<usize>],
    first: usize,
) -> Vec<Vec<LiftingBlock<'a>>> {
    let mut out = vec![Vec::new(); owned.len()];
    for (columns, values) in received.iter().flat_map(Blocks::iter) {
        // All columns are of one body.
        let at = columns[0] as usize - first;
        let body = owned.partition_point(|range| range.end <= at);
        out[body].push((columns, values));
    }
    out
}

impl BodyFactor {
    /// A of a body from its shares; the primal dofs of this rank begin at `first`.
    pub fn new(shares: &[LiftingBlock<'_>], first: usize) -> BodyFactor {
        let columns = shares.iter().flat_map(|s| s.0.iter().copied());
        let columns = distinct(columns);
        let place = |g: &u32| columns.binary_search(g).expect("it was collected") as u32;
        let lists = shares.iter().map(|s| s.0.iter().map(place).collect());
        let lists: Vec<Vec<u32>> = lists.collect();
        let blocks: Vec<&[f64]> = shares.iter().map(|s| s.1).collect();
        let n = columns.len();
        let factor = sparse(n, &lists, &blocks).map_or_else(
            || LiftingFactor::Dense(Semidefinite::new(&dense(n, &lists, &blocks))),
            LiftingFactor::Sparse,
        );
        BodyFactor {
            at: columns.iter().map(|&c| c as usize - first).collect(),
            factor,
        }
    }

    /// Rank of A, and its order without zero columns.
    pub fn rank_and_order(&self) -> (usize, usize) {
        match &self.factor {
            LiftingFactor::Sparse(factor) => (factor.n(), factor.n()),
            LiftingFactor::Dense(factor) => (factor.rank(), factor.nonzero()),
        }
    }

    /// x ← A⁺ x at the columns; the entries at the body's other primal dofs do not change.
    pub fn solve(&self, x: &mut [f64]) {
        let mut part: Vec<f64> = self.at.iter().map(|&i| x[i]).collect();
        match &self.factor {
            LiftingFactor::Sparse(factor) => factor.solve(&mut part),
            LiftingFactor::Dense(factor) => factor.solve(&mut part),
        }
        self.at.iter().zip(&part).for_each(|(&i, v)| x[i] = *v);
    }
}

/// The sum of lower triangles, both triangles filled.
fn dense(n: usize, lists: &[Vec<u32>], blocks: &[&[f64]]) -> Dense {
    let mut a = Dense::zeros(n, n);
    for (list, mut values) in lists.iter().zip(blocks.iter().copied()) {
        for (q, &to) in list.iter().enumerate() {
            let (column, rest) = values.split_at(list.len() - q);
            values = rest;
            let target = a.col_mut(to as usize);
            for (&i, &v) in list[q..].iter().zip(column) {
                target[i as usize] += v;
            }
        }
    }
    a.mirror_lower();
    a
}

/// The sparse factor of the same sum if it is regular and has many zeros; `None` otherwise.
fn sparse(n: usize, lists: &[Vec<u32>], blocks: &[&[f64]]) -> Option<PartialCholesky> {
    let full = |entries: usize| entries as f64 > FILLED * (n * n) as f64;
    if n < MANY || lists.iter().any(|l| full(l.len() * l.len())) {
        return None;
    }
    let entry = |b: usize, i: usize, j: usize| {
        // The lower triangle is packed column by column, each column from the diagonal down.
        let (low, high) = (i.min(j), i.max(j));
        let start = low * lists[b].len() - low * low.saturating_sub(1) / 2;
        blocks[b][start + high - low]
    };
    let a = Csr::from_blocks(n, lists, entry);
    let diagonal = a.diagonal();
    let largest = diagonal.iter().copied().fold(0.0, f64::max);
    if full(a.nnz()) || diagonal.iter().any(|d| *d <= ZERO * largest) {
        return None;
    }
    let symbolic = Arc::new(Symbolic::new(&a, &[], None));
    let (factor, _) = PartialCholesky::new(&a, symbolic).ok()?;
    (factor.weakest_pivot() > DEPENDENT).then_some(factor)
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/lifting/factor.rs"]
mod tests;
