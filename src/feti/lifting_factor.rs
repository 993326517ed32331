//! A⁺ = (Z_cᵀ S̃ Z_c)⁺ of one body: sparse where it has many columns that see few others, dense where there are few or where they depend on each other.

use std::ops::Range;
use std::sync::Arc;

use super::local::dense::Dense;
use super::local::multifrontal::PartialCholesky;
use super::local::semidefinite::{Semidefinite, DEPENDENT, ZERO};
use super::local::symbolic::Symbolic;
use crate::sparse::Csr;

/// With fewer columns a dense factor stays in the cache.
const MANY: usize = 200;

/// A is worth an ordering if no larger part of its entries is there.
const FILLED: f64 = 0.25;

/// A of one body.
pub(super) struct BodyFactor {
    /// Its columns among this rank's primal dofs.
    at: Vec<usize>,
    factor: Factor,
}

/// How A⁺ is held.
enum Factor {
    /// Columns far from each other have nothing in common.
    Sparse(PartialCholesky),
    /// The rank is found.
    Dense(Semidefinite),
}

impl BodyFactor {
    /// A of the body with these primal dofs, of which this rank's begin at `first`, from what [`Sum::pack`] has written.
    pub fn new(received: &[Vec<u64>], body: Range<u32>, first: usize) -> BodyFactor {
        let mut columns = Vec::new();
        each(received, &body, |c, _| columns.extend_from_slice(c));
        columns.sort_unstable();
        columns.dedup();
        let mut a = Dense::zeros(columns.len(), columns.len());
        each(received, &body, |theirs, mut values| {
            let place = |g: &u64| columns.binary_search(g).expect("it was collected");
            let at: Vec<usize> = theirs.iter().map(place).collect();
            for (q, &to) in at.iter().enumerate() {
                let (column, rest) = values.split_at(at.len() - q);
                values = rest;
                let target = a.col_mut(to);
                for (&i, &v) in at[q..].iter().zip(column) {
                    target[i] += f64::from_bits(v);
                }
            }
        });
        a.mirror_lower();
        BodyFactor {
            at: columns.iter().map(|&c| c as usize - first).collect(),
            factor: match sparse(&a) {
                Some(factor) => Factor::Sparse(factor),
                None => Factor::Dense(Semidefinite::new(&a)),
            },
        }
    }

    /// Rank of A and its order, columns that are zero left out.
    pub fn rank_and_order(&self) -> (usize, usize) {
        match &self.factor {
            Factor::Sparse(factor) => (factor.n(), factor.n()),
            Factor::Dense(factor) => (factor.rank(), factor.nonzero()),
        }
    }

    /// x ← A⁺ x at the columns; the body's other primal dofs stay as they are.
    pub fn solve(&self, x: &mut [f64]) {
        let mut part: Vec<f64> = self.at.iter().map(|&i| x[i]).collect();
        match &self.factor {
            Factor::Sparse(factor) => factor.solve(&mut part),
            Factor::Dense(factor) => factor.solve(&mut part),
        }
        self.at.iter().zip(&part).for_each(|(&i, v)| x[i] = *v);
    }
}

/// Columns and lower triangle of every sum of one body.
fn each<'a>(
    received: &'a [Vec<u64>],
    body: &Range<u32>,
    mut see: impl FnMut(&'a [u64], &'a [u64]),
) {
    for mut words in received.iter().map(|w| &w[..]) {
        while let [n, tail @ ..] = words {
            let n = *n as usize;
            let (columns, tail) = tail.split_at(n);
            let (values, tail) = tail.split_at(n * (n + 1) / 2);
            words = tail;
            // All columns are of one body.
            if n > 0 && body.contains(&(columns[0] as u32)) {
                see(columns, values);
            }
        }
    }
}

/// The sparse factor of a regular matrix with many zeros; both triangles are read.
fn sparse(a: &Dense) -> Option<PartialCholesky> {
    let n = a.rows;
    let entries = a.data.iter().filter(|v| **v != 0.0).count();
    let largest = (0..n).map(|i| a.get(i, i)).fold(0.0, f64::max);
    let regular = (0..n).all(|i| a.get(i, i) > ZERO * largest);
    if n < MANY || entries as f64 > FILLED * (n * n) as f64 || !regular {
        return None;
    }
    let mut k = Csr {
        row_ptr: vec![0],
        ..Csr::default()
    };
    for j in 0..n {
        let column = (0..).zip(a.col(j)).filter(|e: &(u32, &f64)| *e.1 != 0.0);
        for (i, &v) in column {
            k.col.push(i);
            k.val.push(v);
        }
        k.row_ptr.push(k.col.len());
    }
    let symbolic = Arc::new(Symbolic::new(&k, &[], None));
    let (factor, _) = PartialCholesky::new(&k, symbolic).ok()?;
    (factor.weakest_pivot(&k) > DEPENDENT).then_some(factor)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::feti::local::testing::{distance, grid_laplacian, random};

    fn dense(k: &Csr) -> Dense {
        let mut a = Dense::zeros(k.n(), k.n());
        for i in 0..k.n() {
            let (col, val) = k.row(i);
            col.iter()
                .zip(val)
                .for_each(|(&j, &v)| a.set(i, j as usize, v));
        }
        a
    }

    #[test]
    fn sparse_and_dense_factors_solve_alike_and_dependent_columns_are_left_to_the_dense_one() {
        let (k, _) = grid_laplacian(19, 17, 0.2);
        let a = dense(&k);
        let factor = sparse(&a).expect("regular, with many zeros");
        let mut x = random(k.n(), 4);
        let mut y = x.clone();
        factor.solve(&mut x);
        Semidefinite::new(&a).solve(&mut y);
        let far = distance(&x, &y);
        assert!(far < 1e-12, "{far:.1e}");

        // A free body; two columns that are one; a column that is zero; few columns.
        assert!(sparse(&dense(&grid_laplacian(19, 17, 0.0).0)).is_none());
        let mut twice = a.clone();
        for i in 0..k.n() {
            let v = twice.get(i, 0);
            twice.set(i, 5, v);
        }
        for i in 0..k.n() {
            let v = twice.get(0, i);
            twice.set(5, i, v);
        }
        assert!(sparse(&twice).is_none());
        let mut zero = a;
        for i in 0..k.n() {
            zero.set(i, 7, 0.0);
            zero.set(7, i, 0.0);
        }
        assert!(sparse(&zero).is_none());
        assert!(sparse(&dense(&grid_laplacian(9, 9, 0.2).0)).is_none());
    }
}
