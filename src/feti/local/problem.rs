//! The operators of one subdomain on its interface: S, T, Ψ and Σ of method section 2.
//!
//! The interface Γ is ordered [Δ, vertices]. Without averages the vertices are the primal dofs Π, and from the Schur complement S on Γ
//! follow
//!
//! ```text
//!     T = S_ΔΔ⁻¹          local solve with the primal dofs held
//!     Ψ = [−T S_ΔΠ; I]    energy-minimal functions with value 1 at one primal dof, 0 at the others
//!     Σ = Ψᵀ S Ψ = S_ΠΠ − S_ΠΔ T S_ΔΠ
//! ```
//!
//! An average over dual dofs, or any other functional of them, is made a coordinate first ([`Basis`]), and so are the dofs that have to be held to make S_ΔΔ regular: the
//! formulas hold in that basis, and only T and Ψ know of it. Everything outside sees nodal dofs.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::Arc;

use super::basis::Basis;
use super::dense::Dense;
use super::interior::{Factor, LocalSolver, NoFactor};
use super::multifrontal::SingularInterior;
use crate::sparse::Csr;

/// So many motions of a subdomain that touches nothing are looked for: twice the rigid motions of a solid. A matrix that still
/// has a bad pivot then is not semidefinite at all, and trying on would cost a factorisation per dof.
const MOST_FREE: usize = 12;

/// Factorisations in this process so far.
static FACTORISATIONS: AtomicUsize = AtomicUsize::new(0);

/// How many subdomains this process has factored so far: a contact loop must not add to it.
pub fn factorisations() -> usize {
    FACTORISATIONS.load(Ordering::Relaxed)
}

/// One subdomain, factored.
#[derive(Debug)]
pub struct LocalProblem {
    /// Local dofs of the interface in the order [Δ, vertices]; length n_Γ.
    pub interface: Vec<u32>,
    /// Number of dual interface dofs. Those of averages and the fixing dofs are among them.
    pub n_delta: usize,
    /// Functionals of dual dofs that are primal: averages, and what adaptivity added.
    pub basis: Basis,
    /// Positions in Γ of the coordinates that were added here to the primal dofs to make S_ΔΔ regular.
    pub fixing: Vec<usize>,
    /// S on Γ, n_Γ × n_Γ, both triangles.
    pub s: Arc<Dense>,
    /// T, n_Δ × n_Δ, both triangles.
    pub t: Dense,
    /// Ψ on Δ, n_Δ × n_Π (on the vertices it is the identity in their columns and zero in the others).
    pub psi: Dense,
    /// Σ, n_Π × n_Π.
    pub sigma: Dense,
    factor: Arc<Factor>,
}

impl LocalProblem {
    /// Factors subdomain matrix `k` with the given dual and primal interface dofs; `averages` lists dual dofs whose means
    /// are primal.
    ///
    /// # Errors
    /// A matrix that is no stiffness matrix; what the solver says.
    pub fn new(
        k: &Csr,
        delta: &[u32],
        primal: &[u32],
        averages: &[&[u32]],
        coordinates: Option<&[[f64; 3]]>,
        solver: LocalSolver,
    ) -> Result<LocalProblem, NoFactor> {
        let given = delta.len();
        let mut delta = delta.to_vec();
        let (interface, factor, s) = loop {
            let interface = [&delta[..], primal].concat();
            match solver.condense(k, &interface, coordinates) {
                Ok((factor, s)) => {
                    FACTORISATIONS.fetch_add(1, Ordering::Relaxed);
                    break (interface, factor, s);
                }
                // An interior that nothing holds: its free dof joins Γ, where it becomes a fixing dof.
                Err(NoFactor::Interior(e)) if delta.len() < given + MOST_FREE => delta.push(e.dof),
                Err(e) => return Err(e),
            }
        };
        let n_delta = delta.len();
        let stiff: Vec<f64> = interface
            .iter()
            .map(|&i| k.get(i as usize, i as usize))
            .collect();
        let mut basis = Basis::default();
        let delta = positions(&interface[..given]);
        let at = averages.iter().map(|a| delta.of(a));
        at.for_each(|at| basis.push_mean(at));
        let mut out = LocalProblem {
            interface,
            n_delta,
            basis,
            fixing: Vec::new(),
            s: Arc::new(s),
            t: Dense::default(),
            psi: Dense::default(),
            sigma: Dense::default(),
            factor: Arc::new(factor),
        };
        out.condense_dual(&stiff)?;
        Ok(out)
    }

    /// The same subdomain with more functionals primal, Σ weights · u over dual dofs each. S and the factor are shared with what is
    /// there; only T, Ψ and Σ are computed again.
    pub fn constrained<'a>(
        &self,
        k: &Csr,
        functionals: impl Iterator<Item = (&'a [u32], &'a [f64])>,
    ) -> Result<LocalProblem, SingularInterior> {
        let mut out = LocalProblem {
            interface: self.interface.clone(),
            n_delta: self.n_delta,
            basis: self.basis.clone(),
            fixing: Vec::new(),
            s: self.s.clone(),
            t: Dense::default(),
            psi: Dense::default(),
            sigma: Dense::default(),
            factor: self.factor.clone(),
        };
        let delta = positions(&self.interface[..self.n_delta]);
        for (dofs, weights) in functionals {
            let new = out.basis.push(delta.of(dofs), weights);
            debug_assert!(new, "functionals are independent");
        }
        let diagonal = self
            .interface
            .iter()
            .map(|&i| k.get(i as usize, i as usize));
        out.condense_dual(&diagonal.collect::<Vec<f64>>())?;
        Ok(out)
    }

    /// Number of interface dofs n_Γ.
    pub fn n_gamma(&self) -> usize {
        self.interface.len()
    }

    /// Number of vertices: the primal dofs that are single dofs of Γ, the first ones.
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
            self.basis.to_coordinates(&mut changed);
        }
        let vertices = u[self.n_delta..].iter().copied();
        let fixing = self.fixing.iter().map(|&i| changed[i]);
        vertices.chain(self.basis.values(u)).chain(fixing).collect()
    }

    /// A stiffness of each primal dof that does not vanish with Σ: what it takes to move its dofs alone.
    pub fn primal_stiffness(&self) -> Vec<f64> {
        let n = self.n_gamma();
        let own = |i: usize| self.s.get(i, i);
        let along = |(k, q): (usize, Vec<f64>)| {
            let terms = q.iter().enumerate().map(|(i, q)| q * q * own(i));
            self.basis.factor(k).powi(2) * terms.sum::<f64>()
        };
        let vectors = self.basis.vectors(n).into_iter().enumerate();
        let vertices = (self.n_delta..n).map(own);
        let fixing = self.fixing.iter().map(|&i| own(i));
        vertices.chain(vectors.map(along)).chain(fixing).collect()
    }

    /// The condensed load: returns (work, g) with g = f_Γ − K_ΓI K_II⁻¹ f_I in the order of Γ and `work` to be
    /// handed to [`recover`](Self::recover).
    pub fn condense(&self, f: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut work = f.to_vec();
        self.factor.forward(&mut work);
        let g = self.interface.iter().map(|&i| work[i as usize]).collect();
        (work, g)
    }

    /// The solution on all dofs from its interface values `u_gamma` and the `work` of [`condense`](Self::condense).
    pub fn recover(&self, mut work: Vec<f64>, u_gamma: &[f64]) -> Vec<f64> {
        for (&i, &u) in self.interface.iter().zip(u_gamma) {
            work[i as usize] = u;
        }
        self.factor.backward(&mut work);
        work
    }

    /// [`condense`](Self::condense) of several loads, at most [`LANES`](super::lanes::LANES).
    pub fn condense_many(&self, loads: &[&[f64]]) -> Vec<(Vec<f64>, Vec<f64>)> {
        if let [f] = loads {
            return vec![self.condense(f)];
        }
        let mut work: Vec<Vec<f64>> = loads.iter().map(|f| f.to_vec()).collect();
        self.factor.forward_many(&mut work);
        let with_gamma = |w: Vec<f64>| {
            let g = self.interface.iter().map(|&i| w[i as usize]).collect();
            (w, g)
        };
        work.into_iter().map(with_gamma).collect()
    }

    /// [`recover`](Self::recover) of several solutions, at most [`LANES`](super::lanes::LANES): (`work`, `u_gamma`) of each.
    pub fn recover_many(&self, parts: &[(&[f64], &[f64])]) -> Vec<Vec<f64>> {
        if let [(work, u_gamma)] = parts {
            return vec![self.recover(work.to_vec(), u_gamma)];
        }
        let placed = |(work, u_gamma): &(&[f64], &[f64])| {
            let mut x = work.to_vec();
            for (&i, &u) in self.interface.iter().zip(*u_gamma) {
                x[i as usize] = u;
            }
            x
        };
        let mut x: Vec<Vec<f64>> = parts.iter().map(placed).collect();
        self.factor.backward_many(&mut x);
        x
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

    /// Bytes held by the factor and by the dense operators: (sparse, dense).
    pub fn bytes(&self) -> (usize, usize) {
        let dense = [&*self.s, &self.t, &self.psi, &self.sigma];
        let dense: usize = dense.iter().map(|d| d.data.len()).sum();
        (self.factor.bytes(), dense * std::mem::size_of::<f64>())
    }
}

/// Where the first dofs of Γ stand.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::feti::local::testing::{grid_laplacian, random};

    #[test]
    fn s_plus_inverts_a_definite_subdomain() {
        // With one subdomain, S̃⁺ = T + Ψ Σ⁻¹ Ψᵀ is S⁻¹; interiors come back through condense and recover.
        let (k, x) = grid_laplacian(9, 9, 0.1);
        let delta: Vec<u32> = (1..8).collect();
        let local = LocalProblem::new(&k, &delta, &[0, 8], &[], Some(&x), LocalSolver::default())
            .expect("definite");
        assert!(local.fixing.is_empty());
        let u = random(k.n(), 5);
        let mut f = vec![0.0; k.n()];
        k.mul(&u, &mut f);
        let (work, g) = local.condense(&f);
        let mut p = vec![0.0; 2];
        local.psi_transpose(&g, &mut p);
        let s = |i, j| local.sigma.get(i, j);
        let det = s(0, 0) * s(1, 1) - s(0, 1) * s(1, 0);
        let c = [
            (s(1, 1) * p[0] - s(0, 1) * p[1]) / det,
            (s(0, 0) * p[1] - s(1, 0) * p[0]) / det,
        ];
        let mut u_gamma = vec![0.0; local.n_gamma()];
        let n_delta = local.n_delta;
        local.t.add_mul(&g[..n_delta], &mut u_gamma[..n_delta]);
        local.add_psi(&c, &mut u_gamma);
        let back = local.recover(work, &u_gamma);
        let error = back
            .iter()
            .zip(&u)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        assert!(error < 1e-12, "error {error:.1e}");
    }

    #[test]
    fn an_indefinite_or_broken_matrix_is_refused() {
        for value in [-3.0, f64::NAN] {
            let (mut k, x) = grid_laplacian(12, 12, 0.1);
            for i in 0..k.n() {
                let at = k.row_ptr[i]
                    + k.row(i)
                        .0
                        .iter()
                        .position(|&j| j as usize == i)
                        .expect("diagonal");
                k.val[at] += value;
            }
            let delta: Vec<u32> = (0..12).collect();
            assert!(
                LocalProblem::new(&k, &delta, &[], &[], Some(&x), LocalSolver::default()).is_err(),
                "{value}"
            );
        }
    }

    #[test]
    fn a_floating_subdomain_holds_one_dof_and_its_primal_matrix_vanishes() {
        let (k, x) = grid_laplacian(8, 6, 0.0);
        let delta: Vec<u32> = (0..8).collect();
        let local = LocalProblem::new(&k, &delta, &[], &[], Some(&x), LocalSolver::default())
            .expect("one dof is held");
        assert_eq!((local.fixing.len(), local.n_pi()), (1, 1));
        assert!(local.sigma.get(0, 0).abs() < 1e-13);
        assert!(local.psi.data.iter().all(|v| (v - 1.0).abs() < 1e-12));
    }
}
