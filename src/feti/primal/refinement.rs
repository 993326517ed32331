//! S_Π⁺ in bodies whose coefficients jump, to the accuracy of the subdomains' own matrices.
//!
//! A stiff subdomain among soft ones is held by the difference of large entries of the assembled S_Π. With jumps of
//! 1e12 that difference has four digits left. The unassembled Σ_j have all digits: Σ_j annihilates the rigid motions of
//! its subdomain. Once it does so exactly, the total force on the subdomain comes from its neighbours alone. The system
//! is therefore solved with the assembled matrix, and residuals are formed with the Σ_j:
//!
//! ```text
//!     c ← c + S_Π⁺ ( b − Σ_j R_jᵀ Π_j Σ_j Π_j R_j c ),    Π_j = I − N_j N_jᵀ
//! ```

use super::space::PrimalSpace;
use crate::feti::subdomain::scaled::ScaledSubdomain;
use crate::substructures::{Problem, Subdomain};
use base::linalg::dense::Dense;

/// Largest ratio of coefficients in a body up to which the assembled matrix is accurate enough.
pub const PLAIN: f64 = 1e3;

/// Number of corrections after the first solve. Each reduces the error by a factor of about (jump · 1e-14).
pub const STEPS: usize = 2;

/// An entry of Σ_j N below this part of its terms is zero.
const FREE: f64 = 1e-9;

/// N_j of each local subdomain: its rigid motions as orthonormal columns, n_Π rows; no columns if the subdomain is
/// held.
pub struct PrimalRefinement {
    motions: Vec<Dense>,
}

impl PrimalRefinement {
    /// The rigid motions at the primal dofs.
    pub fn new(problem: &Problem, locals: &[ScaledSubdomain]) -> PrimalRefinement {
        let pairs = problem.local.iter().zip(locals);
        PrimalRefinement {
            motions: pairs.map(|(sub, l)| motions(sub, l)).collect(),
        }
    }

    /// r ← r − Σ_j R_jᵀ Π_j Σ_j Π_j R_j c, all at this rank's ghosts.
    pub fn subtract(
        &self,
        space: &PrimalSpace,
        locals: &[ScaledSubdomain],
        c: &[f64],
        r: &mut [f64],
    ) {
        let mut force = Vec::new();
        for ((places, local), n) in space.of_subdomain.iter().zip(locals).zip(&self.motions) {
            let mut x: Vec<f64> = places.iter().map(|&g| c[g as usize]).collect();
            remove(n, &mut x); /*                               x ← Π R c       */
            force.clear();
            force.resize(x.len(), 0.0);
            local.sigma().add_mul(&x, &mut force); /*    f ← Σ x         */
            remove(n, &mut force); /*                           f ← Π f         */
            for (&g, f) in places.iter().zip(&force) {
                r[g as usize] -= f;
            }
        }
    }
}

/// x ← x − N Nᵀ x, applied twice for the digits.
fn remove(n: &Dense, x: &mut [f64]) {
    for _ in 0..2 {
        for k in 0..n.cols {
            let along: f64 = n.col(k).iter().zip(&*x).map(|(n, x)| n * x).sum();
            x.iter_mut()
                .zip(n.col(k))
                .for_each(|(x, n)| *x -= along * n);
        }
    }
}

fn motions(sub: &Subdomain, local: &ScaledSubdomain) -> Dense {
    let n_pi = local.gamma().n_pi();
    let mut out = Dense::zeros(n_pi, 0);
    for column in sub.near_kernel.iter().flatten() {
        let on_gamma = local.gamma().interface.iter().map(|&i| column[i as usize]);
        let mut x = local.gamma().primal_values(&on_gamma.collect::<Vec<f64>>());
        let before: f64 = x.iter().map(|v| v * v).sum();
        remove(&out, &mut x);
        let after: f64 = x.iter().map(|v| v * v).sum();
        // Different rigid motions may agree at the few primal dofs of a subdomain. Such motions count once.
        if after <= 1e-12 * before {
            continue;
        }
        x.iter_mut().for_each(|v| *v /= after.sqrt());
        if is_free(&local.sigma(), &x) {
            out.data.extend(&x);
            out.cols += 1;
        }
    }
    out
}

/// Whether every entry of Σ x is rounding.
fn is_free(sigma: &Dense, x: &[f64]) -> bool {
    (0..sigma.rows).all(|i| {
        let terms = (0..sigma.cols).map(|j| sigma.get(i, j) * x[j]);
        let (sum, size) = terms.fold((0.0, 0.0), |(s, a): (f64, f64), t| (s + t, a + t.abs()));
        sum.abs() <= FREE * size
    })
}
