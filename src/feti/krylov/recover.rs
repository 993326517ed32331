//! Solutions: the solve of a problem without inequalities, and the way back from multipliers to displacements.
//!
//! ```text
//!     u_Γ = S̃⁺(g − Bᵀ λ) + R α               u_I by back substitution
//! ```

use std::time::Instant;

use super::correction::TIGHT;
use super::inner::{iterate, target, to_the_end, Loads, Residual, ROUNDING};
use super::kkt::{certify, Kkt};
use super::spectrum::Spectrum;
use crate::cholesky::lanes::LANES;
use crate::contact::Step;
use crate::feti::operators::dual::Dual;
use crate::feti::solver::FetiFeti;
use crate::feti::subdomain::scaled::Local;
use crate::petsc::{Ksp, Session, Vec as PetscVec};
use crate::substructures::Substructures;
use crate::Result;

/// What a solve returns; vectors are this rank's part.
#[derive(Debug, Clone)]
pub struct Solution {
    /// Displacements of each local subdomain, by local dof; copies inside a body agree.
    pub u: Vec<Vec<f64>>,
    /// Multipliers of the rows that this rank owns.
    pub lambda: Vec<f64>,
    /// B u − c on these rows, those that do not hold included.
    pub gaps: Vec<f64>,
    /// Whether each of these rows holds at the end, those included that follow from others that do.
    pub active: Vec<bool>,
    /// Krylov iterations, of all steps of the contact loop.
    pub iterations: usize,
    /// Whether everything reached its tolerance.
    pub converged: bool,
    /// Why it stopped, by PETSc's name.
    pub reason: String,
    /// ‖r_n‖₂ for n = 0, 1, …; of the contact loop those of the last step that iterated.
    pub residuals: Vec<f64>,
    /// The Krylov method's own estimate of the spectrum, of the contact loop in the last step that iterated.
    pub estimate: Option<Spectrum>,
    /// Optimality.
    pub kkt: Kkt,
    /// ½ uᵀ K u − fᵀ u + λᵀ (B u − c).
    pub energy: f64,
    /// Seconds of condensing, iterating.
    pub solve_seconds: f64,
    /// Seconds of the way back.
    pub recover_seconds: f64,
    /// Steps of the contact loop; empty without inequalities.
    pub steps: Vec<Step>,
}

/// Looks at displacements that satisfy the tolerance; the factor by which the residual should fall further, or `None`.
pub type Judge<'a> = dyn Fn(&[Vec<f64>]) -> Result<Option<f64>> + 'a;

/// The judge is asked this many times at most.
const ASKED: usize = 8;

/// Solves with the rows that hold, as equations, until the tolerance is reached and `enough`, if there is one, is satisfied. Collective.
pub(crate) fn solve(solver: &FetiFeti, enough: Option<&Judge>) -> Result<Solution> {
    let (session, problem, ksp) = (solver.session(), solver.problem(), solver.ksp());
    let clock = Instant::now();
    let lambda;
    let mut residual;
    let (loads, reference, rows) = {
        let dual = solver.dual();
        let loads = Loads::new(session, problem, &dual);
        let natural = &dual.natural;
        natural.check_held(problem, &dual.stiffness, &loads.kernel)?;
        lambda = dual.multipliers()?;
        natural.balance(session.comm(), &loads.kernel, &lambda)?;
        residual = Residual::new(&dual)?;
        residual.evaluate(session, &dual, &loads, &lambda)?;
        dual.p_transpose(&residual.r)?;
        (loads, residual.r.norm2()?, dual.stiffness.jump.n_global)
    };
    let mut size = residual.size;
    // Digits beyond these are for refinement.
    let rtol = ksp.tolerances()?.0;
    let ease = if rtol > 0.0 {
        (TIGHT / rtol).max(1.0)
    } else {
        1.0
    };
    let mut tolerance = ease * target(ksp, reference, 0.0, rows)?;
    let dual = &*solver.dual();
    let _watched = Watched::new(dual, &lambda);
    let mut inner = solver.reach(&loads, &mut residual, size, &lambda, tolerance)?;
    // What follows is short, and no look at the spectrum may end it.
    let watch = dual.watch();
    dual.set_watch(None);
    let mut stalled = false;
    let (mut asked, mut idle) = (0, false);
    loop {
        residual.evaluate(session, dual, &loads, &lambda)?;
        residual.add_rigid_motion(session, dual)?;
        // An interface may come to rest altogether: what S̃⁺ made of the loads at first is the size of rounding.
        size = size.max(residual.size);
        // The target of the displacements that have come out.
        let target = target(ksp, reference, residual.length(session), rows)?;
        let target = (ease * target).max(ROUNDING * size);
        if stalled || !inner.reason.converged() {
            break;
        }
        if to_the_end(tolerance, target) {
            let Some(enough) = enough.filter(|_| asked < ASKED) else {
                break;
            };
            let u = back(session, dual, &loads, &lambda, &mut residual, true)?;
            let Some(factor) = enough(&u)? else { break };
            asked += 1;
            residual.evaluate(session, dual, &loads, &lambda)?;
            dual.p_transpose(&residual.r)?;
            // The last iteration may have gone far below its tolerance.
            tolerance = factor * tolerance.min(residual.r.norm2()?);
        } else {
            tolerance = target;
        }
        dual.p_transpose(&residual.r)?;
        let more = iterate(dual, ksp, &residual.r, size, &lambda, tolerance)?;
        if more.iterations == 0 {
            // It was there already: the next look is the last one, unless somebody asks for more.
            if std::mem::replace(&mut idle, true) {
                break;
            }
            continue;
        }
        idle = false;
        // The longest run knows the spectrum best.
        if more.iterations > inner.iterations {
            inner.estimate = more.estimate;
        }
        inner.iterations += more.iterations;
        inner.residuals.extend(more.residuals.iter().skip(1));
        // A further run that stalls has met the rounding of the operator: what the first one reached stands.
        stalled = !more.reason.converged();
        if !stalled {
            inner.reason = more.reason;
        }
    }
    dual.set_watch(watch);
    let solve_seconds = clock.elapsed().as_secs_f64();
    let solution = finish(session, problem, dual, loads, &lambda, residual, true)?;
    Ok(Solution {
        iterations: inner.iterations,
        converged: inner.reason.converged(),
        reason: inner.reason.name,
        residuals: inner.residuals,
        estimate: inner.estimate,
        solve_seconds,
        ..solution
    })
}

/// Lets [`current`] see the iterations as long as it lives.
struct Watched<'a>(&'a Dual);

impl Watched<'_> {
    fn new<'a>(dual: &'a Dual, lambda: &PetscVec) -> Watched<'a> {
        dual.set_start(Some(lambda));
        Watched(dual)
    }
}

impl Drop for Watched<'_> {
    fn drop(&mut self) {
        self.0.set_start(None);
    }
}

/// u of the iterate that the running iteration has reached, from inside one of its monitors; `None` where none is running. Collective.
pub(crate) fn current(
    session: &Session,
    problem: &Substructures,
    dual: &Dual,
    ksp: &Ksp,
) -> Result<Option<Vec<Vec<f64>>>> {
    let Some(start) = dual.start() else {
        return Ok(None);
    };
    let lambda = dual.multipliers()?;
    ksp.current_solution(&lambda)?;
    dual.p(&lambda)?;
    dual.p2(&lambda)?;
    lambda.axpy(1.0, &start)?;
    let loads = Loads::new(session, problem, dual);
    let mut residual = Residual::new(dual)?;
    back(session, dual, &loads, &lambda, &mut residual, false).map(Some)
}

/// u from λ, with the certificate; `placed` says that `residual` has the displacements of λ, rigid motions included; what only the iterations know is left empty. Collective.
pub(crate) fn finish(
    session: &Session,
    problem: &Substructures,
    dual: &Dual,
    loads: Loads,
    lambda: &PetscVec,
    mut residual: Residual,
    placed: bool,
) -> Result<Solution> {
    let clock = Instant::now();
    let u = back(session, dual, &loads, lambda, &mut residual, placed)?;
    let recover_seconds = clock.elapsed().as_secs_f64();
    let certificate = certify(session, problem, dual, &u, lambda)?;
    Ok(Solution {
        u,
        lambda: lambda.to_vec()?,
        gaps: certificate.gaps,
        active: dual.stiffness.jump.implied(),
        iterations: 0,
        converged: false,
        reason: String::new(),
        residuals: Vec::new(),
        estimate: None,
        kkt: certificate.kkt,
        energy: certificate.energy,
        solve_seconds: 0.0,
        recover_seconds,
        steps: Vec::new(),
    })
}

/// u of every local subdomain from λ.
pub(crate) fn back(
    session: &Session,
    dual: &Dual,
    loads: &Loads,
    lambda: &PetscVec,
    residual: &mut Residual,
    placed: bool,
) -> Result<Vec<Vec<f64>>> {
    let stiffness = &dual.stiffness;
    if !placed {
        residual.evaluate(session, dual, loads, lambda)?;
        residual.add_rigid_motion(session, dual)?;
    }

    // What is left of the jumps inside a body is averaged away: u ← u − B_D,locᵀ B_loc u.
    let work = &mut residual.work;
    let jump = &residual.r;
    stiffness.jump_of(work, jump)?;
    jump.array_mut()?[stiffness.jump.n_owned_local..].fill(0.0);
    let mut ghost = vec![0.0; stiffness.jump.ghosts.len()];
    stiffness.dual_halo.fetch(jump, &mut ghost)?;
    let columns = &stiffness.jump.columns;
    stiffness.team.for_each(work, |j, w| {
        columns[j].bd_transpose(&ghost, &mut w.v);
        for (y, v) in w.y.iter_mut().zip(&w.v) {
            *y -= v;
        }
    });
    let work = &*work;
    let batches = stiffness.batches(LANES);
    Ok(stiffness.by_batch(&batches, |locals, members| {
        let part = |&j: &usize| (&loads.interiors[j][..], &work[j].y[..]);
        let parts: Vec<_> = members.iter().map(part).collect();
        Local::recover_many(locals, &parts)
    }))
}
