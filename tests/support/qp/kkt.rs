//! The symmetric quasi-definite systems of both stages, by a sparse LDLᵀ factorisation.

use super::{Qp, Row};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::sparse::linalg::cholesky::{
    factorize_symbolic_cholesky, LdltRef, SymbolicCholesky, SymmetricOrdering,
};
use faer::sparse::{SparseColMat, Triplet};
use faer::{Conj, Mat, Par, Side};

/// [K Bᵀ; B −diag(t)], and its factorisation with +ε and −ε on the diagonal.
///
/// The added ε makes semidefinite K and dependent rows harmless. Iterative refinement removes its effect from the
/// solution wherever the system itself determines the solution, and leaves the other components unchanged.
pub struct System<'a> {
    qp: &'a Qp,
    rows: Vec<&'a Row>,
    t: Vec<f64>,
    epsilon: f64,
    /// Lower triangle, and the positions of the rows' diagonal entries in its values.
    matrix: SparseColMat<usize, f64>,
    diagonal: Vec<usize>,
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
    /// Signs of the pivots: a pivot with a wrong sign from rounding is corrected, at the cost of more refinement.
    signs: Vec<i8>,
}

impl<'a> System<'a> {
    /// The pattern; nothing is factorised yet.
    pub fn new(qp: &'a Qp, rows: Vec<&'a Row>, epsilon: f64) -> System<'a> {
        let n = qp.f.len();
        let mut triplets = Vec::new();
        for i in 0..n {
            triplets.push(Triplet::new(i, i, epsilon));
            let (col, val) = qp.k.row(i);
            for (&j, &v) in col.iter().zip(val).filter(|&(&j, _)| j as usize <= i) {
                triplets.push(Triplet::new(i, j as usize, v));
            }
        }
        for (r, row) in rows.iter().enumerate() {
            for &(i, b) in &row.terms {
                triplets.push(Triplet::new(n + r, i, b));
            }
            triplets.push(Triplet::new(n + r, n + r, -epsilon));
        }
        let size = n + rows.len();
        let matrix = SparseColMat::try_new_from_triplets(size, size, &triplets).unwrap();
        // Columns of multipliers contain only their diagonal entry.
        let diagonal = (n..size).map(|j| matrix.symbolic().col_ptr()[j]).collect();
        let symbolic = factorize_symbolic_cholesky(
            matrix.symbolic(),
            Side::Lower,
            SymmetricOrdering::Amd,
            Default::default(),
        )
        .expect("memory");
        let values = vec![0.0; symbolic.len_val()];
        System {
            qp,
            t: vec![0.0; rows.len()],
            rows,
            epsilon,
            matrix,
            diagonal,
            symbolic,
            values,
            signs: (0..size).map(|i| if i < n { 1 } else { -1 }).collect(),
        }
    }

    /// Factorises with the diagonal `t` ≥ 0; false where rounding leaves a pivot of zero.
    #[must_use]
    pub fn factor(&mut self, t: &[f64]) -> bool {
        self.t.copy_from_slice(t);
        for (&at, t) in self.diagonal.iter().zip(t) {
            self.matrix.val_mut()[at] = -(t + self.epsilon);
        }
        let scratch = self
            .symbolic
            .factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Default::default());
        self.symbolic
            .factorize_numeric_ldlt(
                &mut self.values,
                self.matrix.as_ref(),
                Side::Lower,
                LdltRegularization {
                    dynamic_regularization_signs: Some(&self.signs),
                    dynamic_regularization_delta: self.epsilon,
                    dynamic_regularization_epsilon: 1e-2 * self.epsilon,
                },
                Par::Seq,
                MemStack::new(&mut MemBuffer::new(scratch)),
                Default::default(),
            )
            .is_ok()
    }

    /// b − A x in twice the working precision, and its size: forces relative to the multipliers, rows relative to u.
    fn residual(&self, b: &[f64], x: &[f64]) -> (Vec<f64>, f64) {
        let n = self.qp.f.len();
        let mut r: Vec<Sum> = b.iter().map(|&b| Sum(b, 0.0)).collect();
        for (i, r) in r.iter_mut().enumerate().take(n) {
            let (col, val) = self.qp.k.row(i);
            for (&j, &v) in col.iter().zip(val) {
                r.add(-v, x[j as usize]);
            }
        }
        for (k, row) in self.rows.iter().enumerate() {
            for &(i, v) in &row.terms {
                r[i].add(-v, x[n + k]);
                r[n + k].add(-v, x[i]);
            }
            r[n + k].add(self.t[k], x[n + k]);
        }
        let r: Vec<f64> = r.into_iter().map(|Sum(high, low)| high + low).collect();
        let largest = |v: &[f64], least| v.iter().fold(least, |m: f64, v| m.max(v.abs()));
        let forces = largest(&r[..n], 0.0) / largest(&x[n..], 1.0);
        let rows = largest(&r[n..], 0.0) / largest(&x[..n], 1.0);
        (r, forces.max(rows))
    }

    fn solve_in_place(&self, x: &mut Mat<f64>) {
        let factor = LdltRef::new(&self.symbolic, &self.values);
        let scratch = factor.solve_in_place_scratch::<f64>(1, Par::Seq);
        factor.solve_in_place_with_conj(
            Conj::No,
            x.as_mut(),
            Par::Seq,
            MemStack::new(&mut MemBuffer::new(scratch)),
        );
    }

    /// Improves x as a solution of A x = b until there is no more progress; returns the size of the residual.
    pub fn refine(&self, b: &[f64], x: &mut [f64], most: usize) -> f64 {
        let (mut r, mut size) = self.residual(b, x);
        for _ in 0..most {
            if size == 0.0 {
                break;
            }
            let mut step = Mat::from_fn(b.len(), 1, |i, _| r[i]);
            self.solve_in_place(&mut step);
            let next: Vec<f64> = x
                .iter()
                .enumerate()
                .map(|(i, x)| x + step[(i, 0)])
                .collect();
            let (r_next, size_next) = self.residual(b, &next);
            if size_next.is_nan() || size_next >= size {
                break;
            }
            let slow = size_next > 0.9 * size;
            x.copy_from_slice(&next);
            (r, size) = (r_next, size_next);
            if slow {
                break;
            }
        }
        size
    }
}

/// A sum, and the rounding error lost from it.
#[derive(Clone, Copy)]
struct Sum(f64, f64);

impl Sum {
    /// Adds a·b.
    fn add(&mut self, a: f64, b: f64) {
        let product = a * b;
        let rest = a.mul_add(b, -product);
        let sum = self.0 + product;
        let part = sum - self.0;
        self.1 += (self.0 - (sum - part)) + (product - part) + rest;
        self.0 = sum;
    }
}
