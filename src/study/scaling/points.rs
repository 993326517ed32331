//! The runs of the study: what was solved, where, and what it took.

use serde::{Deserialize, Serialize};

use super::model::Modelled;
use super::quantities::{IterationSeconds, SetupSeconds, Work};
use crate::report::json::Communication;

/// What a run belongs to.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Series {
    /// Ever more bodies of one size, on one rank.
    #[default]
    Bodies,
    /// Subdomains of other sizes, on one rank.
    Elements,
    /// One scene on ever more ranks.
    Strong,
    /// As many bodies as ever per rank.
    Weak,
    /// A body per rank, for the messages of one with eight neighbours.
    Neighbours,
}

impl Series {
    /// As tables say it.
    pub fn name(self) -> &'static str {
        match self {
            Series::Bodies => "bodies",
            Series::Elements => "elements",
            Series::Strong => "strong",
            Series::Weak => "weak",
            Series::Neighbours => "neighbours",
        }
    }
}

/// What is solved.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Problem {
    /// Poisson's equation on tied bodies.
    #[default]
    Tied,
    /// The model contact problem.
    Contact,
}

impl Problem {
    /// As tables say it.
    pub fn name(self) -> &'static str {
        match self {
            Problem::Tied => "tied",
            Problem::Contact => "contact",
        }
    }
}

/// One run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// What it belongs to.
    pub series: Series,
    /// What is solved.
    pub problem: Problem,
    /// MPI ranks.
    pub ranks: usize,
    /// More ranks than cores: messages are right, seconds are not.
    pub oversubscribed: bool,
    /// Whether the costs are fitted to it.
    pub fitted: bool,
    /// Bodies.
    pub bodies: usize,
    /// Those with a kernel.
    pub floating_bodies: usize,
    /// Subdomains over all bodies.
    pub subdomains: usize,
    /// Elements of a subdomain in each direction.
    pub elements: usize,
    /// Rows of B.
    pub multipliers: usize,
    /// Krylov iterations, in all contact steps.
    pub iterations: usize,
    /// Contact steps.
    pub steps: usize,
    /// κ by CG, of the last step.
    pub kappa: Option<f64>,
    /// Seconds of set-up, the slowest rank in each phase.
    pub setup: SetupSeconds,
    /// Seconds of an iteration, likewise; messages: of the rank that waits least.
    pub iteration: IterationSeconds,
    /// Seconds of a solve besides its iterations.
    pub outside: f64,
    /// Wall-clock seconds of set-up and of a solve.
    pub total: [f64; 2],
    /// Resident memory at the end, and before the scene was read, over all ranks, in MB.
    pub memory_mb: [f64; 2],
    /// Largest work of a rank.
    pub work: Work,
    /// What an iteration sends.
    pub communication: Communication,
    /// What the model says.
    pub model: Modelled,
    /// Modelled over measured seconds of set-up, minus one.
    pub setup_deviation: f64,
    /// The same for an iteration.
    pub iteration_deviation: f64,
}
