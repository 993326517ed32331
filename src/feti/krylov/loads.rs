//! Loads, condensed to the interfaces of the subdomains.
//!
//! ```text
//!     g = f_Γ − K_ΓI K_II⁻¹ f_I,      e = Rᵀ g
//! ```

use crate::cholesky::lanes::LANES;
use crate::feti::operators::dual::Dual;
use crate::feti::projector::natural::KernelLoad;
use crate::feti::subdomain::scaled::Scaled;
use crate::substructures::Substructures;

/// The data of the right-hand side of the dual problem.
pub struct Loads {
    /// K_II⁻¹ f_I of each local subdomain, as [`Scaled::condense_many`] leaves it.
    pub interiors: Vec<Vec<f64>>,
    /// g of each local subdomain, length n_Γ.
    pub g: Vec<Vec<f64>>,
    /// e = Rᵀ g.
    pub kernel: KernelLoad,
    /// Right-hand sides on the owned rows that replace c; `None` keeps c.
    pub jumps: Option<Vec<f64>>,
}

impl Loads {
    /// Condenses the loads of the problem. Collective.
    pub fn new(problem: &Substructures, dual: &Dual) -> Loads {
        let f: Vec<&[f64]> = problem.local.iter().map(|s| &s.f[..]).collect();
        Loads::of(dual, &f, None)
    }

    /// Condenses given loads, one vector for each local subdomain. If `jumps` is given, the rows are B u = `jumps`.
    /// Collective.
    pub fn of(dual: &Dual, f: &[&[f64]], jumps: Option<Vec<f64>>) -> Loads {
        let stiffness = &dual.stiffness;
        let batches = stiffness.batches(LANES);
        let condensed = stiffness.by_batch(&batches, |locals, members| {
            let loads: Vec<&[f64]> = members.iter().map(|&j| f[j]).collect();
            Scaled::condense_many(locals, &loads)
        });
        let (interiors, g): (Vec<_>, Vec<_>) = condensed.into_iter().unzip();
        let kernel = dual.natural.kernel_load(dual.comm(), f, &g);
        Loads {
            interiors,
            g,
            kernel,
            jumps,
        }
    }
}
