//! What the command line may say; [`parse`] reads it.

use std::path::PathBuf;

pub use super::parse::parse;
pub use super::usage::USAGE;
use crate::baselines::{Benchmark, Comparison};

/// A command with its arguments.
#[derive(Debug, Clone, PartialEq)]
pub enum Command {
    /// Print the usage.
    Help,
    /// Print the version.
    Version,
    /// Solve one scene.
    Solve(Solve),
    /// Say what would be built.
    Plan {
        /// The scene file.
        scene: PathBuf,
    },
    /// Redo Table 1.
    Table1(Table1),
    /// Run the baselines.
    Compare(Comparison),
    /// Run the baselines in rounds.
    Bench(Benchmark),
    /// Say which cases `bench` has.
    BenchList,
    /// Run a study.
    Study(Study),
    /// One method of a comparison, in a process of its own (not for users).
    Baseline {
        /// What to run, as the parent process wrote it.
        job: PathBuf,
    },
    /// One measurement of a study, in a process of its own (not for users).
    Measure {
        /// What to measure, as the parent process wrote it.
        task: PathBuf,
    },
}

/// Arguments of `solve`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Solve {
    /// The scene file.
    pub scene: PathBuf,
    /// Directory for results.
    pub out: Option<PathBuf>,
    /// File for the JSON report.
    pub json: Option<PathBuf>,
    /// No summary.
    pub quiet: bool,
    /// File for the state of the contact loop.
    pub checkpoint: Option<PathBuf>,
    /// File with a state to go on from.
    pub resume: Option<PathBuf>,
}

/// Arguments of `table1`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Table1 {
    /// (1/H_b, H_b/H_s, H_s/h); empty for the paper's 20 rows.
    pub rows: Vec<[usize; 3]>,
    /// Directory for CSV, JSON and figures.
    pub out: Option<PathBuf>,
    /// File for the JSON.
    pub json: Option<PathBuf>,
    /// No table.
    pub quiet: bool,
}

/// The studies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StudyName {
    /// Condition numbers that the user chooses, on coefficients that jump inside bodies.
    Adaptive,
    /// Half-width and peak pressure against Hertz's theory.
    Hertz,
    /// Problems that are hard for the method, against direct solutions.
    HardCases,
    /// Condition numbers with M_D and M_C.
    Kappa,
    /// Local solvers and orderings.
    Kernels,
    /// Seconds over ranks and bodies, with a model.
    Scaling,
    /// Error against seconds, ours and every baseline.
    SpeedError,
}

impl StudyName {
    /// All of them.
    pub const ALL: [StudyName; 7] = [
        StudyName::Adaptive,
        StudyName::Hertz,
        StudyName::HardCases,
        StudyName::Kappa,
        StudyName::Kernels,
        StudyName::Scaling,
        StudyName::SpeedError,
    ];

    /// As it is written.
    pub fn name(self) -> &'static str {
        match self {
            StudyName::Adaptive => "adaptive",
            StudyName::Hertz => "hertz",
            StudyName::HardCases => "hard-cases",
            StudyName::Kappa => "kappa",
            StudyName::Kernels => "kernels",
            StudyName::Scaling => "scaling",
            StudyName::SpeedError => "speed-error",
        }
    }
}

/// Arguments of `study`.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// Which one.
    pub name: StudyName,
    /// The one of its cases that is run; `None`: all.
    pub case: Option<String>,
    /// File for the JSON.
    pub json: Option<PathBuf>,
    /// Directory for tables and pictures.
    pub out: Option<PathBuf>,
    /// Coarser meshes, smaller cases.
    pub quick: bool,
    /// No table.
    pub quiet: bool,
}

/// What was written: a command and the options that are PETSc's.
#[derive(Debug, Clone, PartialEq)]
pub struct Invocation {
    /// The command.
    pub command: Command,
    /// Arguments for PetscInitialize.
    pub petsc: Vec<String>,
}
