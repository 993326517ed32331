//! One run of the Krylov method: λ ← λ + P x with Pᵀ F P x = Pᵀ r.

use super::residual::ROUNDING;
use super::system::DualSystem;
use super::tally::ClockReadings;
use crate::feti::method::LinearMethod;
use crate::feti::spectrum::Spectrum;
use crate::status::Status;
use crate::{Error, Result};
use petsc::{ConvergedReason, Ksp, LargeEigenvalue, Stopped, Vec as PetscVec};

/// An iteration is no longer broken off if its residual is less than this many times its tolerance.
pub(super) const NEARLY: f64 = 30.0;

/// A run is looked at whenever its residual has fallen by this factor since the last look.
const LOOK: f64 = 0.3;

/// An exact projection of jumps leaves less than this outside the range of Pᵀ, relative to the displacements that the
/// jumps come from: rounding over the smallest eigenvalue that a factor may have to count as exact.
const OUTSIDE: f64 = 1e-8;

/// No run for a linear solution goes on below this fraction of the displacements that r is computed from: what is left
/// there is their own rounding. Part of it is in the kernel of F, where averages are primal. It does not fall, and
/// where symmetry leaves few directions to go it is soon all that is left: CG would divide by it. In a contact loop a
/// body that hardly anything holds may be far away for a while; that says nothing of the jumps that matter.
pub(super) const NOISE: f64 = 10.0 * f64::EPSILON;

/// Called during a run with the present λ; `true` ends the run. All ranks give the same answer.
pub type IterateMonitor<'a> = dyn FnMut(&PetscVec) -> Result<bool> + 'a;

/// Parameters of a run.
#[derive(Debug, Clone, Copy)]
pub struct IterationControl {
    /// ‖r‖₂ to stop at.
    pub tolerance: f64,
    /// ‖y‖₂ of the displacements that r is computed from. A residual below [`ROUNDING`] times this is rounding.
    pub size: f64,
    /// Whether the run is broken off at large eigenvalues in order to deflate them.
    pub watch: Option<Watch>,
    /// Whether monitors may ask for the displacements of the iterate.
    pub observed: bool,
    /// The run ends here at the latest; 0 without such a limit.
    pub floor: f64,
}

impl IterationControl {
    /// A run to this tolerance that is neither broken off nor observed.
    pub fn to(tolerance: f64, size: f64) -> IterationControl {
        IterationControl {
            tolerance,
            size,
            watch: None,
            observed: false,
            floor: 0.0,
        }
    }

    /// This run without iterations below the rounding of the displacements.
    pub fn above_rounding(self) -> IterationControl {
        IterationControl {
            floor: NOISE * self.size,
            ..self
        }
    }

    /// This run with monitors that may ask for the displacements.
    pub fn observed(self) -> IterationControl {
        IterationControl {
            observed: true,
            ..self
        }
    }
}

/// The condition for breaking a run off because of large eigenvalues.
#[derive(Debug, Clone, Copy)]
pub struct Watch {
    /// The run is broken off above this eigenvalue.
    pub limit: f64,
    /// Iterations before the first look at the spectrum.
    pub from: usize,
}

/// Record of one run of the Krylov method.
#[derive(Debug, Clone)]
pub struct KrylovRun {
    /// Iterations.
    pub iterations: usize,
    /// Why it stopped.
    pub status: Status,
    /// ‖r_n‖₂ for n = 0, 1, …
    pub residuals: Vec<f64>,
    /// The method's own estimate of the spectrum.
    pub estimate: Option<Spectrum>,
    /// Who ended the run early.
    pub stopped: Stopped,
}

impl KrylovRun {
    fn nothing_to_do(residual: f64) -> KrylovRun {
        KrylovRun {
            iterations: 0,
            status: Status::NothingToDo,
            residuals: vec![residual],
            estimate: None,
            stopped: Stopped::No,
        }
    }

    /// Whether rounding ended the run after the residual had fallen below `part` of its first value.
    pub fn broke_down(&self, part: f64) -> bool {
        let ends = (self.residuals.first(), self.residuals.last());
        let moved = matches!(ends, (Some(first), Some(last)) if *last < part * first);
        self.status.broke_down() && moved
    }

    /// The run `before` that was broken off, if there is one, followed by this one with another preconditioner or
    /// tolerance. The spectrum is that of this run.
    pub fn after(self, before: Option<KrylovRun>) -> KrylovRun {
        let Some(before) = before else {
            return self;
        };
        let mut residuals = before.residuals;
        residuals.extend(&self.residuals);
        KrylovRun {
            iterations: before.iterations + self.iterations,
            residuals,
            ..self
        }
    }

    /// The end of a loop after `iterations` in all its steps; residuals and spectrum are those of its last run.
    pub fn of_loop(
        iterations: usize,
        status: Status,
        (residuals, estimate): (Vec<f64>, Option<Spectrum>),
    ) -> KrylovRun {
        KrylovRun {
            iterations,
            status,
            residuals,
            estimate,
            stopped: Stopped::No,
        }
    }

    /// Adds a further run of the same method. The spectrum is that of the longest run. A further run that stalls has
    /// met the rounding of the operator; the earlier result stands.
    pub fn add(&mut self, more: KrylovRun) {
        if more.iterations > self.iterations {
            self.estimate = more.estimate;
        }
        self.iterations += more.iterations;
        self.residuals.extend(more.residuals.iter().skip(1));
        if more.status.converged() {
            self.status = more.status;
        }
    }
}

/// Adds the Krylov method's correction to `lambda`. `residual` is Pᵀ r on entry. `look` may end the run early.
/// Collective.
pub fn iterate(
    method: &LinearMethod,
    residual: &PetscVec,
    lambda: &PetscVec,
    control: &IterationControl,
    look: Option<&mut IterateMonitor>,
) -> Result<KrylovRun> {
    let (system, ksp) = (&method.system, &method.ksp);
    let is_cg = ksp.type_name()? == "cg";
    let exact = system.keeps_to_v();
    // Project a second time. The first projection of a large jump leaves a part outside the range of Pᵀ by rounding.
    // The iteration cannot reduce that part: it would stall on it and diverge. The second projection starts from a
    // small residual and leaves a negligible part.
    if !(exact && control.tolerance > OUTSIDE * control.size) {
        system.dual().p_transpose(residual)?;
    }
    let nothing = (ROUNDING * control.size).max(control.tolerance);
    let mut start = residual.norm2()?;
    if start <= nothing {
        return Ok(KrylovRun::nothing_to_do(start));
    }
    // The part of the solution in range W, and in the span of earlier directions, is known before the iteration.
    for known_part in [DualSystem::deflated_part, DualSystem::recycled_part] {
        known_part(system, residual, lambda)?;
        start = residual.norm2()?;
        if start <= nothing {
            return Ok(KrylovRun::nothing_to_do(start));
        }
    }
    if !(start.is_finite() && control.tolerance.is_finite()) {
        return Err(Error::input(format!(
            "the residual is {start:e} and the tolerance {:e}: loads, coefficients and lengths are so large or so \
             small together that squares of forces are no numbers (take other units)",
            control.tolerance
        )));
    }
    let (rtol, atol, dtol, max_it) = ksp.tolerances()?;
    if max_it == 0 {
        // PETSc's CG runs one iteration all the same, and writes beyond the arrays that it has for none.
        return Ok(KrylovRun {
            iterations: 0,
            status: Status::Krylov(ConvergedReason::its()),
            residuals: vec![start],
            estimate: None,
            stopped: Stopped::No,
        });
    }
    let x = system.dual().multipliers()?;
    let rtol_of = |rtol| ksp.set_tolerances(Some(rtol), Some(atol), Some(dtol), Some(max_it));
    ksp.record_residuals(max_it.clamp(0, 100_000) as usize + 1)?;
    rtol_of(control.tolerance.max(control.floor) / start)?;
    let counted = ClockReadings::now();
    let solved = {
        let _running = system.run(control.observed.then_some(lambda), is_cg, rtol);
        let eigenvalue = control.watch.filter(|_| is_cg).map(|w| LargeEigenvalue {
            first: w.from,
            limit: w.limit,
            rest: NEARLY * control.tolerance,
        });
        // Other methods do not have their iterate at hand.
        match look.filter(|_| is_cg) {
            Some(look) => {
                let now = lambda.duplicate()?;
                let mut next = LOOK * start;
                let mut look_at = |residual: f64| {
                    if residual > next {
                        return Ok(false);
                    }
                    next = LOOK * residual;
                    ksp.current_solution(&now)?;
                    system.p2(&now)?;
                    now.axpy(1.0, lambda)?;
                    look(&now)
                };
                ksp.solve_watched(residual, &x, eigenvalue, Some(&mut look_at))
            }
            None if eigenvalue.is_some() => ksp.solve_watched(residual, &x, eigenvalue, None),
            None => ksp.solve(residual, &x).map(|()| Stopped::No),
        }
    };
    rtol_of(rtol)?;
    let stopped = solved?;
    let iterations = ksp.iterations()?;
    system.count(&counted.since(iterations));
    // Directions of CG are in V where P is exact, and so is their sum.
    if !(exact && is_cg) {
        system.dual().p(&x)?;
        system.p2(&x)?;
    }
    lambda.axpy(1.0, &x)?;
    Ok(KrylovRun {
        iterations,
        status: Status::Krylov(ksp.converged_reason()?),
        residuals: ksp.residual_history()?,
        estimate: estimate(ksp, iterations)?,
        stopped,
    })
}

/// The ends of the spectrum from CG's Lanczos matrix. Singular values of other methods are not eigenvalues. FCG of
/// PETSc 3.18 reads the data of CG in place of its own.
fn estimate(ksp: &Ksp, iterations: usize) -> Result<Option<Spectrum>> {
    if ksp.type_name()? != "cg" || iterations == 0 {
        return Ok(None);
    }
    let (lambda_max, lambda_min) = ksp.extreme_singular_values()?;
    Ok((lambda_min > 0.0).then_some(Spectrum {
        lambda_min,
        lambda_max,
        settled: None,
    }))
}
