//! The messages between the processes of a comparison. The parent writes a [`Job`], starts `mpirun -n R fetifeti
//! baseline JOB` and reads an [`Outcome`] or a [`CaseJudgement`](super::judge::CaseJudgement).

use std::path::{Path, PathBuf};

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
        /// Whether tied bodies are one.
        merges: bool,
        /// Where the solution goes.
        solution: PathBuf,
    },
    /// Solve by a baseline.
    Baseline {
        /// Its name.
        name: String,
        /// Whether this is the second try.
        rescue: bool,
        /// Whether each subdomain of a rank is a part of its own, for methods on the unassembled matrix.
        separate: bool,
        /// The active rows, for methods that solve equations only.
        active: Vec<usize>,
        /// Where the solution goes.
        solution: PathBuf,
    },
    /// Solve directly and compare these solutions with it.
    Judge {
        /// For each method the solutions that it has left.
        solutions: Vec<Vec<StepFile>>,
    },
}

/// The solution of a load step that a method has left: the file, and the rows that are active in it.
pub type StepFile = (PathBuf, Vec<usize>);

/// The file for the solution of load step `step`, counted among those that are solved, of a method whose first one is
/// in `file`.
pub fn step_file(file: &Path, step: usize) -> PathBuf {
    match step {
        0 => file.to_path_buf(),
        later => file.with_extension(format!("{later}.u")),
    }
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
    /// In scenes with inequalities, the result of the contact loop; of several load steps all active sets, and the
    /// active rows of the last one.
    pub contact: Option<ContactOutcome>,
    /// Where several load steps are solved, each of them.
    #[serde(default)]
    pub load_steps: Vec<StepOutcome>,
    /// PETSc's name for why the iteration ended.
    pub reason: String,
    /// One sentence if the residual was not reached.
    pub message: Option<String>,
}

/// A method's report on a load step.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct StepOutcome {
    /// Iterations of all contact steps; `None` for a direct solver.
    pub iterations: Option<usize>,
    /// Seconds of matrices and preconditioners.
    pub setup: f64,
    /// Seconds of everything else.
    pub solve: f64,
    /// ‖b − A u‖₂ / ‖f‖₂.
    pub residual: f64,
    /// The result of the contact loop.
    pub contact: ContactOutcome,
}

/// The result of the contact loop.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactOutcome {
    /// Number of active sets that were solved for; `None` where the set was given.
    pub steps: Option<usize>,
    /// The active rows at the end, by their index among the inequalities of the scene.
    pub active: Vec<usize>,
}
