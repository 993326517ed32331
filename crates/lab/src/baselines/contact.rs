//! A baseline on a contact scene: the active-set loop around a solver of the assembled problem.

use std::path::Path;

use super::attempt::{solve_to, together, Attempt};
use super::linear::{kappa, solver};
use super::second::SecondLoad;
use super::table::Baseline;
use super::task::{ContactOutcome, Job, Outcome, StepOutcome};
use crate::assembled::course::{OuterSolve, OuterStart, Tolerances};
use crate::assembled::layout::UnknownLayout;
use crate::assembled::load_steps::LoadSteps;
use crate::assembled::near::NearKernel;
use crate::assembled::outer;
use crate::assembled::reduced::Reduced;
use crate::assembled::rows::Inequalities;
use crate::assembled::system::AssembledSystem;
use crate::assembled::unknowns::Unknowns;
use base::Result;
use parallel::meter::{memory, timed};
use petsc::Session;
use scene::Scene;

/// Solves a scene with inequalities, with friction all its load steps.
///
/// # Errors
/// Those of the scene, PETSc's, and those of the disk.
pub fn baseline(
    session: &Session,
    scene: &Scene,
    job: &Job,
    row: &Baseline,
    file: &Path,
) -> Result<Outcome> {
    let ((mut rows, mut reduced, load, steps), assemble) = timed(session, || {
        let layout = UnknownLayout::new(scene);
        let rows = Inequalities::new(scene, &layout);
        let unknowns = Unknowns::all(&layout);
        let system = AssembledSystem::new(session, scene, &unknowns, row.format)?;
        let kernel = NearKernel::new(scene, &unknowns, &system.b, row.near)?;
        let steps = LoadSteps::new(session, scene, (&system, &rows), row.format)?;
        // A load step that depends on others has no second load.
        let load = if job.again && steps.0.len() == 1 {
            Some(SecondLoad::new(&layout).of(&unknowns, &system.b)?)
        } else {
            None
        };
        let reduced = Reduced::new(session, &system, &rows, kernel)?;
        Ok((rows, reduced, load, steps))
    })?;
    let (ksp, mut krylov) = solver(session, row, &reduced.a)?;
    let mut last = ksp;
    let direct = krylov.type_name()? == "preonly";
    // PETSc reads no tolerance for a solver that does not iterate; forces of friction are renewed to it.
    let first = match direct {
        true => job.rtol,
        false => krylov.tolerances()?.0,
    };
    // The loop's result separates the seconds of set-ups from the rest.
    let mut find = |rows: &Inequalities, reduced: &Reduced, rtol: f64, start: OuterStart| {
        let tolerances = Tolerances {
            rtol,
            inner: if direct { 0.0 } else { job.inner },
            lag: row.lag,
        };
        // GAMG keeps the rigid motions of its first set-up, and they change with the set.
        let mut solvers = || {
            if reduced.has_near_kernel() {
                (last, krylov) = solver(session, row, &reduced.a)?;
            }
            Ok(last.clone())
        };
        let found = outer::solve(
            session,
            rows,
            reduced,
            &mut solvers,
            tolerances,
            OuterSolve::Once,
            start,
        )?;
        Ok((found, kappa(&krylov)?))
    };
    let (attempt, rtol, message) = solve_to(job.rtol, first, |rtol| {
        let mut last = None;
        let ends = steps.follow(&mut rows, |step, rows, start| {
            reduced.set_load(&step.b, step.reference);
            let (found, kappa) = find(rows, &reduced, rtol, start)?;
            last = kappa.or(last);
            Ok(found)
        })?;
        let outcomes = ends.iter().map(|found| StepOutcome {
            iterations: (!direct).then_some(found.iterations),
            setup: found.setup,
            solve: found.solve,
            residual: found.residual,
            contact: ContactOutcome {
                steps: Some(found.steps),
                active: rows.list(&found.active),
            },
        });
        let (outcome, residual) = together(outcomes.collect(), steps.0.len());
        let end = ends.last().expect("there is a load step");
        Ok(Attempt {
            residual,
            converged: end.converged,
            outcome: Outcome {
                kappa: last,
                reason: end.reason.clone(),
                ..outcome
            },
            u: ends.into_iter().map(|end| end.u).collect(),
        })
    })?;
    let memory = memory(session);
    attempt.save(file)?;
    let again = match load {
        Some(load) if message.is_none() => {
            reduced.set_load(&load, load.norm2()?);
            let (found, _) = find(&rows, &reduced, rtol, OuterStart::Cold)?;
            Some(found.setup + found.solve)
        }
        _ => None,
    };
    let outcome = attempt.report(rtol, message, [assemble, 0.0, memory]);
    Ok(Outcome { again, ..outcome })
}
