//! What one process group of a comparison does: one method on one scene, or the judgement of all solutions.
//!
//! The parent writes a [`Job`], starts `mpirun -n R fetifeti baseline JOB` and reads an [`Outcome`] or a [`Verdict`]. A method leaves
//! its solution in a file, in the order of [`Numbering`]; the judge holds all of them against one assembled matrix and one
//! direct solution, so that nobody measures himself.

use std::path::{Path, PathBuf};
use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::attempt::{solve_to, Attempt};
use super::system::System;
use super::table::{Baseline, Format};
use crate::cli::problem;
use crate::feti::exchange::{max_all, sum_all};
use crate::feti::{FetiFeti, Settings};
use crate::petsc::{max_memory, Comm, Ksp, Options, Session};
use crate::report::json;
use crate::scene::{Numbering, Scene};
use crate::{Error, Result};

/// A task for one process group.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Job {
    /// The scene file.
    pub scene: PathBuf,
    /// Where the result goes, as JSON.
    pub result: PathBuf,
    /// ‖b − A u‖₂ / ‖b‖₂ to be reached.
    pub rtol: f64,
    /// What to do.
    pub task: Task,
}

/// What to do.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum Task {
    /// Solve by the FETI-FETI method.
    FetiFeti {
        /// Threads per rank.
        threads: usize,
        /// Where the solution goes.
        solution: PathBuf,
    },
    /// Solve by a row of the table.
    Baseline {
        /// Its name.
        name: String,
        /// Whether this is the second try.
        rescue: bool,
        /// Where the solution goes.
        solution: PathBuf,
    },
    /// Solve directly and compare these solutions with it.
    Judge {
        /// Solutions that methods have left.
        solutions: Vec<PathBuf>,
    },
}

/// What a method reports of itself.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// κ by CG.
    pub kappa: Option<f64>,
    /// Iterations of the solve; `None` for a direct solver.
    pub iterations: Option<usize>,
    /// Seconds for mesh and matrices.
    pub assemble: f64,
    /// Seconds of set-up.
    pub setup: f64,
    /// Seconds of the solve.
    pub solve: f64,
    /// Largest resident memory, summed over the ranks, in bytes.
    pub memory: f64,
    /// The same when PETSc had started and the problem was not read yet.
    pub memory_at_start: f64,
    /// Relative tolerance with which the iteration reached the residual; `None` for a direct solver.
    pub rtol: Option<f64>,
    /// ‖b − A u‖₂ / ‖b‖₂.
    pub residual: Option<f64>,
    /// PETSc's name for why the iteration ended.
    pub reason: String,
    /// One sentence when the residual was not reached.
    pub message: Option<String>,
}

/// What the judge says.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// Relative residual of the direct solution.
    pub residual: Option<f64>,
    /// For every solution the relative error in the energy norm and the relative residual.
    pub solutions: Vec<[Option<f64>; 2]>,
}

/// Runs the job that `file` describes. Collective.
///
/// # Errors
/// Those of the scene, of the method, and of the disk.
pub fn run(session: &Session, file: &Path) -> Result<()> {
    let read = || -> std::result::Result<Job, String> {
        let text = std::fs::read_to_string(file).map_err(|e| e.to_string())?;
        serde_json::from_str(&text).map_err(|e| e.to_string())
    };
    let job = session.agree(read().map_err(|e| {
        let file = file.display();
        Error::input(format!(
            "{file}: {e}, expected a job that compare has written"
        ))
    }))?;
    let memory_at_start = memory(session);
    let scene = problem::load(session, &job.scene)?;
    let outcome = match &job.task {
        Task::FetiFeti { threads, solution } => {
            feti_feti(session, &scene, &job, *threads, solution)?
        }
        Task::Baseline {
            name,
            rescue,
            solution,
        } => {
            let row = Baseline::named(name)
                .ok_or_else(|| Error::input(format!("there is no baseline \"{name}\"")))?;
            row.set_options(session, job.rtol, *rescue)?;
            baseline(session, &scene, &job, row, solution)?
        }
        Task::Judge { solutions } => {
            let verdict = judge(session, &scene, solutions)?;
            return write(session, &job.result, &verdict);
        }
    };
    write(
        session,
        &job.result,
        &Outcome {
            memory_at_start,
            ..outcome
        },
    )
}

fn write<T: Serialize>(session: &Session, path: &Path, record: &T) -> Result<()> {
    let written = if session.rank() == 0 {
        json::write(path, record)
    } else {
        Ok(())
    };
    session.agree(written)
}

/// Wall-clock seconds of some work, from when the first rank begins to when the last one ends. Collective.
fn timed<T>(session: &Session, work: impl FnOnce() -> Result<T>) -> Result<(T, f64)> {
    session.agree(Ok(()))?;
    let clock = Instant::now();
    let result = work()?;
    let mut seconds = [clock.elapsed().as_secs_f64()];
    max_all(session.comm(), &mut seconds);
    Ok((result, seconds[0]))
}

/// Largest resident memory of all ranks, in bytes, without the segments through which ranks of one machine pass messages: they show up in
/// every rank that has them mapped, and are MPI's.
fn memory(session: &Session) -> f64 {
    let mut bytes = [max_memory() - shared_memory()];
    sum_all(session.comm(), &mut bytes);
    bytes[0]
}

/// Resident memory that this process shares with others, in bytes; zero where the system does not tell.
fn shared_memory() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("RssShmem:"));
    let kilobytes = line.and_then(|l| l.trim().trim_end_matches("kB").trim().parse().ok());
    1024.0 * kilobytes.unwrap_or(0.0)
}

/// A row of the table on the unassembled or the assembled matrix.
fn baseline(
    session: &Session,
    scene: &Scene,
    job: &Job,
    row: &Baseline,
    file: &Path,
) -> Result<Outcome> {
    let (system, assemble) = timed(session, || {
        System::new(session, scene, &Numbering::new(scene), row.format)
    })?;
    let ksp = Ksp::new(session, Comm::World)?;
    ksp.set_operators(&system.a, &system.a)?;
    ksp.set_options_prefix(&row.prefix())?;
    ksp.set_from_options()?;
    // The solver that iterates: KSPFETIDP hands over to one inside.
    let krylov = match ksp.type_name()?.as_str() {
        "fetidp" => ksp.fetidp_inner_ksp()?,
        _ => ksp.clone(),
    };
    // KSPFETIDP hands this on when it is set up, over what the inner solver was told.
    ksp.set_compute_singular_values(true)?;
    krylov.set_compute_singular_values(true)?;
    let ((), setup) = timed(session, || ksp.setup())?;
    let first = krylov.tolerances()?.0;
    let direct = krylov.type_name()? == "preonly";
    krylov.record_residuals(1)?;
    let (attempt, rtol, message) = solve_to(job.rtol, first, |rtol| {
        krylov.set_tolerances(Some(rtol), None, None, None)?;
        let u = system.b.duplicate()?;
        let ((), mut seconds) = timed(session, || ksp.solve(&system.b, &u))?;
        let mut reason = krylov.converged_reason()?;
        if !reason.converged() && !row.krylov.is_empty() {
            // Parts that mirror each other need no multipliers: the first residual is rounding, and iterating on it goes astray.
            // Whether that is so, the assembled residual tells.
            let zero = krylov.residual_history()?.first().map(|r| 2.0 * r);
            krylov.set_tolerances(None, zero, None, None)?;
            let trial = u.duplicate()?;
            let ((), more) = timed(session, || ksp.solve(&system.b, &trial))?;
            krylov.set_tolerances(None, Some(0.0), None, None)?;
            if system.relative_residual(&trial)? <= job.rtol {
                u.copy_from(&trial)?;
                (reason, seconds) = (krylov.converged_reason()?, more);
            }
        }
        let iterations = krylov.iterations()?;
        let kappa = match krylov.type_name()?.as_str() {
            "cg" if iterations > 0 => {
                let (large, small) = krylov.extreme_singular_values()?;
                // An iteration that goes on after it has found the solution sees rounding as an eigenvalue.
                (small > 1e-13 * large).then(|| large / small)
            }
            _ => None,
        };
        Ok(Attempt {
            residual: system.relative_residual(&u)?,
            u,
            kappa,
            iterations: (!direct).then_some(iterations),
            seconds,
            converged: reason.converged(),
            reason: reason.name,
        })
    })?;
    let memory = memory(session);
    attempt.u.save(file)?;
    Ok(outcome(attempt, rtol, message, [assemble, setup, memory]))
}

fn outcome(
    attempt: Attempt,
    rtol: f64,
    message: Option<String>,
    [assemble, setup, memory]: [f64; 3],
) -> Outcome {
    Outcome {
        kappa: attempt.kappa,
        iterations: attempt.iterations,
        assemble,
        setup,
        solve: attempt.seconds,
        memory,
        memory_at_start: 0.0,
        rtol: attempt.iterations.is_some().then_some(rtol),
        residual: Some(attempt.residual),
        reason: attempt.reason,
        message,
    }
}

/// Ours.
fn feti_feti(
    session: &Session,
    scene: &Scene,
    job: &Job,
    threads: usize,
    file: &Path,
) -> Result<Outcome> {
    Options::new(session, "fetifeti_").set_default("threads", &threads.to_string())?;
    let (substructures, assemble) = timed(session, || problem::substructures(session, scene))?;
    let settings = Settings {
        rtol: job.rtol,
        ..Settings::default()
    };
    let (solver, setup) = timed(session, || FetiFeti::new(session, substructures, settings))?;
    // The assembled matrix is for the residual only: what it needs does not count.
    let mut system: Option<(System, Numbering)> = None;
    let mut bytes = 0.0;
    let (attempt, rtol, message) = solve_to(job.rtol, job.rtol, |rtol| {
        solver.ksp().set_tolerances(Some(rtol), None, None, None)?;
        let (solution, _) = timed(session, || solver.solve())?;
        if system.is_none() {
            bytes = memory(session);
            let numbering = Numbering::new(scene);
            let built = System::new(session, scene, &numbering, Format::Unassembled)?;
            system = Some((built, numbering));
        }
        let (system, numbering) = system.as_ref().expect("it was built above");
        let u = system.mean(session, &solver.problem().local, &solution.u, numbering)?;
        let mut seconds = [solution.solve_seconds + solution.recover_seconds];
        max_all(session.comm(), &mut seconds);
        Ok(Attempt {
            residual: system.relative_residual(&u)?,
            u,
            kappa: solution.estimate.map(|s| s.kappa()),
            iterations: Some(solution.iterations),
            seconds: seconds[0],
            converged: solution.converged,
            reason: solution.reason,
        })
    })?;
    attempt.u.save(file)?;
    Ok(outcome(attempt, rtol, message, [assemble, setup, bytes]))
}

/// A direct solution with iterative refinement, and the distance of the others from it.
fn judge(session: &Session, scene: &Scene, solutions: &[PathBuf]) -> Result<Verdict> {
    const REFINEMENTS: usize = 2;
    let system = System::new(session, scene, &Numbering::new(scene), Format::Assembled)?;
    let ksp = Ksp::new(session, Comm::World)?;
    ksp.set_operators(&system.a, &system.a)?;
    ksp.set_type("preonly")?;
    let pc = ksp.pc()?;
    pc.set_type("cholesky")?;
    pc.set_solver_type("mumps")?;
    let u = system.b.duplicate()?;
    let (r, d) = (u.duplicate()?, u.duplicate()?);
    ksp.solve(&system.b, &u)?;
    for _ in 0..REFINEMENTS {
        system.residual(&u, &r)?;
        ksp.solve(&r, &d)?;
        u.axpy(1.0, &d)?;
    }
    let size = system.energy_norm(&u)?;
    let mut verdict = Verdict {
        residual: Some(system.relative_residual(&u)?),
        solutions: Vec::new(),
    };
    for file in solutions {
        d.load(file)?;
        let residual = system.relative_residual(&d)?;
        d.axpy(-1.0, &u)?;
        let distance = system.energy_norm(&d)?;
        let error = if size > 0.0 {
            distance / size
        } else {
            distance
        };
        verdict.solutions.push([Some(error), Some(residual)]);
    }
    Ok(verdict)
}
