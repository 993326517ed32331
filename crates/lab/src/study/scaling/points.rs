//! The runs of the study: the problem, the ranks, and the measurements.

use serde::{Deserialize, Serialize};

use super::model::Modelled;
use super::quantities::{IterationSeconds, SetupSeconds, Work};
use fetifeti::solution::Communication;

/// The series that a run belongs to.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ScalingSeries {
    /// An increasing number of bodies of one size, on one rank.
    #[default]
    Bodies,
    /// Subdomains of other sizes, on one rank.
    Elements,
    /// One scene on an increasing number of ranks.
    Strong,
    /// A fixed number of bodies per rank.
    Weak,
    /// A body per rank, to count the messages of a body with eight neighbours.
    Neighbours,
}

impl ScalingSeries {
    /// The word for tables.
    pub fn name(self) -> &'static str {
        match self {
            ScalingSeries::Bodies => "bodies",
            ScalingSeries::Elements => "elements",
            ScalingSeries::Strong => "strong",
            ScalingSeries::Weak => "weak",
            ScalingSeries::Neighbours => "neighbours",
        }
    }
}

/// The problem of a run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ScalingProblem {
    /// Poisson's equation on tied bodies.
    #[default]
    Tied,
    /// The model contact problem.
    Contact,
}

impl ScalingProblem {
    /// The word for tables.
    pub fn name(self) -> &'static str {
        match self {
            ScalingProblem::Tied => "tied",
            ScalingProblem::Contact => "contact",
        }
    }
}

/// One run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ScalingPoint {
    /// The series.
    pub series: ScalingSeries,
    /// The problem.
    pub problem: ScalingProblem,
    /// MPI ranks.
    pub ranks: usize,
    /// Whether there are more ranks than cores: then messages are right, seconds are not.
    pub oversubscribed: bool,
    /// Whether the model is fitted to this run.
    pub fitted: bool,
    /// Bodies.
    pub bodies: usize,
    /// Number of bodies with a kernel.
    pub floating_bodies: usize,
    /// Subdomains over all bodies.
    pub subdomains: usize,
    /// Elements of a subdomain in each direction.
    pub elements: usize,
    /// Rows of B.
    pub multipliers: usize,
    /// Krylov iterations of all contact steps.
    pub iterations: usize,
    /// Contact steps.
    pub steps: usize,
    /// κ by CG, of the last step.
    pub kappa: Option<f64>,
    /// Seconds of set-up, the slowest rank in each phase.
    pub setup: SetupSeconds,
    /// Seconds of an iteration, the slowest rank in each phase; for messages, the rank that waits least.
    pub iteration: IterationSeconds,
    /// Seconds of a solve besides its iterations.
    pub outside: f64,
    /// Wall-clock seconds of set-up and of a solve.
    pub total: [f64; 2],
    /// Resident memory at the end, and before the scene was read, over all ranks, in MB.
    pub memory_mb: [f64; 2],
    /// Largest work of a rank.
    pub work: Work,
    /// The messages of an iteration.
    pub communication: Communication,
    /// The model's seconds.
    pub model: Modelled,
    /// Modelled over measured seconds of set-up, minus one.
    pub setup_deviation: f64,
    /// Modelled over measured seconds of an iteration, minus one.
    pub iteration_deviation: f64,
}
