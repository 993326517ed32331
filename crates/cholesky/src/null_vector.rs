//! Null vectors of a semidefinite matrix, from its factor.
//!
//! Let k be a dof that [`PartialCholesky::semidefinite`] has left out, J the others before it. With A_JJ = L_JJ L_JJᵀ
//! and the row l = A_kJ L_JJ⁻ᵀ of the factor,
//!
//! ```text
//!     v_k = 1,   v_J = −A_JJ⁻¹ A_Jk = −L_JJ⁻ᵀ lᵀ,   0 elsewhere
//! ```
//!
//! is half a solve, from k downwards. Where v vanishes on all rows of a front nothing is done: the vector of a small
//! part of a large system costs little.

use super::multifrontal::PartialCholesky;
use super::panel;
use super::symbolic::Front;

/// Entries below this, relative to the largest one, are rounding: they are not followed.
const NOTHING: f64 = 1e-13;

impl PartialCholesky {
    /// The vector v with A v = 0 and v_k = 1 that vanishes on the other dofs that are left out: (dof, entry), by
    /// increasing dof.
    #[cfg(test)]
    fn null_vector(&self, k: u32) -> Vec<(u32, f64)> {
        let symbolic = &*self.symbolic;
        let start = symbolic.position[k as usize] as usize;
        let mut v = vec![0.0; symbolic.n_interior()];
        v[start] = 1.0;
        self.substitute_null(&mut v, start, &mut 1.0, symbolic.fronts.iter().rev());
        let entries = symbolic.interior.iter().copied().zip(v);
        let mut out: Vec<(u32, f64)> = entries.filter(|e| e.1 != 0.0).collect();
        out.sort_by_key(|e| e.0);
        out
    }

    /// Completes v, in the order of elimination, on the rows of these fronts before row `start`, which is that of k.
    /// Parents come before their children, and v is known on the rows below the fronts. `largest` is the largest entry
    /// so far.
    pub(super) fn substitute_null<'a>(
        &self,
        v: &mut [f64],
        start: usize,
        largest: &mut f64,
        fronts: impl Iterator<Item = &'a Front>,
    ) {
        let mut rows: Vec<(usize, f64)> = Vec::new();
        for front in fronts.filter(|f| f.start <= start) {
            let (width, size) = (front.width(), front.size());
            // The rows of the front on which v does not vanish, those that come last first.
            rows.clear();
            for (l, &p) in front.below.iter().enumerate().rev() {
                if v[p as usize] != 0.0 {
                    rows.push((width + l, v[p as usize]));
                }
            }
            let end = if front.end > start { start } else { front.end };
            if end < front.end {
                rows.push((end - front.start, 1.0));
            }
            if rows.is_empty() {
                continue;
            }
            let entries = &self.panels[front.panel..];
            for j in (0..end - front.start).rev() {
                let terms = rows.iter();
                let sum: f64 = terms
                    .map(|&(i, x)| entries[panel::entry(i, j, width, size)] * x)
                    .sum();
                let x = -sum / entries[panel::diagonal(j, width, size)];
                if x.abs() > NOTHING * *largest {
                    *largest = largest.max(x.abs());
                    v[front.start + j] = x;
                    rows.push((j, x));
                }
            }
        }
    }
}

#[cfg(test)]
#[path = "../tests/null_vector.rs"]
mod tests;
