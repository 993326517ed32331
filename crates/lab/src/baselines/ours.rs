//! Our method as one of the jobs, measured on the assembled problem like the others.

use std::path::Path;

use super::attempt::{solve_to, Attempt};
use super::second::SecondLoad;
use super::task::{ContactOutcome, Job, Outcome};
use crate::assembled::layout::UnknownLayout;
use crate::assembled::problem::AssembledProblem;
use crate::assembled::rows::Inequalities;
use crate::assembled::system::{Copies, MatrixFormat};
use crate::assembled::unknowns::Unknowns;
use base::Result;
use fetifeti::settings::MethodSettings;
use fetifeti::{FetiFeti, Solution, Subdomain};
use parallel::exchange::{gather_all, max_all};
use parallel::meter::{memory, timed};
use petsc::{Options, Session, Vec as PetscVec};
use scene::{distribution, Scene};

/// Solves a scene by the FETI-FETI method.
///
/// # Errors
/// Those of the scene and of the method, PETSc's, and those of the disk.
pub fn solve(
    session: &Session,
    scene: &Scene,
    job: &Job,
    threads: usize,
    file: &Path,
) -> Result<Outcome> {
    Options::new(session, "fetifeti_").set_default("threads", &threads.to_string())?;
    let (substructures, assemble) = timed(session, || distribution::substructures(session, scene))?;
    // Recycled directions of one attempt would shorten the next one, which is the one that is timed.
    let settings = MethodSettings::default().rtol(job.rtol).recycle(0);
    let (mut solver, setup) = timed(session, || FetiFeti::new(session, substructures, settings))?;
    // The assembled matrix serves for the residual only: its time and memory do not count.
    let layout = UnknownLayout::new(scene);
    let unknowns = Unknowns::all(&layout);
    let mut problem: Option<AssembledProblem> = None;
    let mut bytes = 0.0;
    let (attempt, rtol, message) = solve_to(job.rtol, job.rtol, |rtol| {
        solver.ksp().set_tolerances(Some(rtol), None, None, None)?;
        let (solution, _) = timed(session, || solver.solve())?;
        if problem.is_none() {
            bytes = memory(session);
            let format = MatrixFormat::Unassembled;
            problem = Some(AssembledProblem::new(session, scene, &unknowns, format)?);
        }
        let problem = problem.as_ref().expect("it was built above");
        let (local, copies) = (&solver.problem().local, Copies::ByCoefficient);
        let mean = problem
            .system
            .mean(session, local, &solution.u, &unknowns, copies);
        let (u, weight) = mean?;
        let (residual, contact) = match (&layout.trouble, scene.has_contact()) {
            // Without an assembled problem there is no residual.
            (Some(_), contact) => {
                let rows = || active(session, scene, &solution, &problem.rows);
                let active = contact.then(rows).transpose()?;
                (
                    0.0,
                    active.map(|a| outcome(&solution, problem.rows.list(&a))),
                )
            }
            (None, true) => {
                let active = active(session, scene, &solution, &problem.rows)?;
                let outcome = outcome(&solution, problem.rows.list(&active));
                let residual = close(session, problem, active, &u, &weight)?;
                (residual, Some(outcome))
            }
            (None, false) => (problem.system.relative_residual(&u)?, None),
        };
        let recover = solution.recover_seconds;
        let mut seconds = [solution.solve_seconds + recover, recover];
        max_all(session.comm(), &mut seconds);
        Ok(Attempt {
            residual,
            u,
            converged: solution.converged(),
            outcome: Outcome {
                kappa: solution.estimate.map(|s| s.kappa()),
                iterations: Some(solution.iterations),
                solve: seconds[0],
                recover: Some(seconds[1]),
                contact,
                reason: solution.status.to_string(),
                ..Outcome::default()
            },
        })
    })?;
    attempt.u.save(file)?;
    let again = if job.again && message.is_none() {
        Some(again(session, &mut solver, &layout, rtol)?)
    } else {
        None
    };
    let mut outcome = attempt.report(rtol, message, [assemble, setup, bytes]);
    outcome.again = again;
    if layout.trouble.is_some() {
        outcome.residual = None;
    }
    Ok(outcome)
}

fn outcome(solution: &Solution, active: Vec<usize>) -> ContactOutcome {
    ContactOutcome {
        steps: Some(solution.steps.len()),
        active,
    }
}

/// Seconds of a solve for another load with the existing set-up; the contact loop starts from its initial set.
/// Collective.
fn again(
    session: &Session,
    solver: &mut FetiFeti,
    layout: &UnknownLayout,
    rtol: f64,
) -> Result<f64> {
    let second = SecondLoad::new(layout);
    let problem = solver.problem();
    let load = |s: &Subdomain| -> Vec<f64> {
        let terms = s.f.iter().zip(&s.dofs);
        terms
            .map(|(f, &dof)| f * second.at(layout, layout.index(dof)))
            .collect()
    };
    let loads = problem.local.iter().map(load).collect();
    let gaps: Vec<f64> = problem.rows.iter().map(|r| r.gap).collect();
    solver.set_loads(loads, &gaps);
    solver.ksp().set_tolerances(Some(rtol), None, None, None)?;
    let solution = solver.solve()?;
    // Measured as the first solve: without the certificate.
    let mut seconds = [solution.solve_seconds + solution.recover_seconds];
    max_all(session.comm(), &mut seconds);
    Ok(seconds[0])
}

/// Closes the jumps on the active rows that the iteration has left, by the weighted mean of both sides as on tied
/// faces, and returns the residual. Collective.
fn close(
    session: &Session,
    problem: &AssembledProblem,
    mut active: Vec<bool>,
    u: &PetscVec,
    weight: &PetscVec,
) -> Result<f64> {
    let groups = problem.groups(&mut active);
    let (_, bearing) = problem.bearing(&active);
    let at = |x: &PetscVec| problem.trace.get(session.comm(), x);
    let nearest = groups.nearest(&at(u)?, &at(weight)?);
    problem.trace.set(u, &groups.spread(&nearest))?;
    problem.stationarity(session, &bearing, u)
}

/// The active inequalities and the tangential rows that stick, the same on every rank. Collective.
fn active(
    session: &Session,
    scene: &Scene,
    solution: &Solution,
    rows: &Inequalities,
) -> Result<Vec<bool>> {
    let provided = rows.provided(&distribution::owner(session, scene)?);
    let solved = solution.rows().iter().chain(solution.tangential_rows());
    let held = provided.into_iter().zip(solved).filter(|(_, r)| r.holds());
    let mine: Vec<usize> = held.filter_map(|(k, _)| k).collect();
    Ok(rows.set(&gather_all(session.comm(), &mine).concat()))
}
