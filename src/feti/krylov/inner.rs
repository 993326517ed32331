//! The inner problem: condensed loads, residuals, and the Krylov method that corrects λ.
//!
//! ```text
//!     g = f_Γ − K_ΓI K_II⁻¹ f_I
//!     r = B S̃⁺(g − Bᵀ λ) − c                 λ ← λ + P x,   Pᵀ F P x = Pᵀ r
//! ```

use super::spectrum::Spectrum;
use super::tally::Start;
use crate::cholesky::lanes::LANES;
use crate::feti::operators::dual::Dual;
use crate::feti::operators::stiffness::Work;
use crate::feti::projector::natural::KernelLoad;
use crate::parallel::exchange::{max_all, sum_all};
use crate::petsc::{ConvergedReason, Ksp, Session, Vec as PetscVec};
use crate::substructures::Substructures;
use crate::Result;

/// A residual below this fraction of the displacements it was formed from is rounding: nothing is left to iterate on.
pub const ROUNDING: f64 = 1e-14;

/// An iteration is not broken off any more when its residual is less than this many times what it is to end with.
const NEARLY: f64 = 30.0;

/// The loads, condensed to the interfaces of the subdomains.
pub struct Loads {
    /// K_II⁻¹ f_I of each local subdomain, as [`LocalProblem::condense`](crate::feti::subdomain::problem::LocalProblem) leaves it.
    pub interiors: Vec<Vec<f64>>,
    /// g of each local subdomain, length n_Γ.
    pub g: Vec<Vec<f64>>,
    /// e = Rᵀ g.
    pub kernel: KernelLoad,
}

impl Loads {
    /// Condenses the loads of the problem. Collective.
    pub fn new(session: &Session, problem: &Substructures, dual: &Dual) -> Loads {
        let f: Vec<&[f64]> = problem.local.iter().map(|s| &s.f[..]).collect();
        Loads::of(session, dual, &f)
    }

    /// Condenses given loads, one vector for each local subdomain. Collective.
    pub fn of(session: &Session, dual: &Dual, f: &[&[f64]]) -> Loads {
        let stiffness = &dual.stiffness;
        let batches = stiffness.batches(LANES);
        let condensed = stiffness.by_batch(&batches, |locals, members| {
            let loads: Vec<&[f64]> = members.iter().map(|&j| f[j]).collect();
            locals[0].condense_many(&loads)
        });
        let (interiors, g): (Vec<_>, Vec<_>) = condensed.into_iter().unzip();
        let kernel = dual.natural.kernel_load(session.comm(), f, &g);
        Loads {
            interiors,
            g,
            kernel,
        }
    }
}

/// Displacements that belong to a λ, and what is left of the jumps.
pub struct Residual {
    /// y = S̃⁺(g − Bᵀ λ) on every local subdomain.
    pub work: Vec<Work>,
    /// B y − c on the rows that hold, zero on the others.
    pub r: PetscVec,
    /// ‖y‖₂ over all ranks.
    pub size: f64,
}

impl Residual {
    /// Room for one.
    pub fn new(dual: &Dual) -> Result<Residual> {
        Ok(Residual {
            work: dual.stiffness.work(),
            r: dual.multipliers()?,
            size: 0.0,
        })
    }

    /// Computes it for `lambda`. Collective.
    pub fn evaluate(
        &mut self,
        session: &Session,
        dual: &Dual,
        loads: &Loads,
        lambda: &PetscVec,
    ) -> Result<()> {
        let stiffness = &dual.stiffness;
        let mut ghost = vec![0.0; stiffness.jump.ghosts.len()];
        stiffness.dual_halo.fetch(lambda, &mut ghost)?;
        let columns = &stiffness.jump.columns;
        stiffness.team.for_each(&mut self.work, |j, w| {
            columns[j].b_transpose(&ghost, &mut w.v); /*      v ← Bᵀ λ          */
            for (v, g) in w.v.iter_mut().zip(&loads.g[j]) {
                *v = g - *v; /*                               v ← g − v         */
            }
        });
        stiffness.s_plus(&mut self.work)?; /*                 y ← S̃⁺ v          */
        self.close(session, dual)
    }

    /// r ← B y − c and the size of y, for the y that is there. Collective.
    fn close(&mut self, session: &Session, dual: &Dual) -> Result<()> {
        let stiffness = &dual.stiffness;
        stiffness.jump_of(&self.work, &self.r)?; /*           r ← B y − c       */
        {
            let mut r = self.r.array_mut()?;
            let rows = stiffness.jump.held.iter().zip(&stiffness.jump.active);
            for (r, (c, on)) in r.iter_mut().zip(rows) {
                *r -= if *on { *c } else { 0.0 };
            }
        }
        let mut norm = [self.work.iter().flat_map(|w| &w.y).map(|y| y * y).sum()];
        sum_all(session.comm(), &mut norm);
        self.size = norm[0].sqrt();
        Ok(())
    }

    /// Largest |y| on this rank.
    pub fn largest(&self) -> f64 {
        let y = self.work.iter().flat_map(|w| &w.y);
        y.fold(0.0, |a, y| a.max(y.abs()))
    }

    /// Largest |y| over all ranks. Collective.
    pub fn length(&self, session: &Session) -> f64 {
        let mut largest = [self.largest()];
        max_all(session.comm(), &mut largest);
        largest[0]
    }

    /// y ← y + R α for given α.
    pub fn shift(&mut self, dual: &Dual, alpha: &[f64]) {
        for (j, w) in self.work.iter_mut().enumerate() {
            dual.natural.add_kernel(j, alpha, &mut w.y);
        }
    }

    /// y ← y + R α with the rigid motions α that close the jumps of the rows that hold, as far as those allow. Collective.
    pub fn add_rigid_motion(&mut self, session: &Session, dual: &Dual) -> Result<()> {
        let alpha = dual.natural.alpha(session.comm(), &self.r)?;
        self.shift(dual, &alpha); /*                          y ← y + R α       */
        Ok(())
    }
}

/// The norm of the residual on `rows` rows to end with: relative to `reference`, that of Pᵀ r at λ₀, or to displacements as large as
/// `length`, 0 as long as they are not known, if that is less. Where stiff and soft bodies meet, λ₀ may stand for displacements far
/// larger than those of the solution; jumps are to be small beside these.
pub fn target(ksp: &Ksp, reference: f64, length: f64, rows: usize) -> Result<f64> {
    let (rtol, atol, _, _) = ksp.tolerances()?;
    let least = match length {
        length if length > 0.0 => reference.min(length * (rows as f64).sqrt()),
        _ => reference,
    };
    Ok((rtol * least).max(atol))
}

/// Whether a run down to `tolerance` was one to the end, where that turns out to be `target`.
pub fn to_the_end(tolerance: f64, target: f64) -> bool {
    tolerance <= 1.01 * target
}

/// What one run of the Krylov method did.
#[derive(Debug, Clone)]
pub struct Inner {
    /// Iterations.
    pub iterations: usize,
    /// Why it stopped.
    pub reason: ConvergedReason,
    /// ‖r_n‖₂ for n = 0, 1, …
    pub residuals: Vec<f64>,
    /// The method's own estimate of the spectrum.
    pub estimate: Option<Spectrum>,
    /// Whether the run was broken off because of large eigenvalues that are to be deflated.
    pub broken_off: bool,
}

impl Inner {
    fn nothing_to_do(residual: f64) -> Inner {
        Inner {
            iterations: 0,
            reason: ConvergedReason {
                code: 1,
                name: "CONVERGED_NOTHING_TO_DO".into(),
            },
            residuals: vec![residual],
            estimate: None,
            broken_off: false,
        }
    }

    /// Whether rounding ended the run after the residual had become less than `part` of what it was.
    pub fn broke_down(&self, part: f64) -> bool {
        let ends = (self.residuals.first(), self.residuals.last());
        let moved = matches!(ends, (Some(first), Some(last)) if *last < part * first);
        self.reason.broke_down() && moved
    }

    /// This run, broken off, and the one that went on from it with another preconditioner: the spectrum is that of the latter.
    pub fn followed_by(self, more: Inner) -> Inner {
        let mut residuals = self.residuals;
        residuals.extend(&more.residuals);
        Inner {
            iterations: self.iterations + more.iterations,
            residuals,
            ..more
        }
    }
}

/// Adds the Krylov method's correction to `lambda`; `residual` is Pᵀ r on entry, `size` the size of the displacements it comes
/// from. Stops at a residual of `target`.
pub fn iterate(
    dual: &Dual,
    ksp: &Ksp,
    residual: &PetscVec,
    size: f64,
    lambda: &PetscVec,
    target: f64,
) -> Result<Inner> {
    // Once more: what the first projection of a large jump leaves behind by rounding is out of reach for the iteration, which would
    // stall on it and go astray. Of the small residual that is left the second one leaves nothing to speak of.
    dual.p_transpose(residual)?;
    let start = residual.norm2()?;
    let nothing = (ROUNDING * size).max(target);
    if start <= nothing {
        return Ok(Inner::nothing_to_do(start));
    }
    // What range W has of the solution is known at once.
    dual.deflated_part(residual, lambda)?;
    let start = residual.norm2()?;
    if start <= nothing {
        return Ok(Inner::nothing_to_do(start));
    }
    dual.recycled_part(residual, lambda)?;
    let start = residual.norm2()?;
    if start <= nothing {
        return Ok(Inner::nothing_to_do(start));
    }
    let (rtol, atol, dtol, max_it) = ksp.tolerances()?;
    let rtol_of = |rtol| ksp.set_tolerances(Some(rtol), Some(atol), Some(dtol), Some(max_it));
    let x = dual.multipliers()?;
    ksp.record_residuals(max_it.min(100_000) + 1)?;
    rtol_of(target / start)?;
    dual.record_directions(true);
    let counted = Start::now();
    let solved = match dual.watch() {
        Some(limit) if ksp.type_name()? == "cg" => {
            ksp.solve_watched(residual, &x, dual.watched_from, limit, NEARLY * target)
        }
        _ => ksp.solve(residual, &x).map(|()| false),
    };
    dual.record_directions(false);
    rtol_of(rtol)?;
    let broken_off = solved?;
    let iterations = ksp.iterations()?;
    dual.count(&counted.since(iterations));
    dual.p(&x)?;
    dual.p2(&x)?;
    lambda.axpy(1.0, &x)?;
    let estimate = estimate(ksp, iterations)?;
    Ok(Inner {
        iterations,
        reason: ksp.converged_reason()?,
        residuals: ksp.residual_history()?,
        estimate,
        broken_off,
    })
}

/// The ends of the spectrum by CG's Lanczos matrix. Other methods' singular values are not eigenvalues, and FCG of PETSc 3.18
/// reads CG's data where it keeps its own.
fn estimate(ksp: &Ksp, iterations: usize) -> Result<Option<Spectrum>> {
    if ksp.type_name()? != "cg" || iterations == 0 {
        return Ok(None);
    }
    let (lambda_max, lambda_min) = ksp.extreme_singular_values()?;
    Ok((lambda_min > 0.0).then_some(Spectrum {
        lambda_min,
        lambda_max,
    }))
}
