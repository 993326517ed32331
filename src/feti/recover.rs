//! One solve: condensed loads, λ₀, the Krylov method, and the way back to displacements.
//!
//! ```text
//!     g = f_Γ − K_ΓI K_II⁻¹ f_I
//!     r₀ = Pᵀ (B S̃⁺(g − Bᵀ λ₀) − c)          λ = λ₀ + P x,   Pᵀ F P x = r₀
//!     u_Γ = S̃⁺(g − Bᵀ λ) + R α               u_I by back substitution
//! ```

use std::time::Instant;

use super::dual::Dual;
use super::exchange::{max_all, min_all, sum_all};
use super::spectrum::Spectrum;
use super::stiffness::Work;
use crate::petsc::{ConvergedReason, Ksp, Session, Vec as PetscVec};
use crate::substructures::Substructures;
use crate::Result;

/// A first residual below this fraction of the displacements it was formed from is rounding: nothing is left to iterate on.
const ROUNDING: f64 = 1e-14;

/// How well the optimality conditions hold, relative to the sizes of their terms.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Kkt {
    /// ‖K u − f + Bᵀ λ‖ / (‖f‖ + ‖Bᵀ λ‖) in the norm of diag(K)⁻¹, in which stiff and soft parts count alike; residuals of
    /// primal dofs are summed over their copies.
    pub stationarity: f64,
    /// Largest violation of B u = c (≤ c) over the largest |u|.
    pub feasibility: f64,
    /// Largest |λ_r (B u − c)_r| over inequality rows, relative to max |λ| · max |u|; zero without inequality rows.
    pub complementarity: f64,
    /// Smallest multiplier of an inequality row, relative to max |λ|; zero without inequality rows.
    pub min_multiplier: f64,
}

/// What a solve returns; vectors are this rank's part.
#[derive(Debug, Clone)]
pub struct Solution {
    /// Displacements of each local subdomain, by local dof; copies inside a body agree.
    pub u: Vec<Vec<f64>>,
    /// Multipliers of the rows that this rank owns.
    pub lambda: Vec<f64>,
    /// Krylov iterations.
    pub iterations: usize,
    /// Whether the Krylov method reached its tolerance.
    pub converged: bool,
    /// Why it stopped, by PETSc's name.
    pub reason: String,
    /// ‖r_n‖₂ for n = 0, 1, …
    pub residuals: Vec<f64>,
    /// The Krylov method's own estimate of the spectrum.
    pub estimate: Option<Spectrum>,
    /// Optimality.
    pub kkt: Kkt,
    /// ½ uᵀ K u − fᵀ u.
    pub energy: f64,
    /// Seconds of condensing, iterating.
    pub solve_seconds: f64,
    /// Seconds of the way back.
    pub recover_seconds: f64,
}

pub(super) fn solve(
    session: &Session,
    problem: &Substructures,
    dual: &Dual,
    ksp: &Ksp,
) -> Result<Solution> {
    let clock = Instant::now();
    let stiffness = &dual.stiffness;
    let locals = &stiffness.locals;
    let condensed = stiffness
        .team
        .map(locals.len(), |j| locals[j].condense(&problem.local[j].f));
    let (interiors, g): (Vec<_>, Vec<_>) = condensed.into_iter().unzip();

    let lambda = dual.multipliers()?;
    dual.natural
        .initial(session, problem, stiffness, &g, &lambda)?;
    let mut work = stiffness.work();
    let residual = dual.multipliers()?;
    let size = displacements(dual, &g, &lambda, &mut work, &residual)?;
    let outcome = iterate(session, dual, ksp, &residual, size, &lambda)?;
    let solve_seconds = clock.elapsed().as_secs_f64();

    let clock = Instant::now();
    let u = back(session, dual, &g, interiors, &lambda, &mut work)?;
    let recover_seconds = clock.elapsed().as_secs_f64();
    let (kkt, energy) = certify(session, problem, dual, &u, &lambda)?;
    let lambda = lambda.to_vec()?;
    Ok(Solution {
        u,
        lambda,
        iterations: outcome.iterations,
        converged: outcome.reason.converged(),
        reason: outcome.reason.name,
        residuals: outcome.residuals,
        estimate: outcome.estimate,
        kkt,
        energy,
        solve_seconds,
        recover_seconds,
    })
}

/// work.y ← S̃⁺(g − Bᵀ λ), residual ← B y − c; returns ‖y‖ over all ranks.
fn displacements(
    dual: &Dual,
    g: &[Vec<f64>],
    lambda: &PetscVec,
    work: &mut [Work],
    residual: &PetscVec,
) -> Result<f64> {
    let stiffness = &dual.stiffness;
    let mut ghost = vec![0.0; stiffness.jump.ghosts.len()];
    stiffness.dual_halo.fetch(lambda, &mut ghost)?;
    let columns = &stiffness.jump.columns;
    stiffness.team.for_each(work, |j, w| {
        columns[j].b_transpose(&ghost, &mut w.v); /*      v ← Bᵀ λ          */
        for (v, g) in w.v.iter_mut().zip(&g[j]) {
            *v = g - *v; /*                               v ← g − v         */
        }
    });
    stiffness.s_plus(work)?; /*                           y ← S̃⁺ v          */
    stiffness.jump_of(work, residual)?; /*                r ← B y − c       */
    let mut r = residual.array_mut()?;
    let rows = stiffness.jump.gap.iter().zip(&stiffness.jump.active);
    for (r, (c, on)) in r.iter_mut().zip(rows) {
        *r -= if *on { *c } else { 0.0 };
    }
    let norm: f64 = work.iter().flat_map(|w| &w.y).map(|y| y * y).sum();
    Ok(norm)
}

struct Outcome {
    iterations: usize,
    reason: ConvergedReason,
    residuals: Vec<f64>,
    estimate: Option<Spectrum>,
}

/// Adds the Krylov method's correction to `lambda`.
fn iterate(
    session: &Session,
    dual: &Dual,
    ksp: &Ksp,
    residual: &PetscVec,
    size: f64,
    lambda: &PetscVec,
) -> Result<Outcome> {
    dual.p_transpose(residual)?;
    let mut size = [size];
    sum_all(session.comm(), &mut size);
    let start = residual.norm2()?;
    if start <= ROUNDING * size[0].sqrt() {
        return Ok(Outcome {
            iterations: 0,
            reason: ConvergedReason {
                code: 1,
                name: "CONVERGED_NOTHING_TO_DO".into(),
            },
            residuals: vec![start],
            estimate: None,
        });
    }
    let x = dual.multipliers()?;
    ksp.record_residuals(ksp.tolerances()?.3.min(100_000) + 1)?;
    ksp.solve(residual, &x)?;
    dual.p(&x)?;
    lambda.axpy(1.0, &x)?;
    let iterations = ksp.iterations()?;
    let estimate = estimate(ksp, iterations)?;
    Ok(Outcome {
        iterations,
        reason: ksp.converged_reason()?,
        residuals: ksp.residual_history()?,
        estimate,
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

/// u of every local subdomain from λ.
fn back(
    session: &Session,
    dual: &Dual,
    g: &[Vec<f64>],
    interiors: Vec<Vec<f64>>,
    lambda: &PetscVec,
    work: &mut [Work],
) -> Result<Vec<Vec<f64>>> {
    let (stiffness, natural) = (&dual.stiffness, &dual.natural);
    let jump = dual.multipliers()?;
    displacements(dual, g, lambda, work, &jump)?;
    let alpha = natural.alpha(session.comm(), &jump)?;
    for (j, w) in work.iter_mut().enumerate() {
        natural.add_kernel(j, &alpha, &mut w.y); /*      u ← y + R α         */
    }

    // What is left of the jumps inside a body is averaged away: u ← u − B_D,locᵀ B_loc u.
    stiffness.jump_of(work, &jump)?;
    jump.array_mut()?[stiffness.jump.n_owned_local..].fill(0.0);
    let mut ghost = vec![0.0; stiffness.jump.ghosts.len()];
    stiffness.dual_halo.fetch(&jump, &mut ghost)?;
    let columns = &stiffness.jump.columns;
    stiffness.team.for_each(work, |j, w| {
        columns[j].bd_transpose(&ghost, &mut w.v);
        for (y, v) in w.y.iter_mut().zip(&w.v) {
            *y -= v;
        }
    });
    let mut parts: Vec<Vec<f64>> = interiors;
    let (work, locals) = (&*work, &stiffness.locals);
    stiffness.team.for_each(&mut parts, |j, part| {
        let interior = std::mem::take(part);
        *part = locals[j].recover(interior, &work[j].y);
    });
    Ok(parts)
}

/// The optimality conditions of (u, λ), and the energy.
fn certify(
    session: &Session,
    problem: &Substructures,
    dual: &Dual,
    u: &[Vec<f64>],
    lambda: &PetscVec,
) -> Result<(Kkt, f64)> {
    let comm = session.comm();
    let stiffness = &dual.stiffness;
    let jump = &stiffness.jump;
    let mut ghost = vec![0.0; jump.ghosts.len()];
    stiffness.dual_halo.fetch(lambda, &mut ghost)?;

    // [Σ r²/d, Σ f²/d, Σ (Bᵀλ)²/d, energy] with d = diag(K); residuals and d of primal dofs, to be summed over copies
    let mut sums = [0.0; 4];
    let mut primal = vec![0.0; stiffness.space.ghosts.len()];
    let mut primal_d = primal.clone();
    let mut work = stiffness.work();
    for (j, sub) in problem.local.iter().enumerate() {
        let local = &stiffness.locals[j];
        let mut r = vec![0.0; sub.k.n()];
        sub.k.mul(&u[j], &mut r);
        let products = u[j].iter().zip(&r).zip(&sub.f);
        sums[3] += products.map(|((u, ku), f)| u * (0.5 * ku - f)).sum::<f64>();
        let d: Vec<f64> = (0..sub.k.n()).map(|i| sub.k.get(i, i)).collect();
        sums[1] += sub.f.iter().zip(&d).map(|(f, d)| f * f / d).sum::<f64>();
        r.iter_mut().zip(&sub.f).for_each(|(r, f)| *r -= f);
        jump.columns[j].b_transpose(&ghost, &mut work[j].v);
        for (&i, v) in local.interface.iter().zip(&work[j].v) {
            r[i as usize] += v;
            sums[2] += v * v / d[i as usize];
        }
        for (p, &i) in local.interface[local.n_delta..].iter().enumerate() {
            let at = stiffness.space.of_subdomain[j][p] as usize;
            primal[at] += r[i as usize];
            primal_d[at] += d[i as usize];
            r[i as usize] = 0.0;
        }
        sums[0] += r.iter().zip(&d).map(|(r, d)| r * r / d).sum::<f64>();
        for (y, &i) in work[j].y.iter_mut().zip(&local.interface) {
            *y = u[j][i as usize];
        }
    }
    sum_all(comm, &mut sums);
    let primal = stiffness.primal.weighted_square(&primal, &primal_d)?;
    let stationarity = (sums[0] + primal).sqrt() / positive(sums[1].sqrt() + sums[2].sqrt());

    let gaps = dual.multipliers()?;
    stiffness.jump_of(&work, &gaps)?;
    let (gaps, lambda) = (gaps.array()?, lambda.array()?);
    let mut largest = [0.0f64; 4]; // |u|, |λ|, violation, |λ (Bu − c)|
    let mut smallest = [0.0f64];
    largest[0] = u.iter().flatten().fold(0.0, |a, v| a.max(v.abs()));
    for r in (0..jump.n_owned).filter(|&r| jump.active[r]) {
        let violation = gaps[r] - jump.gap[r];
        largest[1] = largest[1].max(lambda[r].abs());
        if jump.inequality[r] {
            largest[2] = largest[2].max(violation);
            largest[3] = largest[3].max((lambda[r] * violation).abs());
            smallest[0] = smallest[0].min(lambda[r]);
        } else {
            largest[2] = largest[2].max(violation.abs());
        }
    }
    max_all(comm, &mut largest);
    min_all(comm, &mut smallest);
    let [u_max, lambda_max, violation, product] = largest;
    let kkt = Kkt {
        stationarity,
        feasibility: violation / positive(u_max),
        complementarity: product / positive(lambda_max * u_max),
        min_multiplier: smallest[0] / positive(lambda_max),
    };
    Ok((kkt, sums[3]))
}

/// A divisor: one in place of zero, for problems without load.
fn positive(x: f64) -> f64 {
    if x > 0.0 {
        x
    } else {
        1.0
    }
}
