//! The largest eigenvalues of several pencils at once. The Krylov spaces of all bodies grow in step, and each body has
//! its own Rayleigh–Ritz problem.
//!
//! Bases are orthonormal in F_i. Two start vectors find eigenvalues of multiplicity two at once; eigenvalues of higher
//! multiplicity follow later. `settled` says when the search of a body stops.

use std::ops::Range;

use crate::Result;

/// Several pencils (F, M⁻¹). A vector holds the entries of the first pencil, then those of the second, and so on.
pub trait Pencils {
    /// The entries of each pencil on this rank.
    fn parts(&self) -> &[Range<usize>];

    /// A number that identifies entry `i` within its pencil over all ranks.
    fn row(&self, i: usize) -> u64;

    /// F v. Collective.
    fn f(&self, v: &[f64]) -> Result<Vec<f64>>;

    /// P M⁻¹ v. The vector v must be a result of [`jump_part`](Pencils::jump_part). Collective.
    fn m(&self, v: &[f64]) -> Result<Vec<f64>>;

    /// v ← Pᵀ v. Collective.
    fn jump_part(&self, v: &mut Vec<f64>) -> Result<()>;

    /// Sums over the ranks. Collective.
    fn sum(&self, values: &mut [f64]);

    /// Number of entries of a vector on this rank.
    fn n(&self) -> usize {
        self.parts().last().map_or(0, |p| p.end)
    }

    /// This rank's share of aᵀ b for each pencil.
    fn dots(&self, a: &[f64], b: &[f64]) -> Vec<f64> {
        let dot = |part: &Range<usize>| {
            let pairs = a[part.clone()].iter().zip(&b[part.clone()]);
            pairs.map(|(a, b)| a * b).sum()
        };
        self.parts().iter().map(dot).collect()
    }

    /// y ← y + α x with one α for each pencil.
    fn add(&self, alpha: &[f64], x: &[f64], y: &mut [f64]) {
        for (part, &alpha) in self.parts().iter().zip(alpha) {
            if alpha != 0.0 {
                let pairs = y[part.clone()].iter_mut().zip(&x[part.clone()]);
                pairs.for_each(|(y, x)| *y += alpha * x);
            }
        }
    }
}

/// Number of start vectors.
const STARTS: usize = 2;

/// Number of vectors that are expanded before the Rayleigh–Ritz problem of a body is solved for the first time.
const FIRST: usize = 5;

/// Largest number of expanded vectors of a body, besides three for each vector above τ.
const PATIENCE: usize = 60;

/// A part of a vector below this, relative to the vector, is rounding after orthogonalisation.
const ROUNDING: f64 = 1e-10;

/// Result of the search for one body.
#[derive(Debug, Default, Clone)]
pub struct TopOfPencil {
    /// Ritz values above τ, the largest first.
    pub theta: Vec<f64>,
    /// Their coefficients in the basis.
    y: Vec<Vec<f64>>,
    /// Whether the cap cuts off vectors above τ, or the vectors have not settled.
    pub capped: bool,
    done: bool,
}

/// An F-orthonormal basis of each body.
struct KrylovBasis {
    q: Vec<Vec<f64>>,
    fq: Vec<Vec<f64>>,
    /// h[s][k][body] = q_kᵀ F M⁻¹ F q_s for the expanded s, with k up to the number of vectors after the expansion.
    h: Vec<Vec<Vec<f64>>>,
}

/// Finds the vectors above `tau` of every pencil, at most `most` of each, and calls `visit(which, μ, F μ)` for each of
/// them, the largest θ first. Collective.
pub fn top(
    pencil: &impl Pencils,
    tau: f64,
    most: usize,
    mut visit: impl FnMut(usize, &[f64], &[f64]),
) -> Result<Vec<TopOfPencil>> {
    let n = pencil.parts().len();
    let mut found = vec![TopOfPencil::default(); n];
    let mut basis = KrylovBasis {
        q: Vec::new(),
        fq: Vec::new(),
        h: Vec::new(),
    };
    for start in 0..STARTS {
        let mut v = noise(pencil, start);
        pencil.jump_part(&mut v)?;
        let v = pencil.m(&v)?;
        basis.append(pencil, v)?;
    }
    while found.iter().any(|f| !f.done) && basis.h.len() < basis.q.len() {
        basis.expand(pencil, &found)?;
        if basis.h.len() >= FIRST {
            for (s, body) in found.iter_mut().enumerate().filter(|f| !f.1.done) {
                basis.judge(s, tau, most, body);
            }
        }
    }
    let combine = |of: &[Vec<f64>], y: &[f64], part: &Range<usize>| {
        let mut out = vec![0.0; pencil.n()];
        for (v, &c) in of.iter().zip(y) {
            let pairs = out[part.clone()].iter_mut().zip(&v[part.clone()]);
            pairs.for_each(|(o, v)| *o += c * v);
        }
        out
    };
    for (s, body) in found.iter().enumerate() {
        let part = &pencil.parts()[s];
        for y in &body.y {
            visit(s, &combine(&basis.q, y, part), &combine(&basis.fq, y, part));
        }
    }
    Ok(found)
}

impl KrylovBasis {
    /// Applies the operator to the next vector, orthogonalises the image and adds it to the basis.
    fn expand(&mut self, pencil: &impl Pencils, found: &[TopOfPencil]) -> Result<()> {
        let s = self.h.len();
        let mut v = self.fq[s].clone();
        // Bodies that have settled are not expanded further.
        for (part, _) in pencil.parts().iter().zip(found).filter(|p| p.1.done) {
            v[part.clone()].fill(0.0);
        }
        pencil.jump_part(&mut v)?;
        let z = pencil.m(&v)?;
        let h = self.append(pencil, z)?;
        self.h.push(h);
        Ok(())
    }

    /// Orthonormalises `v` against the basis and adds it; returns the coefficients. Collective.
    fn append(&mut self, pencil: &impl Pencils, mut v: Vec<f64>) -> Result<Vec<Vec<f64>>> {
        let n = pencil.parts().len();
        let mut h = vec![vec![0.0; n]; self.q.len()];
        for _ in 0..2 {
            let mut sums: Vec<f64> = self.fq.iter().flat_map(|f| pencil.dots(f, &v)).collect();
            pencil.sum(&mut sums);
            for ((q, c), h) in self.q.iter().zip(sums.chunks(n)).zip(&mut h) {
                let minus: Vec<f64> = c.iter().map(|c| -c).collect();
                pencil.add(&minus, q, &mut v);
                h.iter_mut().zip(c).for_each(|(h, c)| *h += c);
            }
        }
        let mut fv = pencil.f(&v)?;
        let mut square = pencil.dots(&v, &fv);
        pencil.sum(&mut square);
        let mut beta = vec![0.0; n];
        for (s, part) in pencil.parts().iter().enumerate() {
            let before: f64 = h.iter().map(|h| h[s] * h[s]).sum::<f64>() + square[s].max(0.0);
            let left = square[s] > ROUNDING * ROUNDING * before;
            let scale = if left { square[s].sqrt().recip() } else { 0.0 };
            beta[s] = if left { square[s].sqrt() } else { 0.0 };
            for i in part.clone() {
                v[i] *= scale;
                fv[i] *= scale;
            }
        }
        h.push(beta);
        self.q.push(v);
        self.fq.push(fv);
        Ok(h)
    }

    /// The Rayleigh–Ritz problem of body `s` over the expanded vectors.
    fn judge(&self, s: usize, tau: f64, most: usize, body: &mut TopOfPencil) {
        let m = self.h.len();
        let entry = |i: usize, j: usize| self.h[j].get(i).map_or(0.0, |h| h[s]);
        let a = faer::Mat::from_fn(m, m, |i, j| 0.5 * (entry(i, j) + entry(j, i)));
        let eigen = a
            .self_adjoint_eigen(faer::Side::Lower)
            .expect("eigenvalues of a small symmetric finite matrix converge");
        let theta = eigen.S().column_vector();
        let residual = |k: usize| {
            let beyond = (m..self.q.len()).map(|l| {
                let terms = (0..m).map(|j| entry(l, j) * eigen.U()[(j, k)]);
                terms.sum::<f64>().powi(2)
            });
            beyond.sum::<f64>().sqrt()
        };
        let pairs: Vec<(f64, f64)> = (0..m).rev().map(|k| (theta[k], residual(k))).collect();
        let above = pairs.iter().take_while(|p| p.0 > tau).count();
        let tired = m >= PATIENCE + 3 * above;
        if !settled(&pairs, above, tau) && !tired && above <= most {
            return;
        }
        body.done = true;
        body.capped = above > most || (tired && !settled(&pairs, above, tau));
        body.theta = pairs[..above.min(most)].iter().map(|p| p.0).collect();
        let vector = |k: usize| (0..m).map(|j| eigen.U()[(j, m - 1 - k)]).collect();
        body.y = (0..body.theta.len()).map(vector).collect();
    }
}

/// Whether the Ritz vectors above τ are accurate enough to be deflated. `pairs` has (θ, residual) in decreasing order
/// of θ.
///
/// Deflation with Ritz vectors instead of exact ones leaves at most Σ r²/θ more in the rest of the pencil. The largest
/// value below τ must have converged well enough to be trusted.
fn settled(pairs: &[(f64, f64)], above: usize, tau: f64) -> bool {
    let rest: f64 = pairs[..above].iter().map(|(t, r)| r * r / t).sum();
    let next = pairs
        .get(above)
        .is_none_or(|(t, r)| t + r <= tau || *r <= 0.2 * t);
    rest <= 0.1 * tau && next
}

/// A start vector: numbers without pattern that depend on the rows alone, so that every distribution over ranks starts
/// alike.
fn noise(pencil: &impl Pencils, start: usize) -> Vec<f64> {
    let value = |i: usize| {
        let mut x = (pencil.row(i) + 1) ^ ((start as u64 + 1) << 48);
        for _ in 0..2 {
            x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        }
        (x >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    (0..pencil.n()).map(value).collect()
}
