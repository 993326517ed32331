//! S and T of one subdomain as sparse triangular solves, without a dense matrix.
//!
//! K is ordered [I, Γ] for S, S y = K_ΓΓ y − K_ΓI K_II⁻¹ K_IΓ y. For T it is ordered [r, v], with v the vertices and r
//! all other dofs, and the averages are held by multipliers ([`Held`]).
//!
//! Two sparse factorisations replace the dense matrices; an application reads both factors twice. This pays in space,
//! where S is nearly as large as a factor and takes many times as long to compute.

use std::sync::{Arc, OnceLock};

use super::basis::Basis;
use super::held::{self, Held};
use super::which::Operator;
use base::linalg::csr::Csr;
use base::linalg::dense::Dense;
use cholesky::interior::{Analysed, Analysis, SparseAnalysis};
use cholesky::lanes::LANES;
use cholesky::multifrontal::{PartialCholesky, SingularInterior};
use cholesky::reached::ReachedFronts;
use cholesky::symbolic::Symbolic;

/// The operators of one subdomain.
#[derive(Debug)]
pub struct Implicit {
    /// Interior dofs.
    inside: Vec<u32>,
    /// Dofs of Γ in the order [Δ, vertices].
    interface: Vec<u32>,
    n_delta: usize,
    /// Places of the interior dofs that couple with Γ, and the fronts of K_II that they reach.
    near: Vec<u32>,
    at_near: ReachedFronts,
    /// Their rows of K_IΓ, and K_ΓΓ.
    coupling: Csr,
    k_gamma: Csr,
    /// K_II.
    interior: PartialCholesky,
    /// K_rr with the vertices and averages as a border.
    held: Held,
    /// S and T as dense matrices, filled at the first request.
    whole: [OnceLock<Arc<Dense>>; 2],
    /// Ψ on Δ, filled at the first request.
    psi: OnceLock<Dense>,
}

impl Implicit {
    /// Factors K_II and K_rr; returns Σ, too. `None` if the vertices do not hold the subdomain. Analyses of the pattern
    /// are taken from `analysed` and left there.
    ///
    /// # Errors
    /// An interior that nothing holds.
    pub fn new(
        k: &Csr,
        interface: &[u32],
        n_delta: usize,
        basis: &Basis,
        coordinates: Option<&[[f64; 3]]>,
        analysed: Option<&Analysed>,
    ) -> Result<Option<(Implicit, Dense)>, SingularInterior> {
        let (delta, vertices) = interface.split_at(n_delta);
        let inside = k.others(interface);
        let averages = held::vectors(delta, basis);

        let dofs: Vec<Vec<u32>> = averages.iter().map(|a| a.0.clone()).collect();
        let known = analysed.and_then(|a| a.sparse.get());
        let known = known.filter(|known| known.averages == dofs);
        let new = known
            .is_none()
            .then(|| analysis(k, delta, vertices, dofs, coordinates));
        let known = known.or(new.as_ref()).expect("one of both");
        let border = [delta, vertices];
        let Some((held, sigma)) = Held::new(k, border, basis, &averages, &known.held) else {
            return Ok(None);
        };
        let made = known.interior.solver(&k.restricted(&inside));
        let (interior, _) = made.map_err(|e| SingularInterior {
            dof: inside[e.dof as usize],
        })?;
        if let (Some(analysed), Some(new)) = (analysed, new) {
            // Another thread may have left one in the meantime, which is the same.
            let _ = analysed.sparse.set(new);
        }
        let mut on_gamma = vec![false; k.n()];
        interface.iter().for_each(|&i| on_gamma[i as usize] = true);
        let couples = |i: u32| k.row(i as usize).0.iter().any(|&j| on_gamma[j as usize]);
        let near = (0..).zip(&inside).filter(|(_, &i)| couples(i));
        let (near, near_dofs): (Vec<u32>, Vec<u32>) = near.map(|(p, &i)| (p, i)).unzip();
        let out = Implicit {
            at_near: interior.reached(&near),
            near,
            coupling: k.block(&near_dofs, interface),
            k_gamma: k.block(interface, interface),
            interface: interface.to_vec(),
            inside,
            n_delta,
            interior,
            held,
            whole: Default::default(),
            psi: OnceLock::new(),
        };
        Ok(Some((out, sigma)))
    }

    /// K_rr with its border.
    pub fn held(&self) -> &Held {
        &self.held
    }

    /// Ψ on Δ as a dense matrix, built column by column once.
    pub fn psi(&self) -> &Dense {
        self.psi.get_or_init(|| self.held.psi())
    }

    fn n(&self) -> usize {
        self.inside.len() + self.interface.len()
    }

    /// A v for each of at most [`LANES`] `v`, A one of the operators.
    pub fn apply(&self, which: Operator, v: &[&[f64]]) -> Vec<Vec<f64>> {
        match which {
            Operator::S => self.s(v),
            Operator::T => self.held.t(v),
        }
    }

    /// The first `n` columns of y ← A v, several right-hand sides at once.
    pub fn apply_columns(&self, which: Operator, v: &Dense, y: &mut Dense, n: usize) {
        for first in (0..n).step_by(LANES) {
            let last = n.min(first + LANES);
            let lanes: Vec<&[f64]> = (first..last).map(|c| v.col(c)).collect();
            let done = self.apply(which, &lanes);
            for (c, done) in (first..last).zip(&done) {
                y.col_mut(c).copy_from_slice(done);
            }
        }
    }

    /// One of the operators as a dense matrix, built column by column once, for checks and other rare uses.
    pub fn whole(&self, which: Operator) -> &Arc<Dense> {
        let (known, n) = match which {
            Operator::S => (&self.whole[0], self.interface.len()),
            Operator::T => (&self.whole[1], self.n_delta),
        };
        known.get_or_init(|| {
            let mut unit = Dense::zeros(n, n);
            (0..n).for_each(|i| unit.set(i, i, 1.0));
            let mut out = Dense::zeros(n, n);
            self.apply_columns(which, &unit, &mut out, n);
            // Both triangles are filled: callers may read either one.
            out.mirror_lower();
            Arc::new(out)
        })
    }

    /// The entries of one of the operators in these rows and columns, by a solve for each column.
    pub fn block(&self, which: Operator, at: &[usize]) -> Dense {
        let n = match which {
            Operator::S => self.interface.len(),
            Operator::T => self.n_delta,
        };
        let unit = |&i: &usize| {
            let mut e = vec![0.0; n];
            e[i] = 1.0;
            e
        };
        let mut out = Dense::zeros(at.len(), 0);
        for some in at.chunks(LANES) {
            let units: Vec<Vec<f64>> = some.iter().map(unit).collect();
            let units: Vec<&[f64]> = units.iter().map(Vec::as_slice).collect();
            for column in self.apply(which, &units) {
                out.data.extend(at.iter().map(|&i| column[i]));
            }
        }
        out.cols = at.len();
        out.symmetrise();
        out
    }

    /// S as a dense matrix, if it has been asked for.
    pub fn known_s(&self) -> Option<&Dense> {
        self.whole[0].get().map(|s| &**s)
    }

    /// K_II⁻¹ of several loads on the interior dofs.
    fn solve_interior(&self, b: &mut [Vec<f64>]) {
        self.interior.solve_many(b);
    }

    /// K_IΓ u at the interior dofs that couple with Γ.
    fn coupled(&self, u: &[f64]) -> Vec<f64> {
        let mut b = vec![0.0; self.near.len()];
        self.coupling.add_mul(1.0, u, &mut b);
        b
    }

    /// S v for each of at most [`LANES`] `v` (length n_Γ).
    fn s(&self, v: &[&[f64]]) -> Vec<Vec<f64>> {
        let b: Vec<Vec<f64>> = v.iter().map(|v| self.coupled(v)).collect();
        let b: Vec<&[f64]> = b.iter().map(Vec::as_slice).collect();
        let x = self.interior.solve_at(&self.at_near, &b);
        let back = |(v, x): (&&[f64], &Vec<f64>)| {
            let mut y = vec![0.0; self.interface.len()];
            self.k_gamma.add_mul(1.0, v, &mut y);
            self.coupling.add_mul_transpose(-1.0, x, &mut y);
            y
        };
        v.iter().zip(&x).map(back).collect()
    }

    /// Condensed loads: (K_II⁻¹ f_I on the interior dofs, zero elsewhere; g on Γ).
    pub fn condense(&self, loads: &[&[f64]]) -> Vec<(Vec<f64>, Vec<f64>)> {
        let inside = |f: &&[f64]| self.inside.iter().map(|&i| f[i as usize]).collect();
        let mut x: Vec<Vec<f64>> = loads.iter().map(inside).collect();
        self.solve_interior(&mut x);
        let of = |(f, x): (&&[f64], &Vec<f64>)| {
            let mut g: Vec<f64> = self.interface.iter().map(|&i| f[i as usize]).collect();
            let near: Vec<f64> = self.near.iter().map(|&p| x[p as usize]).collect();
            self.coupling.add_mul_transpose(-1.0, &near, &mut g);
            let mut work = vec![0.0; self.n()];
            self.inside
                .iter()
                .zip(x)
                .for_each(|(&i, x)| work[i as usize] = *x);
            (work, g)
        };
        loads.iter().zip(&x).map(of).collect()
    }

    /// Solutions from the interior part that [`condense`](Self::condense) has left and from the interface values. `x`
    /// has both in place.
    pub fn recover(&self, x: &mut [Vec<f64>]) {
        let lift = |x: &Vec<f64>| {
            let u: Vec<f64> = self.interface.iter().map(|&i| x[i as usize]).collect();
            let mut b = vec![0.0; self.inside.len()];
            let near = self.near.iter().zip(self.coupled(&u));
            near.for_each(|(&p, v)| b[p as usize] = v);
            b
        };
        let mut b: Vec<Vec<f64>> = x.iter().map(lift).collect();
        self.solve_interior(&mut b);
        for (x, b) in x.iter_mut().zip(&b) {
            for (&i, b) in self.inside.iter().zip(b) {
                x[i as usize] -= b;
            }
        }
    }

    /// Bytes of the factors and of the blocks of K, and of the dense parts.
    pub fn bytes(&self) -> (usize, usize) {
        let (held, dense) = self.held.bytes();
        let sparse = self.interior.bytes() + held + self.coupling.bytes() + self.k_gamma.bytes();
        let whole = self.whole.iter().filter_map(OnceLock::get);
        let psi = self.psi.get().map_or(0, |psi| psi.data.len());
        let whole: usize = whole.map(|a| a.data.len()).sum::<usize>() + psi;
        (sparse, dense + 8 * whole)
    }
}

/// The analyses behind sparse solves, for a pattern with these dofs in Δ, vertices, and dofs of each average.
pub fn analysis(
    k: &Csr,
    delta: &[u32],
    vertices: &[u32],
    averages: Vec<Vec<u32>>,
    coordinates: Option<&[[f64; 3]]>,
) -> SparseAnalysis {
    let inside = k.others(&[delta, vertices].concat());
    let at = |x: &[[f64; 3]]| inside.iter().map(|&i| x[i as usize]).collect();
    let places: Option<Vec<[f64; 3]>> = coordinates.map(at);
    let interior = Symbolic::new(&k.restricted(&inside), &[], places.as_deref());
    let held = Held::analysis(k, vertices, averages.iter().map(Vec::as_slice), coordinates);
    SparseAnalysis {
        held: Analysis::new(held),
        averages,
        interior: Analysis::new(interior),
    }
}
