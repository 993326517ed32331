//! A subdomain whose matrix is a factored matrix, multiplied and turned: K = φ R K₀ Rᵀ.
//!
//! ```text
//!     S = φ R S₀ Rᵀ     T = R T₀ Rᵀ / φ     Ψ = R Ψ₀ R_Πᵀ     Σ = φ R_Π Σ₀ R_Πᵀ     K_II⁻¹ = R K₀,II⁻¹ Rᵀ / φ
//! ```
//!
//! R has the same rotation or reflection at every node ([`Turn`]). R_Π has it at every vertex, and turns the values of
//! the averages of the one into those of the other. Subdomains with different coefficients and turned copies of a part
//! share one factorisation in this way. Every operator that depends on the stiffness is applied through this type. All
//! multiples have the same [`Gamma`], which `gamma` gives; turned copies have one of their own, because it has Ψ.
//!
//! Turned copies do not share the blocks Z_cᵀ S Z_c of the coarse-corrected preconditioner, nor operators with adaptive
//! constraints, which are made of the copy's own matrix.

use std::sync::Arc;

use super::basis::Basis;
use super::problem::{Gamma, LocalProblem};
use super::turn::Turn;
use super::which::Operator;
use base::linalg::dense::Dense;

/// One subdomain of this rank.
#[derive(Debug, Clone)]
pub struct ScaledSubdomain {
    problem: Arc<LocalProblem>,
    /// φ.
    pub factor: f64,
    turned: Option<Arc<Turned>>,
}

/// The data of a turned copy that is its own: the turn, the [`Gamma`] with the turned Ψ, and R_Π Σ₀ R_Πᵀ.
#[derive(Debug)]
struct Turned {
    turn: Turn,
    gamma: Gamma,
    sigma: Dense,
}

impl ScaledSubdomain {
    /// The subdomain with `factor` times the matrix of `problem`.
    pub fn new(problem: Arc<LocalProblem>, factor: f64) -> ScaledSubdomain {
        ScaledSubdomain {
            problem,
            factor,
            turned: None,
        }
    }

    /// The subdomain with `factor` times R K₀ Rᵀ, K₀ the matrix of `problem`, and the functionals `basis`. The
    /// interface of `problem` must have all components of its nodes side by side.
    pub fn turned(
        problem: Arc<LocalProblem>,
        factor: f64,
        turn: Turn,
        basis: Basis,
    ) -> ScaledSubdomain {
        let on_primal = turn.on_primal(&problem.gamma, &basis);
        let gamma = turn.of_gamma(&problem.gamma, basis, &on_primal);
        let mut sigma = problem.sigma.clone();
        on_primal.congruence(&mut sigma);
        sigma.symmetrise();
        ScaledSubdomain {
            problem,
            factor,
            turned: Some(Arc::new(Turned { turn, gamma, sigma })),
        }
    }

    /// Another subdomain with the same operators up to `factor`.
    pub fn with_factor(&self, factor: f64) -> ScaledSubdomain {
        ScaledSubdomain {
            factor,
            ..self.clone()
        }
    }

    /// The largest diagonal entry of K on Γ; of a turned copy, before it was turned.
    pub fn stiffest(&self) -> f64 {
        let largest = self.problem.stiff().iter().fold(0.0, |a: f64, k| a.max(*k));
        self.factor * largest
    }

    /// Γ and Ψ, which do not depend on φ.
    pub fn gamma(&self) -> &Gamma {
        self.turned
            .as_ref()
            .map_or(&self.problem.gamma, |t| &t.gamma)
    }

    /// The operators that it shares with others.
    pub fn kind(&self) -> &Arc<LocalProblem> {
        &self.problem
    }

    /// R; `None` for the identity.
    pub fn turn(&self) -> Option<&Turn> {
        self.turned.as_ref().map(|t| &t.turn)
    }

    /// A number that two subdomains have in common if their operators are the same up to the factor: Ψ, and S and T.
    pub fn name(&self) -> u64 {
        std::ptr::from_ref(self.gamma()) as u64
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

    /// v ← Rᵀ v: from this subdomain to the one that was factored.
    pub fn turn_back(&self, v: &mut [f64]) {
        if let Some(turn) = self.turn() {
            turn.back(v);
        }
    }

    /// y ← R y.
    pub fn turn_forth(&self, y: &mut [f64]) {
        if let Some(turn) = self.turn() {
            turn.forth(y);
        }
    }

    /// y ← R A₀ Rᵀ v, where `apply(v, y)` is y ← A₀ v.
    pub fn around(&self, v: &[f64], y: &mut [f64], apply: impl FnOnce(&[f64], &mut [f64])) {
        match self.turn() {
            None => apply(v, y),
            Some(turn) => {
                let mut v = v.to_vec();
                turn.back(&mut v);
                apply(&v, y);
                turn.forth(y);
            }
        }
    }

    /// y ← A v, A one of the operators. Only the leading entries of v are read; later entries of y are set to zero.
    pub fn apply_one(&self, which: Operator, v: &[f64], y: &mut [f64]) {
        self.around(v, y, |v, y| self.problem.apply_one(which, v, y));
        scale(self.multiple(which), y);
    }

    /// y ← A v for all columns.
    pub fn apply(&self, which: Operator, v: &Dense, y: &mut Dense) {
        // Columns that live near one body are zero on all others, and there are many bodies.
        let on: Vec<usize> = (0..v.cols).filter(|&c| !v.is_zero(c)).collect();
        if on.len() == v.cols {
            return self.apply_all(which, v, y);
        }
        y.data.fill(0.0);
        let mut some = Dense::zeros(v.rows, on.len());
        for (k, &c) in on.iter().enumerate() {
            some.col_mut(k).copy_from_slice(v.col(c));
        }
        let mut images = Dense::zeros(y.rows, on.len());
        if !on.is_empty() {
            self.apply_all(which, &some, &mut images);
        }
        for (k, &c) in on.iter().enumerate() {
            y.col_mut(c).copy_from_slice(images.col(k));
        }
    }

    fn apply_all(&self, which: Operator, v: &Dense, y: &mut Dense) {
        match self.turn() {
            None => self.problem.apply(which, v, y, v.cols),
            Some(turn) => {
                let mut v = v.clone();
                turn.back(&mut v.data);
                self.problem.apply(which, &v, y, v.cols);
                turn.forth(&mut y.data);
            }
        }
        scale(self.multiple(which), &mut y.data);
    }

    /// Σ, n_Π × n_Π.
    pub fn sigma(&self) -> Dense {
        let turned = self.turned.as_ref();
        let mut out = turned.map_or(&self.problem.sigma, |t| &t.sigma).clone();
        scale(self.factor, &mut out.data);
        out
    }

    /// S with rows and columns in the given order of the positions of Γ.
    pub fn s_in_order(&self, order: &[u32]) -> Dense {
        let mut s = self.problem.s();
        if let Some(turn) = self.turn() {
            let s = Arc::make_mut(&mut s);
            turn.congruence(s);
            s.symmetrise();
        }
        let factor = self.multiple(Operator::S);
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

    /// A stiffness of each primal dof that is positive even where Σ vanishes: the energy of moving its dofs alone. In a
    /// turned copy it is that of the same dof before the turn, which has the same size.
    pub fn primal_stiffness(&self) -> Vec<f64> {
        let mut out = self.problem.primal_stiffness();
        scale(self.factor, &mut out);
        out
    }

    /// The largest diagonal entry of S before the turn, or of K on Γ where S is not available.
    pub fn stiffness(&self) -> f64 {
        self.factor * self.problem.stiffness()
    }

    /// Condenses loads of subdomains that share their operators, as [`LocalProblem::condense_many`] does: the part for
    /// [`recover_many`](Self::recover_many), and g on Γ.
    pub fn condense_many(
        members: &[&ScaledSubdomain],
        loads: &[&[f64]],
    ) -> Vec<(Vec<f64>, Vec<f64>)> {
        let Some(first) = members.first() else {
            return Vec::new();
        };
        if members.iter().all(|m| m.turned.is_none()) {
            return first.problem.condense_many(loads);
        }
        let back = |(member, load): (&&ScaledSubdomain, &&[f64])| {
            let mut load = load.to_vec();
            member.turn_back(&mut load);
            load
        };
        let loads: Vec<Vec<f64>> = members.iter().zip(loads).map(back).collect();
        let loads: Vec<&[f64]> = loads.iter().map(|f| &f[..]).collect();
        let mut out = first.problem.condense_many(&loads);
        for (member, (_, g)) in members.iter().zip(&mut out) {
            member.turn_forth(g);
        }
        out
    }

    /// Solutions of subdomains that share their operators, at most [`LANES`](cholesky::lanes::LANES). Each part
    /// has the result of [`condense_many`](Self::condense_many) and the values on Γ.
    pub fn recover_many(members: &[&ScaledSubdomain], parts: &[(&[f64], &[f64])]) -> Vec<Vec<f64>> {
        let Some(first) = members.first() else {
            return Vec::new();
        };
        let scales: Vec<f64> = members.iter().map(|m| m.factor).collect();
        if members.iter().all(|m| m.turned.is_none()) {
            return first.problem.recover_many(parts, &scales);
        }
        let back = |(member, part): (&&ScaledSubdomain, &(&[f64], &[f64]))| {
            let mut on_gamma = part.1.to_vec();
            member.turn_back(&mut on_gamma);
            on_gamma
        };
        let on_gamma: Vec<Vec<f64>> = members.iter().zip(parts).map(back).collect();
        let parts = parts.iter().zip(&on_gamma).map(|(p, u)| (p.0, &u[..]));
        let parts: Vec<(&[f64], &[f64])> = parts.collect();
        let mut out = first.problem.recover_many(&parts, &scales);
        for (member, u) in members.iter().zip(&mut out) {
            member.turn_forth(u);
        }
        out
    }

    fn block(&self, which: Operator, at: &[usize]) -> Dense {
        let factor = self.multiple(which);
        let mut out = match self.turned {
            None => self.problem.block(which, at),
            Some(_) => Dense::from_fn(at.len(), at.len(), |p, q| self.entry(which, at[p], at[q])),
        };
        scale(factor, &mut out.data);
        if self.turned.is_some() {
            out.symmetrise();
        }
        out
    }

    /// An entry of R A₀ Rᵀ.
    fn entry(&self, which: Operator, i: usize, j: usize) -> f64 {
        let Some(turn) = self.turn() else {
            return self.problem.entry(which, i, j);
        };
        let c = turn.components();
        let (row, col) = (i - i % c, j - j % c);
        let mut sum = 0.0;
        for a in 0..c {
            for b in 0..c {
                let along = turn.entry(i % c, a) * turn.entry(j % c, b);
                sum += along * self.problem.entry(which, row + a, col + b);
            }
        }
        sum
    }
}

fn scale(by: f64, values: &mut [f64]) {
    if by != 1.0 {
        values.iter_mut().for_each(|v| *v *= by);
    }
}
