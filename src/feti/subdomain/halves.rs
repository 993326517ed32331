//! T v + Ψ c of one subdomain in two halves: c = S_Π⁺ Ψᵀ v is known between them.
//!
//! Where Ψ is stored the first half multiplies by Ψᵀ, the second by T and Ψ. Where it is not, the first is the way
//! forward through the factor of K_rr, the second the way back: no more is read than T v alone would read.

use super::scaled::ScaledSubdomain;
use super::which::Operator;
use base::linalg::dense::Dense;
use cholesky::lanes::LANES;
use cholesky::reached::Ordered;

/// The result of the first half that the second goes on with, up to [`LANES`] loads side by side; empty where Ψ is
/// stored, and of loads that vanish.
#[derive(Debug, Clone, Default)]
pub struct Halfway(Vec<Ordered>);

impl ScaledSubdomain {
    /// Whether Ψ is not stored.
    pub fn in_halves(&self) -> bool {
        self.kind().in_halves().is_some()
    }

    /// Ψ on Δ, n_Δ × n_Π. Where it is not stored, it is built column by column once.
    pub fn psi(&self) -> &Dense {
        let stored = &self.gamma().psi;
        self.kind()
            .in_halves()
            .map_or(stored, |solves| solves.psi())
    }

    /// p ← Ψᵀ v, v on Γ, and the first half of [`finish`](Self::finish).
    pub fn begin(&self, v: &[f64], p: &mut [f64]) -> Halfway {
        let Some(solves) = self.kind().in_halves() else {
            self.gamma().psi_transpose(v, p);
            return Halfway::default();
        };
        p.fill(0.0);
        if v.iter().all(|v| *v == 0.0) {
            return Halfway::default();
        }
        // Nobody shares the factor: φ = 1.
        let (half, values) = solves.held().begin(&[v]);
        p.copy_from_slice(&values[0]);
        Halfway(vec![half])
    }

    /// y ← T v + Ψ c from the first half of v. Only where Ψ is not stored.
    pub fn finish(&self, half: Halfway, c: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        let Some(solves) = self.kind().in_halves() else {
            return;
        };
        let half = half.0.into_iter().next();
        if half.is_none() && c.iter().all(|c| *c == 0.0) {
            return;
        }
        let half = half.unwrap_or_else(|| solves.held().nothing(1));
        let done = solves.held().finish(half, &[c]);
        let (delta, vertices) = y.split_at_mut(self.gamma().n_delta);
        delta.copy_from_slice(&done[0]);
        vertices.copy_from_slice(&c[..vertices.len()]);
    }

    /// y ← y + Ψ c.
    pub fn add_psi(&self, c: &[f64], y: &mut [f64]) {
        if !self.in_halves() {
            return self.gamma().add_psi(c, y);
        }
        let mut own = vec![0.0; self.gamma().n_gamma()];
        self.finish(Halfway::default(), c, &mut own);
        y.iter_mut().zip(&own).for_each(|(y, own)| *y += own);
    }

    /// P ← Ψᵀ V for several loads, V on Γ, and the first half of [`finish_many`](Self::finish_many).
    pub fn begin_many(&self, v: &Dense, p: &mut Dense) -> Halfway {
        let Some(solves) = self.kind().in_halves() else {
            (0..v.cols).for_each(|c| self.gamma().psi_transpose(v.col(c), p.col_mut(c)));
            return Halfway::default();
        };
        let columns: Vec<&[f64]> = (0..v.cols).map(|c| v.col(c)).collect();
        let mut halves = Vec::new();
        for (k, some) in columns.chunks(LANES).enumerate() {
            let (half, values) = solves.held().begin(some);
            halves.push(half);
            for (c, values) in values.iter().enumerate() {
                p.col_mut(LANES * k + c).copy_from_slice(values);
            }
        }
        Halfway(halves)
    }

    /// Y ← T V + Ψ C on Γ.
    pub fn finish_many(&self, half: Halfway, v: &Dense, c: &Dense, y: &mut Dense) {
        let n = self.gamma().n_delta;
        let Some(solves) = self.kind().in_halves() else {
            let delta = Dense::from_fn(n, v.cols, |i, k| v.get(i, k));
            let mut done = Dense::zeros(n, v.cols);
            self.apply(Operator::T, &delta, &mut done);
            for k in 0..v.cols {
                y.col_mut(k).fill(0.0);
                y.col_mut(k)[..n].copy_from_slice(done.col(k));
                self.gamma().add_psi(c.col(k), y.col_mut(k));
            }
            return;
        };
        let columns: Vec<&[f64]> = (0..c.cols).map(|k| c.col(k)).collect();
        let chunks = half.0.into_iter().zip(columns.chunks(LANES));
        let done = chunks.flat_map(|(half, some)| solves.held().finish(half, some));
        for (k, done) in done.enumerate() {
            let (delta, vertices) = y.col_mut(k).split_at_mut(n);
            delta.copy_from_slice(&done);
            vertices.copy_from_slice(&c.col(k)[..vertices.len()]);
        }
    }
}
