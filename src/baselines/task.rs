//! What processes of a comparison say to each other. The parent writes a [`Job`], starts `mpirun -n R fetifeti baseline JOB` and reads an
//! [`Outcome`] or a [`Verdict`](super::judge::Verdict).

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

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

/// How inequalities came out.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactOutcome {
    /// Active sets that were solved for; `None` where the last one was given.
    pub steps: Option<usize>,
    /// The rows of the last one, by their place among the inequalities of the scene.
    pub active: Vec<usize>,
}
