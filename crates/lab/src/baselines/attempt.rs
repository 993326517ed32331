//! One solve, and its repetition with smaller tolerances until a given residual of the assembled problem is met.

use super::task::{step_file, ContactOutcome, Outcome, StepOutcome};
use base::Result;
use petsc::Vec as PetscVec;
use std::path::Path;

/// One solve to a tolerance of the method's own residual.
pub struct Attempt {
    /// The solutions of the load steps, in the order of the assembled problem.
    pub u: Vec<PetscVec>,
    /// ‖b − A u‖₂ / ‖f‖₂ of the assembled problem, the largest of all load steps.
    pub residual: f64,
    /// Whether the method's own tolerance was reached.
    pub converged: bool,
    /// The report on the solve. Of the seconds of set-up it has those between solves.
    pub outcome: Outcome,
}

impl Attempt {
    /// Writes the solutions to files, the first one to `file`. Collective.
    ///
    /// # Errors
    /// Those of the disk.
    pub fn save(&self, file: &Path) -> Result<()> {
        let mut each = self.u.iter().enumerate();
        each.try_for_each(|(step, u)| u.save(&step_file(file, step)))
    }

    /// The method's report, if this solve is the one that counts: with its own tolerance, a message if the target was
    /// missed, the seconds of assembly and set-up, and the memory.
    pub(super) fn report(
        self,
        rtol: f64,
        message: Option<String>,
        [assemble, setup, memory]: [f64; 3],
    ) -> Outcome {
        Outcome {
            assemble,
            setup: setup + self.outcome.setup,
            memory,
            rtol: self.outcome.iterations.is_some().then_some(rtol),
            residual: Some(self.residual),
            message,
            ..self.outcome
        }
    }
}

/// The sums of the load steps of a method, and the largest residual. `n` load steps were to be solved.
pub fn together(steps: Vec<StepOutcome>, n: usize) -> (Outcome, f64) {
    let last = steps.last().map(|step| step.contact.clone());
    let outer: Option<usize> = steps.iter().map(|step| step.contact.steps).sum();
    let outcome = Outcome {
        iterations: steps.iter().map(|step| step.iterations).sum(),
        setup: steps.iter().map(|step| step.setup).sum(),
        solve: steps.iter().map(|step| step.solve).sum(),
        contact: last.map(|last| ContactOutcome {
            steps: outer,
            ..last
        }),
        ..Outcome::default()
    };
    let residual = steps
        .iter()
        .fold(0.0f64, |most, step| most.max(step.residual));
    let load_steps = if n > 1 { steps } else { Vec::new() };
    (
        Outcome {
            load_steps,
            ..outcome
        },
        residual,
    )
}

/// The sentence on a solve without a solution.
fn unsolved(outcome: &Outcome) -> String {
    let why = match outcome.reason.as_str() {
        "DIVERGED_CONTACT_ITS" => "the states of its contacts did not settle",
        "DIVERGED_CONTACT_LOOSE" => "a row that holds a body pulls",
        "DIVERGED_CONTACT_SLIDES" => "a body slides away",
        _ => return format!("did not converge: {}", outcome.reason),
    };
    let last = outcome.load_steps.last().map(|step| &step.contact);
    let steps = last.or(outcome.contact.as_ref()).and_then(|c| c.steps);
    let place = match outcome.load_steps.len() {
        0 => String::new(),
        n => format!(" in load step {n}"),
    };
    let (steps, reason) = (steps.unwrap_or(0), &outcome.reason);
    format!("did not converge{place}: {why} in {steps} steps of the loop ({reason})")
}

/// Repeats the solve with a smaller tolerance until the assembled residual is met, and with a larger one where a solve
/// ends far below it. Methods that iterate on multipliers measure another residual; methods that iterate on u meet it
/// at once, or drift from it by rounding. Only one solve is reported: the one with the largest tolerance that met the
/// residual, or the one that came closest.
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
    // So many solves may gain nothing: a loop of states ends with more than its tolerance, or with less.
    const IDLE: usize = 2;
    // A solve with a residual below this part of the target went too far. So many solves may then take larger
    // tolerances, below one that has failed.
    const FAR: f64 = 0.1;
    const LOOSER: usize = 2;
    let (mut rtol, mut idle, mut looser) = (first, 0, 0);
    let mut failed = 1.0;
    let mut met: Option<(Attempt, f64)> = None;
    let mut best: Option<(Attempt, f64)> = None;
    loop {
        let now = solve(rtol)?;
        if now.converged && now.residual <= target {
            let iterates = now.outcome.iterations.is_some_and(|n| n > 0);
            if !(iterates && now.residual < FAR * target && looser < LOOSER) {
                return Ok((now, rtol, None));
            }
            let next = (rtol * 0.5 * target / now.residual).min((rtol * failed).sqrt());
            met = Some((now, rtol));
            (rtol, looser) = (next, looser + 1);
            continue;
        }
        if let Some((met, rtol)) = met {
            return Ok((met, rtol, None));
        }
        if !now.converged && best.is_none() {
            let message = unsolved(&now.outcome);
            return Ok((now, rtol, Some(message)));
        }
        failed = rtol;
        // Stuck: further iterations gain nothing, or none are left.
        let stuck = best.as_ref().is_some_and(|(best, _)| {
            let [before, after] = [best, &now].map(|a| a.outcome.iterations);
            let more = after.is_none() || after > before;
            if more && now.residual > GAIN * best.residual {
                idle += if after.is_none() { IDLE } else { 1 };
            }
            !now.converged || idle >= IDLE
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
#[path = "../../tests/baselines/attempt.rs"]
mod tests;
