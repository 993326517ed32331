//! The messages between the processes of a comparison. The parent writes a [`Job`], starts `mpirun -n R fetifeti
//! baseline JOB` and reads an [`Outcome`] or a [`CaseJudgement`](super::judge::CaseJudgement).

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

/// A task for one process group.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Job {
    /// The scene file.
    pub scene: PathBuf,
    /// The bound for ‖b − A u‖₂ / ‖f‖₂.
    pub rtol: f64,
    /// Reduction of the residual in a contact step while the active set changes, for solvers that iterate on the
    /// assembled problem.
    pub inner: f64,
    /// Whether a method solves once more for another load afterwards, with the same set-up.
    #[serde(default)]
    pub again: bool,
    /// The task.
    pub task: BaselineTask,
}

/// The kinds of task.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum BaselineTask {
    /// Solve by the FETI-FETI method.
    FetiFeti {
        /// Threads per rank.
        threads: usize,
        /// Where the solution goes.
        solution: PathBuf,
    },
    /// Solve by a baseline.
    Baseline {
        /// Its name.
        name: String,
        /// Whether this is the second try.
        rescue: bool,
        /// The active rows, for methods that solve equations only.
        active: Vec<usize>,
        /// Where the solution goes.
        solution: PathBuf,
    },
    /// Solve directly and compare these solutions with it.
    Judge {
        /// Solution files of methods, and the rows active in them.
        solutions: Vec<(PathBuf, Vec<usize>)>,
    },
}

/// A method's report on its run.
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
    /// The part of `solve` for the recovery of displacements from multipliers, where there is one.
    pub recover: Option<f64>,
    /// Seconds of the solve for a second load with the set-up of the first, where one was asked for.
    pub again: Option<f64>,
    /// Largest resident memory, summed over the ranks, in bytes.
    pub memory: f64,
    /// Resident memory, summed over the ranks, in bytes, when PETSc had started and the problem was not read yet.
    pub memory_at_start: f64,
    /// Relative tolerance with which the iteration reached the residual; `None` for a direct solver.
    pub rtol: Option<f64>,
    /// ‖b − A u‖₂ / ‖f‖₂.
    pub residual: Option<f64>,
    /// In scenes with inequalities, the result of the contact loop.
    pub contact: Option<ContactOutcome>,
    /// PETSc's name for why the iteration ended.
    pub reason: String,
    /// One sentence if the residual was not reached.
    pub message: Option<String>,
}

/// The result of the contact loop.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactOutcome {
    /// Number of active sets that were solved for; `None` where the set was given.
    pub steps: Option<usize>,
    /// The active rows at the end, by their index among the inequalities of the scene.
    pub active: Vec<usize>,
}
