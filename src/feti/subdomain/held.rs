//! K_rr of one subdomain, factored with the vertices and the averages as a border:
//!
//! ```text
//!     [ K_rr  K_rv  Q ]        eliminate r        [ S_vv  Aᵀ ]
//!     [ K_vr  K_vv  0 ]       ------------>       [ A     −M ]       A = −Qᵀ K_rr⁻¹ K_rv,   M = Qᵀ K_rr⁻¹ Q
//!     [ Qᵀ    0     0 ]
//! ```
//!
//! The columns of Q are the unit vectors behind the averages, the unknowns of the last row the multipliers μ that hold
//! them. One factorisation has all that the coarse functions need: a function with the values u of the vertices and D a
//! of the averages has μ = M⁻¹ (A u − D a), and follows on r by the way back alone.

use super::basis::Basis;
use base::linalg::csr::Csr;
use base::linalg::dense::{self, Dense, Scratch};
use cholesky::dissection::nested_dissection;
use cholesky::interior::Analysis;
use cholesky::lanes::LANES;
use cholesky::multifrontal::PartialCholesky;
use cholesky::reached::{Ordered, ReachedFronts};
use cholesky::symbolic::Symbolic;

/// K_rr counts as singular if a pivot is below this fraction of its diagonal entry. The vertices alone do not hold the
/// subdomain then.
const WEAKLY_HELD: f64 = 1e-6;

/// A unit vector behind an average: local dofs and entries.
pub type AverageVector = (Vec<u32>, Vec<f64>);

/// The unit vectors behind the averages of `basis` on the dofs `delta`.
pub fn vectors(delta: &[u32], basis: &Basis) -> Vec<AverageVector> {
    let vectors = basis.vectors(delta.len());
    let of = |(q, at): (&Vec<f64>, &[usize])| at.iter().map(|&i| (delta[i], q[i])).unzip();
    vectors.iter().zip(basis.supports()).map(of).collect()
}

/// The factor of K_rr with its border.
#[derive(Debug)]
pub struct Held {
    factor: PartialCholesky,
    /// Δ, and the fronts that it reaches: loads are there, and the solution is wanted there.
    delta: ReachedFronts,
    n_delta: usize,
    n_vertices: usize,
    /// M⁻¹.
    m_inverse: Dense,
    /// μ of every coarse function, a column for each: M⁻¹ [A, −D].
    mu: Dense,
}

impl Held {
    /// The analysis of a pattern with these vertices, and averages over these dofs.
    pub fn analysis<'a>(
        k: &Csr,
        vertices: &[u32],
        averages: impl Iterator<Item = &'a [u32]>,
        coordinates: Option<&[[f64; 3]]>,
    ) -> Symbolic {
        let one = |dofs: &[u32]| (dofs.to_vec(), vec![1.0; dofs.len()]);
        let averages: Vec<AverageVector> = averages.map(one).collect();
        // Averages do not change the order in which r is eliminated.
        let order = nested_dissection(k, &k.others(vertices), coordinates);
        let border = border(k, vertices, averages.len());
        Symbolic::with_supernodes(&bordered(k, &averages), &border, &order)
    }

    /// Factors `k` with the analysis of its pattern; returns Σ = [S_vv + Aᵀ M⁻¹ A, −Aᵀ M⁻¹ D; ·, D M⁻¹ D], too. `None`
    /// if the vertices do not hold the subdomain, or if they determine an average.
    pub fn new(
        k: &Csr,
        interface: [&[u32]; 2],
        basis: &Basis,
        averages: &[AverageVector],
        analysis: &Analysis,
    ) -> Option<(Held, Dense)> {
        let k = bordered(k, averages);
        let (factor, s) = analysis.bordered(&k, interface[0]).ok()?;
        if factor.weakest_pivot() <= WEAKLY_HELD {
            return None;
        }
        let [delta, vertices] = interface;
        let (n_v, n_q) = (vertices.len(), averages.len());
        let a = Dense::from_fn(n_q, n_v, |i, j| s.get(n_v + i, j));
        let mut m = Dense::from_fn(n_q, n_q, |i, j| -s.get(n_v + i, n_v + j));
        let mut scratch = Scratch::default();
        dense::cholesky(m.view_mut(), &mut scratch).ok()?;
        let m_inverse = dense::inverse_from_cholesky(m.view(), &mut scratch);
        // D has the norms of the averages' coefficients.
        let mut right = Dense::zeros(n_q, n_v + n_q);
        right.data[..n_q * n_v].copy_from_slice(&a.data);
        (0..n_q).for_each(|i| right.set(i, n_v + i, -basis.factor(i)));
        let mut mu = Dense::zeros(n_q, n_v + n_q);
        dense::multiply(mu.view_mut(), false, 1.0, m_inverse.view(), right.view());
        // Σ = [A, −D]ᵀ M⁻¹ [A, −D], and S_vv.
        let mut sigma = Dense::zeros(n_v + n_q, n_v + n_q);
        let transposed = right.view().transpose();
        dense::multiply(sigma.view_mut(), false, 1.0, transposed, mu.view());
        for j in 0..n_v {
            for i in 0..n_v {
                sigma.set(i, j, sigma.get(i, j) + s.get(i, j));
            }
        }
        sigma.symmetrise();
        let held = Held {
            delta: factor.reached(delta),
            n_delta: delta.len(),
            n_vertices: n_v,
            factor,
            m_inverse,
            mu,
        };
        Some((held, sigma))
    }

    /// The way forward for at most [`LANES`] loads on Γ = [Δ, vertices]: what [`finish`](Self::finish) goes on with,
    /// and Ψᵀ v.
    pub fn begin(&self, v: &[&[f64]]) -> (Ordered, Vec<Vec<f64>>) {
        let x = self.factor.forward_at(&self.delta, v);
        let values = |(c, v): (usize, &&[f64])| {
            let border = self.factor.on_interface(&x, c);
            let (vertices, averages) = border.split_at(self.n_vertices);
            let own = v[v.len() - self.n_vertices..].iter();
            let mut p: Vec<f64> = vertices.iter().zip(own).map(|(x, v)| x + v).collect();
            p.resize(self.mu.cols, 0.0);
            // What the load leaves at the averages is −Qᵀ K_rr⁻¹ v.
            self.mu.add_mul_transpose(averages, &mut p);
            p
        };
        let p = v.iter().enumerate().map(values).collect();
        (x, p)
    }

    /// T v + Ψ c on Δ, from what [`begin`](Self::begin) has left of v.
    pub fn finish(&self, mut x: Ordered, c: &[&[f64]]) -> Vec<Vec<f64>> {
        for (column, c) in c.iter().enumerate() {
            let border = self.factor.on_interface(&x, column);
            let mut mu = vec![0.0; self.mu.rows];
            self.m_inverse.add_mul(&border[self.n_vertices..], &mut mu);
            mu.iter_mut().for_each(|mu| *mu = -*mu);
            self.mu.add_mul(c, &mut mu);
            let border = [&c[..self.n_vertices], &mu].concat();
            self.factor.set_interface(&mut x, column, &border);
        }
        self.factor.backward_at(&self.delta, x)
    }

    /// T v on Δ for each of at most [`LANES`] `v`, of which the entries on Δ count.
    pub fn t(&self, v: &[&[f64]]) -> Vec<Vec<f64>> {
        let zero = vec![0.0; self.mu.cols];
        let x = self.factor.forward_at(&self.delta, v);
        self.finish(x, &vec![&zero[..]; v.len()])
    }

    /// Ψ on Δ.
    pub fn psi(&self) -> Dense {
        let n_pi = self.mu.cols;
        let unit = |p: usize| {
            let mut c = vec![0.0; n_pi];
            c[p] = 1.0;
            c
        };
        let units: Vec<Vec<f64>> = (0..n_pi).map(unit).collect();
        let units: Vec<&[f64]> = units.iter().map(Vec::as_slice).collect();
        let mut psi = Dense::zeros(self.n_delta, 0);
        for some in units.chunks(LANES) {
            let columns = self.finish(self.nothing(some.len()), some);
            columns.iter().for_each(|column| psi.data.extend(column));
        }
        psi.cols = n_pi;
        psi
    }

    /// Empty loads, as [`begin`](Self::begin) leaves them.
    pub fn nothing(&self, columns: usize) -> Ordered {
        self.factor.zeros(columns)
    }

    /// Bytes of the factor, and of the dense parts.
    pub fn bytes(&self) -> (usize, usize) {
        let dense = self.m_inverse.data.len() + self.mu.data.len();
        (self.factor.bytes(), 8 * dense)
    }
}

/// The dofs of the border: the vertices, and a dof behind those of the subdomain for each average.
fn border(k: &Csr, vertices: &[u32], averages: usize) -> Vec<u32> {
    let multipliers = k.n() as u32..(k.n() + averages) as u32;
    vertices.iter().copied().chain(multipliers).collect()
}

/// [K, Q; Qᵀ, 0].
fn bordered(k: &Csr, averages: &[AverageVector]) -> Csr {
    let n = k.n();
    let mut columns: Vec<Vec<(u32, f64)>> = vec![Vec::new(); n];
    for (q, (dofs, entries)) in averages.iter().enumerate() {
        for (&i, &v) in dofs.iter().zip(entries) {
            columns[i as usize].push(((n + q) as u32, v));
        }
    }
    let more: usize = averages.iter().map(|a| a.0.len()).sum();
    let mut out = Csr {
        row_ptr: Vec::with_capacity(n + averages.len() + 1),
        col: Vec::with_capacity(k.nnz() + 2 * more),
        val: Vec::with_capacity(k.nnz() + 2 * more),
    };
    out.row_ptr.push(0);
    for (i, columns) in columns.iter().enumerate() {
        let (col, val) = k.row(i);
        out.col.extend_from_slice(col);
        out.val.extend_from_slice(val);
        out.col.extend(columns.iter().map(|c| c.0));
        out.val.extend(columns.iter().map(|c| c.1));
        out.row_ptr.push(out.col.len());
    }
    for (dofs, entries) in averages {
        let mut row: Vec<(u32, f64)> = dofs.iter().copied().zip(entries.iter().copied()).collect();
        row.sort_unstable_by_key(|e| e.0);
        out.col.extend(row.iter().map(|e| e.0));
        out.val.extend(row.iter().map(|e| e.1));
        out.row_ptr.push(out.col.len());
    }
    out
}
