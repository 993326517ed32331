//! One solve, and its repetition with smaller tolerances until a given residual of the assembled problem is met.

use super::task::{ContactOutcome, Outcome};
use crate::petsc::Vec as PetscVec;
use crate::Result;

/// One solve to a tolerance of the method's own residual.
pub struct Attempt {
    /// The solution, in the order of the assembled problem.
    pub u: PetscVec,
    /// ‖b − A u‖₂ / ‖f‖₂ of the assembled problem.
    pub residual: f64,
    /// κ by CG.
    pub kappa: Option<f64>,
    /// Iterations; `None` for a direct solver.
    pub iterations: Option<usize>,
    /// Wall-clock time.
    pub seconds: f64,
    /// The part of `seconds` for the recovery of displacements from multipliers, where there is one.
    pub recover: Option<f64>,
    /// Seconds of set-ups between solves; `seconds` does not include them.
    pub setup: f64,
    /// The result of the contact loop, if there was one.
    pub contact: Option<ContactOutcome>,
    /// Whether the method's own tolerance was reached.
    pub converged: bool,
    /// PETSc's name for the reason why the solve ended.
    pub reason: String,
}

impl Outcome {
    /// Takes the solve that counts, its own tolerance, a message if the target was missed, the seconds of assembly and
    /// set-up, and the memory.
    pub(super) fn new(
        attempt: Attempt,
        rtol: f64,
        message: Option<String>,
        [assemble, setup, memory]: [f64; 3],
    ) -> Outcome {
        Outcome {
            kappa: attempt.kappa,
            iterations: attempt.iterations,
            assemble,
            setup: setup + attempt.setup,
            solve: attempt.seconds,
            recover: attempt.recover,
            again: None,
            memory,
            memory_at_start: 0.0,
            rtol: attempt.iterations.is_some().then_some(rtol),
            residual: Some(attempt.residual),
            contact: attempt.contact,
            reason: attempt.reason,
            message,
        }
    }
}

/// Repeats the solve with a smaller tolerance until the assembled residual is met. Methods that iterate on multipliers
/// measure another residual; methods that iterate on u meet it at once, or drift from it by rounding. Only one solve is
/// reported: the one that met the residual, or the one that came closest.
///
/// Returns the solve, the tolerance of the method's own residual in it, and a message if the target was missed.
///
/// # Errors
/// Those of `solve`.
pub fn solve_to(
    target: f64,
    first: f64,
    mut solve: impl FnMut(f64) -> Result<Attempt>,
) -> Result<(Attempt, f64, Option<String>)> {
    const SMALLEST: f64 = 1e-16;
    // A residual counts as smaller below this fraction of the previous one.
    const GAIN: f64 = 0.9;
    let mut rtol = first;
    let mut best: Option<(Attempt, f64)> = None;
    loop {
        let now = solve(rtol)?;
        if now.converged && now.residual <= target {
            return Ok((now, rtol, None));
        }
        if !now.converged && best.is_none() {
            let message = format!("did not converge: {}", now.reason);
            return Ok((now, rtol, Some(message)));
        }
        // Stuck: further iterations gain nothing, or none are left.
        let stuck = best.as_ref().is_some_and(|(best, _)| {
            let more = now.iterations.is_none() || now.iterations > best.iterations;
            !now.converged || (more && now.residual > GAIN * best.residual)
        });
        let residual = now.residual;
        if best
            .as_ref()
            .is_none_or(|(best, _)| now.converged && residual < GAIN * best.residual)
        {
            best = Some((now, rtol));
        }
        if stuck || residual.is_nan() || rtol < SMALLEST {
            let (best, rtol) = best.expect("the first attempt was kept");
            let message = format!("the residual stays at {:.1e}", best.residual);
            return Ok((best, rtol, Some(message)));
        }
        rtol *= (0.5 * target / residual).clamp(1e-4, 0.5);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::petsc::testing::with_session;

    /// The end of an attempt, without its vector.
    #[derive(Debug)]
    struct End {
        residual: f64,
        iterations: Option<usize>,
        converged: bool,
    }

    /// Simulates an iteration that gains a digit a step in its own residual. The assembled residual is `factor` times
    /// that, but at least `floor`; tolerances from `breaks_at` down make the iteration fail.
    fn drive(target: f64, factor: f64, floor: f64, breaks_at: f64) -> (End, Option<String>) {
        with_session(move |session| {
            let (end, _, message) = solve_to(target, target, |rtol| {
                let steps = (-rtol.log10() - 1e-9).ceil();
                Ok(Attempt {
                    u: PetscVec::seq(session, 1)?,
                    residual: (factor * 10_f64.powf(-steps)).max(floor),
                    kappa: None,
                    iterations: Some(steps as usize),
                    seconds: 0.0,
                    recover: None,
                    setup: 0.0,
                    contact: None,
                    converged: rtol > breaks_at,
                    reason: String::new(),
                })
            })
            .expect("nothing fails");
            let end = End {
                residual: end.residual,
                iterations: end.iterations,
                converged: end.converged,
            };
            (end, message)
        })
    }

    #[test]
    fn tolerances_shrink_until_the_assembled_residual_is_met() {
        let (end, message) = drive(1e-6, 0.9, 0.0, 0.0);
        assert_eq!((end.iterations, message), (Some(6), None));
        let (end, message) = drive(1e-6, 300.0, 0.0, 0.0);
        assert!(
            end.residual <= 1e-6 && message.is_none(),
            "{end:?} {message:?}"
        );
        assert_eq!(end.iterations, Some(9));
    }

    #[test]
    fn what_cannot_be_met_is_said() {
        let (end, message) = drive(1e-6, 300.0, 1e-5, 0.0);
        assert_eq!(end.residual, 1e-5);
        assert!(message.is_some_and(|m| m.contains("stays at 1.0e-5")));
        // An attempt that fails later does not discard what was reached.
        let (end, message) = drive(1e-6, 300.0, 0.0, 1e-7);
        assert!(end.converged && end.residual < 1e-3, "{end:?}");
        assert!(message.is_some_and(|m| m.contains("stays at")));
        let (end, message) = drive(1e-6, 1.0, 0.0, 1e-3);
        assert!(!end.converged && message.is_some_and(|m| m.contains("did not converge")));
    }
}
