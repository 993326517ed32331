//! Loads, condensed to the interfaces of the subdomains.
//!
//! ```text
//!     g = f_Γ − K_ΓI K_II⁻¹ f_I,      e = Rᵀ g
//! ```

use crate::feti::operators::dual::Dual;
use crate::feti::projector::balance::KernelLoad;
use crate::feti::subdomain::scaled::ScaledSubdomain;
use crate::substructures::Problem;
use crate::Result;
use cholesky::lanes::LANES;
use parallel::exchange::highest;

/// The data of the right-hand side of the dual problem.
#[derive(Clone)]
pub struct Loads {
    /// K_II⁻¹ f_I of each local subdomain, as [`ScaledSubdomain::condense_many`] leaves it.
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
    pub fn new(problem: &Problem, dual: &Dual) -> Loads {
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
            ScaledSubdomain::condense_many(locals, &loads)
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

    /// g and e of these loads of the problem with multipliers of rows that do not hold, which load the bodies with −Bᵀ
    /// λ. Collective.
    ///
    /// # Errors
    /// PETSc's own.
    pub fn with_multipliers(
        &self,
        problem: &Problem,
        dual: &Dual,
        lambda: &[f64],
    ) -> Result<(Vec<Vec<f64>>, KernelLoad)> {
        let stiffness = &dual.stiffness;
        let multipliers = dual.multipliers()?;
        multipliers.array_mut()?.copy_from_slice(lambda);
        let mut ghost = vec![0.0; stiffness.jump.ghosts.len()];
        stiffness.dual_halo.fetch(&multipliers, &mut ghost)?;
        let mut g = self.g.clone();
        for (j, g) in g.iter_mut().enumerate() {
            let mut v = vec![0.0; g.len()];
            stiffness.jump.columns.of(j).b_transpose_all(&ghost, &mut v);
            g.iter_mut().zip(&v).for_each(|(g, v)| *g -= v);
        }
        let f: Vec<&[f64]> = problem.local.iter().map(|s| &s.f[..]).collect();
        let kernel = dual.natural.kernel_load(dual.comm(), &f, &g);
        Ok((g, kernel))
    }

    /// K_II⁻¹ f_I of local subdomain `j`, zero on Γ.
    pub fn inside(&self, locals: &[ScaledSubdomain], j: usize) -> Vec<f64> {
        let local = &locals[j];
        let still = vec![0.0; local.gamma().n_gamma()];
        ScaledSubdomain::recover_many(&[local], &[(&self.interiors[j], &still)]).concat()
    }

    /// The largest displacement inside subdomains while their interfaces stay where they are. Collective.
    pub fn largest_inside(&self, dual: &Dual) -> f64 {
        let locals = &dual.stiffness.locals;
        let largest = dual.stiffness.team.map(locals.len(), |j| {
            let u = self.inside(locals, j);
            u.iter().fold(0.0f64, |a, u| a.max(u.abs()))
        });
        highest(dual.comm(), largest.into_iter().fold(0.0, f64::max))
    }
}
