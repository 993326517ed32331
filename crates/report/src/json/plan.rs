//! The record of `plan`.

use super::{FreeMotion, Multipliers};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The plan of a scene.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct PlanReport {
    /// Name and version of this record: [`PlanReport::SCHEMA`].
    pub schema: String,
    /// Version of fetifeti.
    pub version: String,
    /// The scene's name or file.
    pub scene: String,
    /// 2 or 3.
    pub dimension: usize,
    /// Equation and elements in words.
    pub form: String,
    /// MPI ranks.
    pub ranks: usize,
    /// PETSc options that were set, on the command line, in a file, in the environment or in the scene.
    pub options: BTreeMap<String, String>,
    /// Sentences on parts of the input that are left out, ignored or replaced.
    pub notes: Vec<String>,
    /// Motions that no row holds: a load on one has no answer, and without it the place along it is arbitrary.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub free_motions: Vec<FreeMotion>,
    /// Warnings, a sentence for each circumstance that makes the answer doubtful.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// The bodies.
    pub bodies: Vec<PlannedBody>,
    /// Pairs of bodies that touch or may touch.
    pub interfaces: Vec<PlannedInterface>,
    /// Elements.
    pub elements: usize,
    /// Subdomains over all bodies.
    pub subdomains: usize,
    /// Free degrees of freedom; one shared by subdomains of a body counts once.
    pub dofs: usize,
    /// Unknowns of the assembled problem.
    pub assembled: u64,
    /// Rows of B.
    pub multipliers: Multipliers,
    /// Rows that are inequalities.
    pub inequalities: usize,
    /// Primal constraints over all bodies.
    pub primal: usize,
    /// Number of load steps; `null` without them.
    pub load_steps: Option<usize>,
    /// Different subdomains: each has one factorisation.
    pub kinds: usize,
    /// Different subdomains whose operators are sparse solves.
    pub sparse: usize,
    /// The preconditioner that is used if the user chooses none.
    pub preconditioner: String,
    /// The memory that a solve takes.
    pub memory: PlannedMemory,
}

impl PlanReport {
    /// The value of `schema`.
    pub const SCHEMA: &'static str = "fetifeti.plan/1";
}

/// A body.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct PlannedBody {
    /// Its name.
    pub name: String,
    /// Its elements.
    pub elements: usize,
    /// Its subdomains.
    pub subdomains: usize,
    /// Its free degrees of freedom.
    pub dofs: usize,
    /// Its degrees of freedom with a given value.
    pub prescribed: usize,
    /// Rigid motions (constants in scalar problems) that nothing holds.
    pub floating: usize,
}

/// A pair of bodies.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct PlannedInterface {
    /// Their names.
    pub bodies: [String; 2],
    /// Common nodes.
    pub nodes: usize,
    /// Common nodes that are tied.
    pub tied: usize,
    /// Common nodes that are in contact.
    pub contact: usize,
}

/// MB of 10⁶ bytes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct PlannedMemory {
    /// Sparse factors, counted, over all ranks.
    pub factor_mb: f64,
    /// Dense operators, counted, over all ranks.
    pub dense_mb: f64,
    /// The whole of a solve, estimated, on each rank.
    pub solve_mb: f64,
    /// The memory that is left for each rank; `null` where the system does not say.
    pub available_mb: Option<f64>,
}
