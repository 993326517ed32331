//! A subdomain whose matrix is a multiple of a factored matrix: K = φ K₀.
//!
//! ```text
//!     S = φ S₀     T = T₀ / φ     Ψ = Ψ₀     Σ = φ Σ₀     K_II⁻¹ = K₀,II⁻¹ / φ
//! ```
//!
//! Subdomains with different coefficients share one factorisation in this way. Every operator that depends on the
//! stiffness is applied through this type. All multiples have the same [`Gamma`], which `gamma` gives.

use std::sync::Arc;

use super::problem::{Gamma, LocalProblem};
use super::which::Operator;
use crate::linalg::dense::Dense;

/// One subdomain of this rank.
#[derive(Debug, Clone)]
pub struct Scaled {
    problem: Arc<LocalProblem>,
    /// φ.
    pub factor: f64,
}

impl Scaled {
    /// The subdomain with `factor` times the matrix of `problem`.
    pub fn new(problem: Arc<LocalProblem>, factor: f64) -> Scaled {
        Scaled { problem, factor }
    }

    /// Γ and Ψ, which do not depend on φ.
    pub fn gamma(&self) -> &Gamma {
        &self.problem.gamma
    }

    /// The operators that it shares with others.
    pub fn kind(&self) -> &Arc<LocalProblem> {
        &self.problem
    }

    /// Whether both subdomains have the same matrix up to a factor.
    pub fn shares_with(&self, other: &Scaled) -> bool {
        Arc::ptr_eq(&self.problem, &other.problem)
    }

    /// Whether S and T are sparse solves.
    pub fn is_implicit(&self) -> bool {
        self.problem.is_implicit()
    }

    /// The factor by which this subdomain's operator differs from that of `problem`.
    pub fn multiple(&self, which: Operator) -> f64 {
        match which {
            Operator::S => self.factor,
            Operator::T => 1.0 / self.factor,
        }
    }

    /// y ← A v, A one of the operators. Only the leading entries of v are read; later entries of y are set to zero.
    pub fn apply_one(&self, which: Operator, v: &[f64], y: &mut [f64]) {
        self.problem.apply_one(which, v, y);
        scale(self.multiple(which), y);
    }

    /// y ← A v for all columns.
    pub fn apply(&self, which: Operator, v: &Dense, y: &mut Dense) {
        self.problem.apply(which, v, y, v.cols);
        scale(self.multiple(which), &mut y.data);
    }

    /// Σ, n_Π × n_Π.
    pub fn sigma(&self) -> Dense {
        let mut out = self.problem.sigma.clone();
        scale(self.factor, &mut out.data);
        out
    }

    /// S with rows and columns in the given order of the positions of Γ.
    pub fn s_in_order(&self, order: &[u32]) -> Dense {
        let (s, factor) = (self.problem.s(), self.multiple(Operator::S));
        let mut out = Dense::zeros(order.len(), order.len());
        for (q, &j) in order.iter().enumerate() {
            let column = s.col(j as usize);
            let target = out.col_mut(q).iter_mut().zip(order);
            target.for_each(|(t, &i)| *t = factor * column[i as usize]);
        }
        out
    }

    /// S on some positions of Γ.
    pub fn s_on(&self, at: &[usize]) -> Dense {
        self.block(Operator::S, at)
    }

    /// T on some positions of Δ.
    pub fn t_on(&self, at: &[usize]) -> Dense {
        self.block(Operator::T, at)
    }

    /// A stiffness of each primal dof that is positive even where Σ vanishes: the energy of moving its dofs alone.
    pub fn primal_stiffness(&self) -> Vec<f64> {
        let mut out = self.problem.primal_stiffness();
        scale(self.factor, &mut out);
        out
    }

    /// The largest diagonal entry of S, or of K on Γ where S is not available.
    pub fn stiffness(&self) -> f64 {
        self.factor * self.problem.stiffness()
    }

    /// Solutions of subdomains that share their operators, at most [`LANES`](crate::cholesky::lanes::LANES). Each part
    /// has the result of [`LocalProblem::condense`] and the values on Γ.
    pub fn recover_many(members: &[&Scaled], parts: &[(&[f64], &[f64])]) -> Vec<Vec<f64>> {
        let scales: Vec<f64> = members.iter().map(|m| m.factor).collect();
        match members {
            [] => Vec::new(),
            [first, ..] => first.problem.recover_many(parts, &scales),
        }
    }

    fn block(&self, which: Operator, at: &[usize]) -> Dense {
        let (n, factor) = (at.len(), self.multiple(which));
        let mut out = Dense::zeros(n, n);
        for (q, &j) in at.iter().enumerate() {
            for (p, &i) in at.iter().enumerate() {
                out.set(p, q, factor * self.problem.entry(which, i, j));
            }
        }
        out
    }
}

fn scale(by: f64, values: &mut [f64]) {
    if by != 1.0 {
        values.iter_mut().for_each(|v| *v *= by);
    }
}
