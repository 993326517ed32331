//! The operators of one subdomain on its interface: S, T, Ψ and Σ (docs/theory.md, section 2).
//!
//! The interface Γ is ordered [Δ, vertices]. Without averages the vertices are the primal dofs Π, and the operators
//! follow from the Schur complement S on Γ:
//!
//! ```text
//!     T = S_ΔΔ⁻¹          local solve with the primal dofs held
//!     Ψ = [−T S_ΔΠ; I]    energy-minimal functions with value 1 at one primal dof, 0 at the others
//!     Σ = Ψᵀ S Ψ = S_ΠΠ − S_ΠΔ T S_ΔΠ
//! ```
//!
//! Averages and other functionals of dual dofs are made coordinates first ([`Basis`]); so are the fixing dofs that make
//! S_ΔΔ regular. The formulas hold in that basis, which only the computation of T and Ψ uses. All other code works with
//! nodal dofs.
//!
//! S and T are dense matrices or sparse solves, as the caller chooses ([`OperatorForm`]). This type belongs to one
//! matrix; subdomains with multiples of the matrix share it through
//! [`ScaledSubdomain`](super::scaled::ScaledSubdomain).

#[cfg(test)]
#[path = "../../../tests/inside/feti/subdomain/problem.rs"]
mod tests;

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::Arc;

use super::basis::Basis;
use super::condense::condense_dual;
use super::implicit::Implicit;
use super::schur::SchurOperators;
use super::turn::Turn;
use super::which::OperatorForm;
use crate::feti::interface::entities::Average;
use base::linalg::csr::Csr;
use base::linalg::dense::Dense;
use cholesky::interior::{Condenser, NoFactor};
use cholesky::symbolic::Keep;

/// Largest number of free motions that are searched in a subdomain that touches nothing: twice the rigid motions of a
/// solid. A matrix that still has a bad pivot after that is not semidefinite, and every further attempt would cost a
/// factorisation.
const MOST_FREE: usize = 12;

/// Factorisations in this process so far.
static FACTORISATIONS: AtomicUsize = AtomicUsize::new(0);

/// Factorisations among them that made the dense matrices S and T.
static CONDENSATIONS: AtomicUsize = AtomicUsize::new(0);

/// Number of subdomains that this process has factored so far. A contact loop must not increase it.
pub fn factorisations() -> usize {
    FACTORISATIONS.load(Ordering::Relaxed)
}

/// Number of subdomains among them of which this process has made S and T as dense matrices.
pub fn condensations() -> usize {
    CONDENSATIONS.load(Ordering::Relaxed)
}

/// Γ of one subdomain, and Ψ on it.
#[derive(Debug, Clone, Default)]
pub struct Gamma {
    /// Local dofs of the interface in the order [Δ, vertices]; length n_Γ.
    pub interface: Vec<u32>,
    /// Number of dual interface dofs. Those of averages and the fixing dofs are among them.
    pub n_delta: usize,
    /// Primal functionals of dual dofs: averages, and those that adaptivity added.
    pub basis: Basis,
    /// Positions in Γ of the fixing dofs: coordinates that were added to the primal dofs to make S_ΔΔ regular.
    pub fixing: Vec<usize>,
    /// Ψ on Δ, n_Δ × n_Π (on the vertices it is the identity in their columns and zero in the others). Empty where
    /// nobody shares the sparse factor that it follows from ([`ScaledSubdomain::psi`](super::scaled::ScaledSubdomain)).
    pub psi: Dense,
    /// R of a turned copy, and the functionals before the turn: fixing dofs are coordinates of Rᵀ u in their basis.
    pub turn: Option<(Turn, Basis)>,
}

/// One subdomain, factored. What all multiples of its matrix have in common is read from its [`Gamma`].
#[derive(Debug)]
pub struct LocalProblem {
    pub(crate) gamma: Gamma,
    /// Σ, n_Π × n_Π.
    pub(crate) sigma: Dense,
    /// S, T and what eliminates the interior.
    pub(crate) operators: SchurOperators,
    /// The diagonal of K on Γ.
    pub(crate) stiff: Vec<f64>,
}

impl Gamma {
    /// Number of interface dofs n_Γ.
    pub fn n_gamma(&self) -> usize {
        self.interface.len()
    }

    /// Number of vertices: the first primal dofs, each a single dof of Γ.
    pub fn n_vertices(&self) -> usize {
        self.interface.len() - self.n_delta
    }

    /// Number of primal dofs n_Π: vertices, functionals, fixing dofs.
    pub fn n_pi(&self) -> usize {
        self.n_vertices() + self.basis.len() + self.fixing.len()
    }

    /// The primal dofs of a function on Γ.
    pub fn primal_values(&self, u: &[f64]) -> Vec<f64> {
        let mut changed = u.to_vec();
        if !self.fixing.is_empty() {
            let basis = self.turn.as_ref().map_or(&self.basis, |(turn, basis)| {
                turn.back(&mut changed);
                basis
            });
            basis.to_coordinates(&mut changed);
        }
        let vertices = u[self.n_delta..].iter().copied();
        let fixing = self.fixing.iter().map(|&i| changed[i]);
        vertices.chain(self.basis.values(u)).chain(fixing).collect()
    }

    /// p ← Ψᵀ v, v on Γ.
    pub fn psi_transpose(&self, v: &[f64], p: &mut [f64]) {
        let (vertices, others) = p.split_at_mut(self.n_vertices());
        vertices.copy_from_slice(&v[self.n_delta..]);
        others.fill(0.0);
        self.psi.add_mul_transpose(&v[..self.n_delta], p);
    }

    /// y ← y + Ψ c.
    pub fn add_psi(&self, c: &[f64], y: &mut [f64]) {
        self.psi.add_mul(c, &mut y[..self.n_delta]);
        for (yi, ci) in y[self.n_delta..].iter_mut().zip(c) {
            *yi += ci;
        }
    }
}

impl LocalProblem {
    /// Factors subdomain matrix `k` with the given dual and primal interface dofs and primal averages. Analyses inside
    /// `condenser` must belong to the interface [delta, primal].
    ///
    /// # Errors
    /// A matrix that is no stiffness matrix, or an error of the solver.
    pub fn new(
        k: &Csr,
        delta: &[u32],
        primal: &[u32],
        averages: &[&Average],
        coordinates: Option<&[[f64; 3]]>,
        mut condenser: Condenser,
        form: OperatorForm,
    ) -> Result<LocalProblem, NoFactor> {
        let basis = basis(delta, averages);
        FACTORISATIONS.fetch_add(1, Ordering::Relaxed);
        if form == OperatorForm::Implicit {
            let interface = [delta, primal].concat();
            // The dense form handles an interior that nothing holds.
            let (n_delta, known) = (delta.len(), condenser.analysed);
            let made = Implicit::new(k, &interface, n_delta, &basis, coordinates, known);
            if let Ok(Some((implicit, sigma))) = made {
                return Ok(LocalProblem {
                    stiff: diagonal(k, &interface),
                    gamma: Gamma {
                        interface,
                        n_delta: delta.len(),
                        basis,
                        fixing: Vec::new(),
                        psi: Dense::default(),
                        turn: None,
                    },
                    sigma,
                    operators: SchurOperators::sparse(implicit),
                });
            }
        }
        CONDENSATIONS.fetch_add(1, Ordering::Relaxed);
        let given = delta.len();
        let mut delta = delta.to_vec();
        let (interface, factor, s) = loop {
            let interface = [&delta[..], primal].concat();
            match condenser.condense(k, &interface, coordinates) {
                Ok((factor, s)) => break (interface, factor, s),
                // Nothing holds the interior: its free dof joins Γ and becomes a fixing dof there.
                Err(e) if delta.len() < given + MOST_FREE => {
                    delta.push(e.dof);
                    condenser.analysed = None;
                }
                Err(e) => return Err(e.into()),
            }
        };
        let stiff = diagonal(k, &interface);
        let mut gamma = Gamma {
            interface,
            n_delta: delta.len(),
            basis,
            ..Gamma::default()
        };
        let (t, sigma) = condense_dual(&mut gamma, &s, &stiff)?;
        Ok(LocalProblem {
            gamma,
            sigma,
            operators: SchurOperators::whole(Arc::new(factor), Arc::new(s), t),
            stiff,
        })
    }

    /// This subdomain with more primal functionals, Σ weights · u over dual dofs each. `k` is the very matrix that this
    /// problem was made of, and no multiple of it. S and the factor are shared with this one; only T, Ψ and Σ are
    /// computed again. Sparse solves become dense matrices, for which `k` is factored; lower triangles stay lower
    /// triangles.
    pub fn constrained<'a>(
        &self,
        k: &Csr,
        functionals: impl Iterator<Item = (&'a [u32], &'a [f64])>,
        coordinates: Option<&[[f64; 3]]>,
    ) -> Result<LocalProblem, NoFactor> {
        let (factor, s) = match self.operators.factor() {
            Some(factor) => (factor.clone(), self.s()),
            None => {
                let condenser = Condenser::alone(Keep::Interior);
                let (factor, s) = condenser.condense(k, &self.gamma.interface, coordinates)?;
                (Arc::new(factor), Arc::new(s))
            }
        };
        let mut gamma = Gamma {
            interface: self.gamma.interface.clone(),
            n_delta: self.gamma.n_delta,
            basis: self.gamma.basis.clone(),
            ..Gamma::default()
        };
        let delta = positions(&gamma.interface[..gamma.n_delta]);
        for (dofs, weights) in functionals {
            let new = gamma.basis.push(delta.of(dofs), weights);
            debug_assert!(new, "functionals are independent");
        }
        let (t, sigma) = condense_dual(&mut gamma, &s, &self.stiff)?;
        let mut operators = SchurOperators::whole(factor, s, t);
        operators.pack_like(&self.operators);
        Ok(LocalProblem {
            gamma,
            sigma,
            operators,
            stiff: self.stiff.clone(),
        })
    }

    /// A stiffness of each primal dof that is positive even where Σ vanishes: the energy of moving its dofs alone.
    pub(crate) fn primal_stiffness(&self) -> Vec<f64> {
        let n = self.gamma.n_gamma();
        // The diagonal of K bounds that of S where S is not available.
        let own = |i: usize| self.s_diagonal(i);
        let along = |(k, q): (usize, Vec<f64>)| {
            let terms = q.iter().enumerate().map(|(i, q)| q * q * own(i));
            self.gamma.basis.factor(k).powi(2) * terms.sum::<f64>()
        };
        let vectors = self.gamma.basis.vectors(n).into_iter().enumerate();
        let vertices = (self.gamma.n_delta..n).map(own);
        let fixing = self.gamma.fixing.iter().map(|&i| own(i));
        vertices.chain(vectors.map(along)).chain(fixing).collect()
    }

    /// The solves that Ψ follows from, where it is not stored.
    pub(crate) fn in_halves(&self) -> Option<&Implicit> {
        let solves = self.operators.solves();
        solves.filter(|_| self.gamma.psi.cols < self.gamma.n_pi())
    }

    /// Stores Ψ: several subdomains read it together.
    pub fn store_psi(&mut self) {
        if let Some(psi) = self.in_halves().map(|solves| solves.held().psi()) {
            self.gamma.psi = psi;
        }
    }

    /// Bytes of the factor and of the dense operators: (sparse, dense).
    pub fn bytes(&self) -> (usize, usize) {
        let (sparse, dense) = self.operators.bytes();
        let coarse = self.gamma.psi.data.len() + self.sigma.data.len();
        (sparse, dense + coarse * std::mem::size_of::<f64>())
    }
}

/// The functionals of averages over dofs of Δ.
pub(super) fn basis(delta: &[u32], averages: &[&Average]) -> Basis {
    let mut basis = Basis::default();
    let at = positions(delta);
    for average in averages {
        let at = at.of(&average.dofs);
        match &average.weights {
            None => basis.push_mean(at),
            Some(weights) => {
                let new = basis.push(at, weights);
                assert!(new, "functionals of averages are independent");
            }
        }
    }
    basis
}

/// The diagonal of `k` at these dofs.
fn diagonal(k: &Csr, dofs: &[u32]) -> Vec<f64> {
    dofs.iter()
        .map(|&i| k.get(i as usize, i as usize))
        .collect()
}

/// Positions of the dual dofs in Γ.
struct Positions(Vec<(u32, usize)>);

fn positions(delta: &[u32]) -> Positions {
    let mut place: Vec<(u32, usize)> = delta.iter().copied().zip(0..).collect();
    place.sort_unstable();
    Positions(place)
}

impl Positions {
    fn of(&self, dofs: &[u32]) -> Vec<usize> {
        let position = |i: &u32| {
            let at = self.0.binary_search_by_key(i, |p| p.0);
            self.0[at.expect("dofs of a functional are dual")].1
        };
        dofs.iter().map(position).collect()
    }
}
