//! S and T of one subdomain as sparse triangular solves, without a dense matrix.
//!
//! K is ordered [I, Γ] for S. For T it is ordered [r, v], with v the vertices and r all other dofs:
//!
//! ```text
//!     S y = K_ΓΓ y − K_ΓI K_II⁻¹ K_IΓ y
//!     T w = X₀ − X M⁻¹ Qᵀ X₀,     X₀ = K_rr⁻¹ w on Δ,   X = K_rr⁻¹ Q on Δ,   M = Qᵀ X
//!     Ψ   = [Ψ₀ − X M⁻¹ Qᵀ Ψ₀,  X M⁻¹ D]               Ψ₀ = −K_rr⁻¹ K_rv on Δ,   D the factors of the averages
//!     Σ   = [S_vv + AᵀM⁻¹A,  −AᵀM⁻¹D;  ·,  D M⁻¹ D]     A = Qᵀ Ψ₀
//! ```
//!
//! The columns of Q are the unit vectors behind the averages. Two sparse factorisations replace the dense matrices; an
//! application reads both factors twice. This pays in space, where S is nearly as large as a factor and takes many
//! times as long to compute.

use std::sync::{Arc, OnceLock};

use super::basis::Basis;
use super::which::Operator;
use base::linalg::csr::Csr;
use base::linalg::dense::{self, Dense, Scratch};
use cholesky::interior::{Analysed, Analysis};
use cholesky::lanes::LANES;
use cholesky::multifrontal::{PartialCholesky, SingularInterior};
use cholesky::symbolic::Symbolic;

/// K_rr counts as singular if a pivot is below this fraction of its diagonal entry. The vertices alone do not hold the
/// subdomain then.
const WEAKLY_HELD: f64 = 1e-6;

/// The operators of one subdomain.
#[derive(Debug)]
pub struct Implicit {
    /// Interior dofs.
    inside: Vec<u32>,
    /// Dofs of Γ in the order [Δ, vertices].
    interface: Vec<u32>,
    n_delta: usize,
    /// K_IΓ and K_ΓΓ.
    coupling: Csr,
    k_gamma: Csr,
    /// K_II.
    interior: PartialCholesky,
    /// K_rr, factored with the vertices kept.
    held: PartialCholesky,
    /// X, n_Δ × averages.
    x: Dense,
    /// M = L Lᵀ.
    m: Dense,
    /// S and T as dense matrices, filled at the first request.
    whole: [OnceLock<Arc<Dense>>; 2],
}

/// Ψ on Δ and Σ, which come from the same factors.
pub struct Coarse {
    /// n_Δ × n_Π.
    pub psi: Dense,
    /// n_Π × n_Π.
    pub sigma: Dense,
}

impl Implicit {
    /// Factors K_II and K_rr. Returns `None` if the vertices do not hold the subdomain. Analyses of the pattern are
    /// taken from `analysed` and left there.
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
    ) -> Result<Option<(Implicit, Coarse)>, SingularInterior> {
        let vertices = &interface[n_delta..];
        let inside = k.others(interface);

        let known = analysed.and_then(|a| a.sparse.get());
        let new = known
            .is_none()
            .then(|| Analysis::new(Symbolic::new(k, vertices, coordinates)));
        let of_held = known.map_or_else(|| new.as_ref().expect("made just now"), |k| &k[0]);
        let Ok((held, s_vv)) = of_held.solver(k) else {
            return Ok(None);
        };
        if held.weakest_pivot(k) <= WEAKLY_HELD {
            return Ok(None);
        }
        let k_inside = k.restricted(&inside);
        let singular = |e: SingularInterior| SingularInterior {
            dof: inside[e.dof as usize],
        };
        let (interior, _) = match known {
            Some([_, of_interior]) => of_interior.solver(&k_inside).map_err(singular)?,
            None => {
                let places: Option<Vec<[f64; 3]>> =
                    coordinates.map(|x| inside.iter().map(|&i| x[i as usize]).collect());
                let of_interior = Analysis::new(Symbolic::new(&k_inside, &[], places.as_deref()));
                let made = of_interior.solver(&k_inside).map_err(singular)?;
                if let (Some(analysed), Some(of_held)) = (analysed, new) {
                    // Another thread may have left them in the meantime, which are the same.
                    let _ = analysed.sparse.set([of_held, of_interior]);
                }
                made
            }
        };

        let mut out = Implicit {
            coupling: k.block(&inside, interface),
            k_gamma: k.block(interface, interface),
            interface: interface.to_vec(),
            inside,
            n_delta,
            interior,
            held,
            x: Dense::zeros(n_delta, 0),
            m: Dense::default(),
            whole: Default::default(),
        };
        let q = basis.vectors(interface.len());
        let q: Vec<&[f64]> = q.iter().map(|q| &q[..n_delta]).collect();
        let loads = q.iter().map(|q| out.on_delta(q)).collect();
        let x = out.solve_held(loads);
        out.x = columns(n_delta, &x);
        let mut m = Dense::zeros(q.len(), q.len());
        for (b, x) in x.iter().enumerate() {
            for (a, q) in q.iter().enumerate() {
                m.set(a, b, dense::dot(q, x));
            }
        }
        // Averages that are determined by the vertices would make M singular.
        if dense::cholesky(m.view_mut(), &mut Scratch::default()).is_err() {
            return Ok(None);
        }
        out.m = m;
        let coarse = out.coarse(k, &q, &s_vv, basis);
        Ok(Some((out, coarse)))
    }

    fn coarse(&self, k: &Csr, q: &[&[f64]], s_vv: &Dense, basis: &Basis) -> Coarse {
        let vertices = &self.interface[self.n_delta..];
        let (n_v, n_q) = (vertices.len(), q.len());
        // −K_rv: the load on r when one vertex moves.
        let pull = |&v: &u32| {
            let mut b = vec![0.0; self.n()];
            let (col, val) = k.row(v as usize);
            col.iter().zip(val).for_each(|(&j, v)| b[j as usize] = -v);
            b
        };
        let moved = self.solve_held(vertices.iter().map(pull).collect());
        // M⁻¹ [A, D]
        let mut right = Dense::zeros(n_q, n_v + n_q);
        let mut a = Dense::zeros(n_q, n_v);
        for (j, psi) in moved.iter().enumerate() {
            for (i, q) in q.iter().enumerate() {
                a.set(i, j, dense::dot(q, psi));
            }
            right.col_mut(j).copy_from_slice(a.col(j));
        }
        for i in 0..n_q {
            right.set(i, n_v + i, basis.factor(i));
        }
        dense::solve_lower(self.m.view(), right.view_mut());
        dense::solve_lower_transpose(self.m.view(), right.view_mut());

        let n_pi = n_v + n_q;
        let mut psi = Dense::zeros(self.n_delta, n_pi);
        for (j, moved) in moved.iter().enumerate() {
            psi.col_mut(j).copy_from_slice(moved);
        }
        let mut sigma = Dense::zeros(n_pi, n_pi);
        for j in 0..n_pi {
            let sign = if j < n_v { -1.0 } else { 1.0 };
            let c: Vec<f64> = right.col(j).iter().map(|c| sign * c).collect();
            self.x.add_mul(&c, psi.col_mut(j));
            for i in 0..n_v {
                let own = if j < n_v { s_vv.get(i, j) } else { 0.0 };
                sigma.set(i, j, own - dense::dot(a.col(i), &c));
            }
            for (i, c) in c.iter().enumerate() {
                sigma.set(n_v + i, j, basis.factor(i) * c);
            }
        }
        sigma.symmetrise();
        Coarse { psi, sigma }
    }

    fn n(&self) -> usize {
        self.inside.len() + self.interface.len()
    }

    /// A load on Δ, extended by zero to all dofs.
    fn on_delta(&self, w: &[f64]) -> Vec<f64> {
        let mut b = vec![0.0; self.n()];
        let delta = self.interface[..self.n_delta].iter().zip(w);
        delta.for_each(|(&i, w)| b[i as usize] = *w);
        b
    }

    fn take_delta(&self, b: &[f64]) -> Vec<f64> {
        let delta = self.interface[..self.n_delta].iter();
        delta.map(|&i| b[i as usize]).collect()
    }

    /// K_rr⁻¹ of loads on all dofs, on Δ.
    fn solve_held(&self, mut b: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        self.held.solve_many(&mut b);
        b.iter().map(|b| self.take_delta(b)).collect()
    }

    /// A v for each of `v`, A one of the operators.
    pub fn apply(&self, which: Operator, v: &[&[f64]]) -> Vec<Vec<f64>> {
        match which {
            Operator::S => self.s(v),
            Operator::T => self.t(v),
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

    /// T w for each of `w` (length n_Δ or more, of which the first n_Δ entries count).
    fn t(&self, w: &[&[f64]]) -> Vec<Vec<f64>> {
        let loads = w.iter().map(|w| self.on_delta(&w[..self.n_delta]));
        let mut y = self.solve_held(loads.collect());
        if self.x.cols > 0 {
            for (y, w) in y.iter_mut().zip(w) {
                let mut c = Dense::zeros(self.x.cols, 1);
                self.x.add_mul_transpose(&w[..self.n_delta], c.col_mut(0));
                dense::solve_lower(self.m.view(), c.view_mut());
                dense::solve_lower_transpose(self.m.view(), c.view_mut());
                c.data.iter_mut().for_each(|c| *c = -*c);
                self.x.add_mul(c.col(0), y);
            }
        }
        y
    }

    /// K_II⁻¹ of several loads on the interior dofs.
    fn solve_interior(&self, b: &mut [Vec<f64>]) {
        self.interior.solve_many(b);
    }

    /// S v for each of `v` (length n_Γ).
    fn s(&self, v: &[&[f64]]) -> Vec<Vec<f64>> {
        let inside = |v: &&[f64]| {
            let mut b = vec![0.0; self.inside.len()];
            self.coupling.add_mul(1.0, v, &mut b);
            b
        };
        let mut b: Vec<Vec<f64>> = v.iter().map(inside).collect();
        self.solve_interior(&mut b);
        let back = |(v, b): (&&[f64], &Vec<f64>)| {
            let mut y = vec![0.0; self.interface.len()];
            self.k_gamma.add_mul(1.0, v, &mut y);
            self.coupling.add_mul_transpose(-1.0, b, &mut y);
            y
        };
        v.iter().zip(&b).map(back).collect()
    }

    /// Condensed loads: (K_II⁻¹ f_I on the interior dofs, zero elsewhere; g on Γ).
    pub fn condense(&self, loads: &[&[f64]]) -> Vec<(Vec<f64>, Vec<f64>)> {
        let inside = |f: &&[f64]| self.inside.iter().map(|&i| f[i as usize]).collect();
        let mut x: Vec<Vec<f64>> = loads.iter().map(inside).collect();
        self.solve_interior(&mut x);
        let of = |(f, x): (&&[f64], &Vec<f64>)| {
            let mut g: Vec<f64> = self.interface.iter().map(|&i| f[i as usize]).collect();
            self.coupling.add_mul_transpose(-1.0, x, &mut g);
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
            self.coupling.add_mul(1.0, &u, &mut b);
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
        let sparse = self.interior.bytes()
            + self.held.bytes()
            + self.coupling.bytes()
            + self.k_gamma.bytes();
        let whole = self.whole.iter().filter_map(OnceLock::get);
        let whole: usize = whole.map(|a| a.data.len()).sum();
        (sparse, 8 * (self.x.data.len() + self.m.data.len() + whole))
    }
}

fn columns(rows: usize, of: &[Vec<f64>]) -> Dense {
    Dense {
        rows,
        cols: of.len(),
        data: of.concat(),
    }
}
