//! Application of S and T.

use std::sync::Arc;

use super::problem::LocalProblem;
use super::which::Operator;
use base::linalg::dense::Dense;

impl LocalProblem {
    /// Whether S and T are sparse solves.
    pub fn is_implicit(&self) -> bool {
        self.operators.is_sparse()
    }

    /// S as a dense matrix. From sparse solves it is built column by column once, for checks and other rare uses. From
    /// its lower triangle it is built at every call.
    pub fn s(&self) -> Arc<Dense> {
        self.operators.s()
    }

    /// Keeps only the lower triangles of S and T. This is for subdomains with few copies, whose products wait for
    /// memory. With many copies each matrix is read once for all of them, and matrix-matrix products with the whole
    /// matrix are faster.
    pub fn pack(&mut self) {
        self.operators.pack();
    }

    /// An entry of one of the operators.
    pub fn entry(&self, which: Operator, i: usize, j: usize) -> f64 {
        self.operators.entry(which, i, j)
    }

    /// The entries of one of the operators in these rows and columns. Sparse solves make these columns alone.
    pub fn block(&self, which: Operator, at: &[usize]) -> Dense {
        self.operators.block(which, at)
    }

    /// A diagonal entry of S. Where S is not available, it is that of K on Γ, an upper bound.
    pub(crate) fn s_diagonal(&self, i: usize) -> f64 {
        self.operators.s_diagonal(i).unwrap_or(self.stiff[i])
    }

    /// The diagonal of K on Γ.
    pub(crate) fn stiff(&self) -> &[f64] {
        &self.stiff
    }

    /// The order of an operator.
    pub fn order(&self, which: Operator) -> usize {
        match which {
            Operator::S => self.gamma.n_gamma(),
            Operator::T => self.gamma.n_delta,
        }
    }

    /// The first `n` columns of y ← A v, where A is one of the operators and v and y have its order. A dense matrix
    /// takes one matrix-matrix product; sparse factors are swept with several right-hand sides at once.
    pub fn apply(&self, which: Operator, v: &Dense, y: &mut Dense, n: usize) {
        if n > 0 {
            self.operators.apply(which, v, y, n);
        }
    }

    /// y ← A v, A one of the operators. Only the leading entries of v are read; later entries of y are set to zero.
    pub fn apply_one(&self, which: Operator, v: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        let n = self.order(which);
        self.operators.apply_one(which, &v[..n], &mut y[..n]);
    }

    /// A lower bound of the condition number of S on Δ: max T_ii max S_ii.
    pub fn condition(&self) -> f64 {
        let largest = |which| {
            let diagonal = (0..self.gamma.n_delta).map(|i| self.entry(which, i, i));
            diagonal.fold(0.0, f64::max)
        };
        largest(Operator::T) * largest(Operator::S)
    }

    /// The largest diagonal entry of S, or of K on Γ where S is not available.
    pub(crate) fn stiffness(&self) -> f64 {
        let diagonal = (0..self.gamma.n_gamma()).map(|i| self.s_diagonal(i));
        diagonal.fold(0.0, f64::max)
    }
}
