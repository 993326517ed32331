//! B_D = G⁻¹ B D⁻¹ with a sparse factor of G = B D⁻¹ Bᵀ over a set of independent rows.

use std::sync::Arc;

use super::pattern::{product, product_pattern, JumpMatrices};
use base::linalg::csr::Csr;
use cholesky::multifrontal::PartialCholesky;
use cholesky::symbolic::Symbolic;

/// G and its factor.
#[derive(Debug)]
pub struct ByRows {
    /// D⁻¹.
    inverse: Vec<f64>,
    /// G. Rows outside the set have a unit diagonal and nothing beside it.
    gram: Csr,
    symbolic: Arc<Symbolic>,
    factor: Option<PartialCholesky>,
    /// Whether each row is in the set.
    kept: Vec<bool>,
}

impl ByRows {
    /// Orders the rows.
    pub fn new(b: &JumpMatrices, weights: &[f64]) -> ByRows {
        let gram = product_pattern(&b.rows, &b.columns);
        ByRows {
            inverse: weights.iter().map(|w| 1.0 / w).collect(),
            symbolic: Arc::new(Symbolic::new(&gram, &[], None)),
            factor: None,
            kept: vec![false; b.rows.n()],
            gram,
        }
    }

    /// Factors G over these rows, without those that have a pivot of rounding.
    pub fn hold(&mut self, b: &JumpMatrices, on: &[bool]) {
        let Self { gram, inverse, .. } = self;
        product(gram, &b.rows, &b.columns, inverse, on);
        let (factor, left) =
            PartialCholesky::semidefinite(gram, self.symbolic.clone(), f64::EPSILON);
        self.kept.copy_from_slice(on);
        left.iter().for_each(|&r| self.kept[r as usize] = false);
        self.factor = Some(factor);
    }

    /// λ ← G⁻¹ λ, zero outside the set.
    fn solve(&self, lambda: &mut [f64]) {
        if let Some(factor) = &self.factor {
            factor.solve(lambda);
        }
        let rows = lambda.iter_mut().zip(&self.kept);
        rows.filter(|r| !r.1).for_each(|(l, _)| *l = 0.0);
    }

    /// v ← B_Dᵀ λ = D⁻¹ Bᵀ G⁻¹ λ.
    pub fn lift(&self, b: &JumpMatrices, lambda: &[f64], v: &mut [f64]) {
        let mut x = lambda.to_vec();
        self.solve(&mut x);
        v.fill(0.0);
        b.rows.add_mul_transpose(1.0, &x, v);
        v.iter_mut().zip(&self.inverse).for_each(|(v, d)| *v *= d);
    }

    /// λ ← B_D y = G⁻¹ B D⁻¹ y.
    pub fn collect(&self, b: &JumpMatrices, y: &[f64], lambda: &mut [f64]) {
        let y: Vec<f64> = y.iter().zip(&self.inverse).map(|(y, d)| y * d).collect();
        lambda.fill(0.0);
        b.rows.add_mul(1.0, &y, lambda);
        self.solve(lambda);
    }
}
