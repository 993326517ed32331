//! What one process group of a comparison does: one method on one scene, or the judgement of all solutions.
//!
//! The parent writes a [`Job`], starts `mpirun -n R fetifeti baseline JOB` and reads an [`Outcome`] or a [`Verdict`]. A method leaves
//! its solution in a file, in the order of [`Numbering`]; the judge holds all of them against one assembled matrix and one
//! direct solution, so that nobody measures himself.

use std::path::{Path, PathBuf};
use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::attempt::Attempt;
use super::judge::judge;
use super::table::{Baseline, Case, Format};
use super::{contact, linear, ours};
use crate::cli::problem;
use crate::parallel::exchange::{max_all, sum_all};
use crate::petsc::{max_memory, Session};
use crate::report::json;
use crate::{Error, Result};

/// A task for one process group.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Job {
    /// The scene file.
    pub scene: PathBuf,
    /// Where the result goes, as JSON.
    pub result: PathBuf,
    /// ‖b − A u‖₂ / ‖f‖₂ to be reached.
    pub rtol: f64,
    /// Reduction of the residual in a contact step while the active set changes, for solvers that iterate on the assembled problem.
    pub inner: f64,
    /// Whether a method, when it is done, solves once more for another load, with what it has set up.
    #[serde(default)]
    pub again: bool,
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
        /// Rows of the active set for which a method that solves equations only does so.
        active: Vec<usize>,
        /// Where the solution goes.
        solution: PathBuf,
    },
    /// Solve directly and compare these solutions with it.
    Judge {
        /// Solutions that methods have left, and the rows active in them.
        solutions: Vec<(PathBuf, Vec<usize>)>,
    },
}

/// What a method reports of itself.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// κ by CG.
    pub kappa: Option<f64>,
    /// Iterations of the solve, in all contact steps; `None` for a direct solver.
    pub iterations: Option<usize>,
    /// Seconds for mesh and matrices.
    pub assemble: f64,
    /// Seconds of set-up.
    pub setup: f64,
    /// Seconds of the solve.
    pub solve: f64,
    /// The part of `solve` for the way from multipliers to displacements, where there is one.
    pub recover: Option<f64>,
    /// Seconds of the solve for a second load, where one was asked for: with all that was set up for the first.
    pub again: Option<f64>,
    /// Largest resident memory, summed over the ranks, in bytes.
    pub memory: f64,
    /// The same when PETSc had started and the problem was not read yet.
    pub memory_at_start: f64,
    /// Relative tolerance with which the iteration reached the residual; `None` for a direct solver.
    pub rtol: Option<f64>,
    /// ‖b − A u‖₂ / ‖f‖₂.
    pub residual: Option<f64>,
    /// In scenes with inequalities, how they came out.
    pub contact: Option<ContactOutcome>,
    /// PETSc's name for why the iteration ended.
    pub reason: String,
    /// One sentence when the residual was not reached.
    pub message: Option<String>,
}

impl Outcome {
    /// From the solve that counts, its own tolerance, what there is to say if the target was missed, and the seconds of assembly and set-up and
    /// the memory.
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

/// How inequalities came out.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactOutcome {
    /// Active sets that were solved for; `None` where the last one was given.
    pub steps: Option<usize>,
    /// The rows of the last one, by their place among the inequalities of the scene.
    pub active: Vec<usize>,
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
            ours::solve(session, &scene, &job, *threads, solution)?
        }
        Task::Baseline {
            name,
            rescue,
            active,
            solution,
        } => {
            let row = Baseline::named(name)
                .ok_or_else(|| Error::input(format!("there is no baseline \"{name}\"")))?;
            let case = Case {
                rescue: *rescue,
                ..Case::of(&scene)
            };
            row.set_options(session, job.rtol, case)?;
            match row.format {
                Format::Assembled if scene.has_contact() => {
                    contact::baseline(session, &scene, &job, row, solution)?
                }
                _ => linear::baseline(session, &scene, &job, row, active, solution)?,
            }
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
pub(crate) fn timed<T>(session: &Session, work: impl FnOnce() -> Result<T>) -> Result<(T, f64)> {
    session.agree(Ok(()))?;
    let clock = Instant::now();
    let result = work()?;
    let mut seconds = [clock.elapsed().as_secs_f64()];
    max_all(session.comm(), &mut seconds);
    Ok((result, seconds[0]))
}

/// Largest resident memory of all ranks, in bytes, without the segments through which ranks of one machine pass messages: they show up in
/// every rank that has them mapped, and are MPI's.
pub(crate) fn memory(session: &Session) -> f64 {
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
