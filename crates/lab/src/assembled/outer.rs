//! The primal-dual active set on the assembled problem: the loop of `contact::active_set` with the same rules, around
//! solvers of PETSc.
//!
//! ```text
//!     solve Tᵀ K T v = Tᵀ(f − K u₀) on A_k,  Bᵀ λ = f − K u,  A_{k+1} = { j : λ_j > 0 on A_k, (B u − c)_j > 0 off it }
//! ```
//!
//! The loop starts from all candidates. While the set changes, problems are solved loosely, and u is the start of the
//! next solve; once the set stays, its problem is solved to the final tolerance. If a set comes back, the loop becomes
//! careful: exact solves first, then one row at a time.
//!
//! These sets need not settle. If a set comes back again, if there are too many, or if the last row that holds a body
//! pulls, the sets come from a method that converges (see [`DampedNewton`]). Each of its sets is
//! tried: its equations are solved, and the sets that follow by the rule above, for as long as there are fewer and
//! fewer wrong rows. The loop ends with the first set that satisfies all conditions. So the method guarantees the end,
//! and the trials give the accuracy.

use std::collections::HashSet;
use std::time::Instant;

use super::damped_newton::DampedNewton;
use super::groups::{multipliers, ActiveGroups, MultiplierSigns};
use super::judged::Judged;
use super::reduced::Reduced;
use super::refine::{over, Refiner};
use super::rows::Inequalities;
use base::Result;
use parallel::meter::timed;
use petsc::{Ksp, Session, Vec as PetscVec};

/// Some rows are kept active only so that no body comes loose. Such a row may pull by this part of the largest
/// multiplier: then no force drives the body away.
const IDLE: f64 = 1e-8;

/// The certificate of a refined solution must be below this.
const CERTIFIED: f64 = 1e-9;

/// Number of steps after which the sets come from the method that converges.
const STEPS: usize = 200;

/// Tolerances.
#[derive(Debug, Clone, Copy)]
pub struct Tolerances {
    /// Residual at the end, relative to the load.
    pub rtol: f64,
    /// Reduction of the residual in a step while the set still changes.
    pub inner: f64,
    /// The preconditioner is kept until more than this part of all rows has changed since it was built.
    pub lag: f64,
}

/// How the equations of one active set are solved.
#[derive(Clone, Copy)]
pub enum OuterSolve<'a> {
    /// One solve.
    Once,
    /// This many solves, of which all but the first refine a direct solution.
    Repeated(usize),
    /// A direct solution that is refined in twice the working precision.
    Refined(&'a Refiner<'a>),
}

/// The result of the loop.
pub struct ActiveSetEnd {
    /// The solution.
    pub u: PetscVec,
    /// The active set.
    pub active: Vec<bool>,
    /// Multipliers of the rows.
    pub lambda: Vec<f64>,
    /// B u − c.
    pub gaps: Vec<f64>,
    /// Number of systems of equations that were solved, one for each set or Newton step.
    pub steps: usize,
    /// Inner iterations of all steps.
    pub iterations: usize,
    /// Seconds for matrices and preconditioners.
    pub setup: f64,
    /// Seconds for everything else.
    pub solve: f64,
    /// Residual, relative to the load.
    pub residual: f64,
    /// How well the conditions of optimality hold.
    pub certificate: OuterCertificate,
    /// Whether the set has settled and the residual is small enough; where the solution is refined, whether the
    /// certificate holds.
    pub converged: bool,
    /// Why the loop ended.
    pub reason: String,
}

/// How well the conditions of optimality hold, each relative to the size of its terms.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct OuterCertificate {
    /// The last correction of a refinement relative to the solution, in the energy norm or by the largest displacement,
    /// whichever is larger. It bounds the error in u even where the residual is small against its terms.
    pub correction: f64,
    /// Largest violation of an inequality over the largest |u|.
    pub feasibility: f64,
    /// Largest pull, over the largest multiplier.
    pub pull: f64,
}

impl OuterCertificate {
    /// The largest of the three.
    pub fn largest(&self) -> f64 {
        self.correction.max(self.feasibility).max(self.pull)
    }

    /// Whether the certificate is small enough for a refined solution.
    pub fn holds(&self) -> bool {
        self.largest() < CERTIFIED
    }
}

/// How carefully the loop changes the set.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Caution {
    Loose,
    Exact,
    Single,
}

/// The source of the loop's solvers. It is called whenever a preconditioner is built, and returns the previous solver
/// or a new one, with options, but without operator and set-up.
pub type Solvers<'a> = dyn FnMut() -> Result<Ksp> + 'a;

/// Runs the loop. Where a set is given, only its equations are solved. Collective.
///
/// # Errors
/// PETSc's.
pub fn solve(
    session: &Session,
    rows: &Inequalities,
    reduced: &Reduced,
    solvers: &mut Solvers,
    tolerances: Tolerances,
    solve: OuterSolve,
    given: Option<&[bool]>,
) -> Result<ActiveSetEnd> {
    let (whole, mut setup) = (Instant::now(), 0.0);
    let u = reduced.vector()?;
    let mut active = given.map_or_else(|| rows.initial.clone(), <[bool]>::to_vec);
    let mut priority: Vec<usize> = (0..rows.len()).collect();
    let mut visited: HashSet<Vec<bool>> = HashSet::new();
    let mut caution = Caution::Loose;
    let (mut steps, mut iterations, mut tight) = (0, 0, given.is_some());
    // The active set for which the preconditioner was built.
    let mut built: Vec<bool> = Vec::new();
    let mut groups: Option<ActiveGroups> = None;
    let mut search: Option<DampedNewton> = None;
    // Why `search` was begun, and the least number of wrong rows in the present trial.
    let (mut why_search, mut fewest) = ("DIVERGED_CONTACT_ITS", 0);
    let mut ksp = solvers()?;
    loop {
        let now = match groups.take() {
            Some(groups) => groups,
            None => {
                let groups = ActiveGroups::new(rows, &mut active, &priority);
                let changed = active.iter().zip(&built).filter(|(a, b)| a != b).count();
                let stale = changed as f64 > tolerances.lag * rows.len() as f64;
                let build = built.is_empty() || stale;
                if build {
                    built.clone_from(&active);
                }
                let prepare = || {
                    if build && steps > 0 {
                        ksp = solvers()?;
                    }
                    ksp.set_reuse_preconditioner(!build)?;
                    reduced.update(&groups)?;
                    ksp.set_operators(&reduced.a, &reduced.a)?;
                    ksp.setup()
                };
                setup += timed(session, prepare)?.1;
                groups
            }
        };
        steps += 1;
        let b = reduced.rhs(&now)?;
        let v = reduced.start(&now, &u)?;
        let reference = reduced.reference(&b)?;
        let target = tolerances.rtol * reference;
        let (r, d) = (reduced.vector()?, reduced.vector()?);
        let mut residual = residual_of(reduced, &b, &v, &r)?;
        let stop = match caution {
            Caution::Loose if !tight => target.max(tolerances.inner * residual),
            _ => target,
        };
        let mut reason = "CONVERGED_NOTHING_TO_DO".to_string();
        let (mut failed, mut correction) = (false, 0.0);
        if let OuterSolve::Refined(refiner) = solve {
            let refined = refiner.refine(&now, &ksp, &v)?;
            (residual, correction) = (refined.residual, refined.correction);
            (reason, failed) = refined.reason;
            iterations += refined.rounds;
        }
        let solves = match solve {
            OuterSolve::Once => usize::from(residual > stop),
            OuterSolve::Repeated(solves) => solves,
            OuterSolve::Refined(_) => 0,
        };
        for _ in 0..solves {
            ksp.set_tolerances(Some((stop / residual).min(0.9)), Some(0.0), None, None)?;
            ksp.solve(&r, &d)?;
            v.axpy(1.0, &d)?;
            iterations += ksp.iterations()?;
            let why = ksp.converged_reason()?;
            failed = !why.converged();
            reason = why.name;
            residual = residual_of(reduced, &b, &v, &r)?;
        }
        reduced.trace.spread(session.comm(), &now, &v, &u)?;

        let at = reduced.trace.get(session.comm(), &u)?;
        let forces = match solve {
            OuterSolve::Refined(refiner) => refiner.forces(&u)?,
            _ => reduced.forces(&u)?,
        };
        let signs = match search {
            Some(_) => MultiplierSigns::Pushing,
            None => MultiplierSigns::Any,
        };
        let lambda = multipliers(rows, &active, &forces, signs);
        let sizes = (u.norm_inf()?, reference);
        let judged = Judged::new(rows, &active, lambda, rows.gaps(&at), sizes);
        let certificate = judged.certificate(correction);
        let relative = over(residual, reference);
        let mut next = judged.next.clone();
        if caution == Caution::Single {
            judged.keep_worst(&active, &mut next);
        }
        let restored = rows.restore(&mut next, &judged.score);
        let stays = next == active;
        let to_the_end = stop <= target;
        let refined = matches!(solve, OuterSolve::Refined(_));
        // Sets that come back differ only in rows that rounding decides.
        let right = if refined {
            caution != Caution::Loose && certificate.holds()
        } else {
            search.is_some() && certificate.holds()
        };
        let settled = stays || right;
        let met = if refined {
            certificate.holds()
        } else {
            relative <= tolerances.rtol
        };
        let idle = |r: &usize| judged.idle(*r, IDLE);
        let held = restored.iter().all(idle);
        let wrong = judged.count();
        let worse = !held || wrong >= fewest;
        let end = if failed {
            Some((false, reason))
        } else if given.is_some() {
            Some((!refined || met, reason))
        } else if settled && to_the_end && held {
            Some((met, reason))
        } else if worse && search.as_ref().is_some_and(DampedNewton::is_exhausted) {
            Some((false, why_search.to_string()))
        } else {
            None
        };
        if let Some((converged, reason)) = end {
            return Ok(ActiveSetEnd {
                u,
                active,
                lambda: judged.lambda,
                gaps: judged.gaps,
                steps,
                iterations,
                setup,
                solve: whole.elapsed().as_secs_f64() - setup,
                residual: relative,
                certificate,
                converged,
                reason,
            });
        }
        let loose = settled && to_the_end && !held;
        tight = stays && !loose;
        if tight {
            groups = Some(now);
            continue;
        }
        let back = !visited.insert(next.clone());
        if search.is_none() {
            if loose || steps >= STEPS || (back && caution == Caution::Single) {
                search = Some(DampedNewton::new(session, rows, reduced)?);
                why_search = if loose {
                    "DIVERGED_CONTACT_LOOSE"
                } else {
                    "DIVERGED_CONTACT_ITS"
                };
                caution = Caution::Exact;
            } else if back {
                caution = match caution {
                    Caution::Loose => Caution::Exact,
                    _ => Caution::Single,
                };
                visited.clear();
            }
        }
        match &mut search {
            Some(search) if worse => {
                let round = search.round(solvers)?;
                steps += round.steps;
                iterations += round.iterations;
                setup += round.setup;
                u.copy_from(&search.u)?;
                (active, priority) = (round.active, round.priority);
                built.clear();
                fewest = usize::MAX;
            }
            _ => {
                priority = judged.priority(&active, &next);
                active = next;
                fewest = wrong;
            }
        }
    }
}

/// r ← b − A v, and its norm.
fn residual_of(reduced: &Reduced, b: &PetscVec, v: &PetscVec, r: &PetscVec) -> Result<f64> {
    reduced.a.mult(v, r)?;
    r.aypx(-1.0, b)?;
    r.norm2()
}
