//! A baseline on a contact scene: the active-set loop around a solver of the assembled problem.

use std::path::Path;

use super::attempt::{solve_to, Attempt};
use super::linear::{kappa, solver};
use super::second::SecondLoad;
use super::table::Baseline;
use super::task::{ContactOutcome, Job, Outcome};
use crate::assembled::course::{OuterSolve, Tolerances};
use crate::assembled::layout::UnknownLayout;
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

/// Solves a scene with inequalities.
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
    let ((rows, mut reduced, load), assemble) = timed(session, || {
        let layout = UnknownLayout::new(scene);
        let rows = Inequalities::new(scene, &layout);
        let unknowns = Unknowns::all(&layout);
        let system = AssembledSystem::new(session, scene, &unknowns, row.format)?;
        let kernel = NearKernel::new(scene, &unknowns, &system.b, row.near)?;
        let load = if job.again {
            Some(SecondLoad::new(&layout).of(&unknowns, &system.b)?)
        } else {
            None
        };
        let reduced = Reduced::new(session, &system, &rows, kernel)?;
        Ok((rows, reduced, load))
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
    let mut find = |reduced: &Reduced, rtol: f64| {
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
            &rows,
            reduced,
            &mut solvers,
            tolerances,
            OuterSolve::Once,
            None,
        )?;
        Ok((found, kappa(&krylov)?))
    };
    let (attempt, rtol, message) = solve_to(job.rtol, first, |rtol| {
        let (found, kappa) = find(&reduced, rtol)?;
        Ok(Attempt {
            residual: found.residual,
            converged: found.converged,
            outcome: Outcome {
                kappa,
                iterations: (!direct).then_some(found.iterations),
                setup: found.setup,
                solve: found.solve,
                contact: Some(ContactOutcome {
                    steps: Some(found.steps),
                    active: rows.list(&found.active),
                }),
                reason: found.reason,
                ..Outcome::default()
            },
            u: found.u,
        })
    })?;
    let memory = memory(session);
    attempt.u.save(file)?;
    let again = match load {
        Some(load) if message.is_none() => {
            reduced.set_load(load)?;
            let (found, _) = find(&reduced, rtol)?;
            Some(found.setup + found.solve)
        }
        _ => None,
    };
    let outcome = attempt.report(rtol, message, [assemble, 0.0, memory]);
    Ok(Outcome { again, ..outcome })
}
