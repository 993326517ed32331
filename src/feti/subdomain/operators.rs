//! Application of S and T, as dense matrices or as sparse solves.

use std::sync::{Arc, OnceLock};

use super::problem::{Inside, LocalProblem, Packed};
use super::which::Operator;
use base::linalg::dense::{multiply, Dense};
use base::linalg::symmetric::Symmetric;
use cholesky::lanes::LANES;

impl LocalProblem {
    /// Whether S and T are sparse solves.
    pub fn is_implicit(&self) -> bool {
        matches!(self.inside, Inside::Implicit(_))
    }

    /// S as a dense matrix. From sparse solves it is built column by column once, for checks and other rare uses. From
    /// its lower triangle it is built at every call.
    pub fn s(&self) -> Arc<Dense> {
        match &self.packed {
            Some(packed) => Arc::new(packed.s.to_dense()),
            None => self.whole_s().clone(),
        }
    }

    fn whole_s(&self) -> &Arc<Dense> {
        self.s.get_or_init(|| Arc::new(self.assembled(Operator::S)))
    }

    pub(super) fn whole_t(&self) -> &Dense {
        self.t.get_or_init(|| self.assembled(Operator::T))
    }

    /// Keeps only the lower triangles of S and T. This is for subdomains with few copies, whose products wait for
    /// memory. With many copies each matrix is read once for all of them, and matrix-matrix products with the whole
    /// matrix are faster.
    pub fn pack(&mut self) {
        if !self.is_implicit() && self.packed.is_none() {
            let s = Arc::new(Symmetric::new(self.whole_s()));
            self.pack_beside(s);
        }
    }

    /// [`pack`](Self::pack) with a lower triangle of S that exists already.
    pub(crate) fn pack_beside(&mut self, s: Arc<Symmetric>) {
        let t = Symmetric::new(self.whole_t());
        self.packed = Some(Packed { s, t });
        (self.s, self.t) = (OnceLock::new(), OnceLock::new());
    }

    /// An entry of one of the operators.
    pub fn entry(&self, which: Operator, i: usize, j: usize) -> f64 {
        match (&self.packed, which) {
            (Some(packed), _) => packed.of(which).get(i, j),
            (None, Operator::S) => self.whole_s().get(i, j),
            (None, Operator::T) => self.whole_t().get(i, j),
        }
    }

    /// A diagonal entry of S. Where S is not available, it is that of K on Γ, an upper bound.
    pub(crate) fn s_diagonal(&self, i: usize) -> f64 {
        match (&self.packed, self.s.get()) {
            (Some(packed), _) => packed.s.get(i, i),
            (None, Some(s)) => s.get(i, i),
            (None, None) => self.stiff[i],
        }
    }

    pub(crate) fn set_condensed(&mut self, t: Dense, psi: Dense, sigma: Dense) {
        (self.t, self.gamma.psi, self.sigma) = (OnceLock::from(t), psi, sigma);
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

    fn assembled(&self, which: Operator) -> Dense {
        let n = self.order(which);
        let mut unit = Dense::zeros(n, n);
        (0..n).for_each(|i| unit.set(i, i, 1.0));
        let mut out = Dense::zeros(n, n);
        self.apply(which, &unit, &mut out, n);
        // Both triangles are filled: callers may read either one.
        out.mirror_lower();
        out
    }

    /// The first `n` columns of y ← A v, where A is one of the operators and v and y have its order. A dense matrix
    /// takes one matrix-matrix product; sparse factors are swept with several right-hand sides at once.
    pub fn apply(&self, which: Operator, v: &Dense, y: &mut Dense, n: usize) {
        if n == 0 {
            return;
        }
        match &self.inside {
            Inside::Partial(_) => match &self.packed {
                Some(packed) => packed.of(which).mul_columns(v, y, n),
                None => {
                    let y = y.view_mut().subcols_mut(0, n);
                    let v = v.view().subcols(0, n);
                    multiply(y, false, 1.0, self.dense(which).view(), v);
                }
            },
            Inside::Implicit(implicit) => {
                for first in (0..n).step_by(LANES) {
                    let last = n.min(first + LANES);
                    let lanes: Vec<&[f64]> = (first..last).map(|c| v.col(c)).collect();
                    let done = implicit.apply(which, &lanes);
                    for (c, done) in (first..last).zip(&done) {
                        y.col_mut(c).copy_from_slice(done);
                    }
                }
            }
        }
    }

    /// y ← A v, A one of the operators. Only the leading entries of v are read; later entries of y are set to zero.
    pub fn apply_one(&self, which: Operator, v: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        let n = self.order(which);
        match &self.inside {
            Inside::Partial(_) => match &self.packed {
                Some(packed) => packed.of(which).add_mul(&v[..n], &mut y[..n]),
                None => self.dense(which).add_mul(&v[..n], &mut y[..n]),
            },
            Inside::Implicit(implicit) => {
                if v[..n].iter().any(|v| *v != 0.0) {
                    y[..n].copy_from_slice(&implicit.apply(which, &[&v[..n]])[0]);
                }
            }
        }
    }

    fn dense(&self, which: Operator) -> &Dense {
        match which {
            Operator::S => self.whole_s(),
            Operator::T => self.whole_t(),
        }
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

impl Packed {
    fn of(&self, which: Operator) -> &Symmetric {
        match which {
            Operator::S => &self.s,
            Operator::T => &self.t,
        }
    }
}
