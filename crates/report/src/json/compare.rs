//! The record of `compare`, and what it shares with that of `bench`.

use super::number;
use serde::{Deserialize, Serialize};

/// The report of `compare`: facts about the problem, then one row per method and layout.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CompareReport {
    /// The scene and its direct solution.
    #[serde(flatten)]
    pub facts: ComparedScene,
    /// Number of cores given to methods without a layout of their own.
    pub cores: usize,
    /// Number of rigid motions that nothing in the scene holds. The assembled problem has the same number of supports,
    /// which bear no force.
    #[serde(default)]
    pub supports: usize,
    /// The methods.
    pub rows: Vec<CompareRow>,
}

/// A scene on which methods are compared, and its direct solution.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ComparedScene {
    /// The scene's title.
    pub scene: String,
    /// Bodies.
    pub bodies: usize,
    /// Subdomains over all bodies.
    pub subdomains: usize,
    /// Unknowns of the assembled problem; the copies of a point of tied bodies are one unknown.
    pub dofs: usize,
    /// Target for every method: the relative residual ‖b − A u‖₂ / ‖b‖₂ of the assembled problem.
    #[serde(with = "number")]
    pub rtol: f64,
    /// Relative residual of the refined direct solution that errors are measured against; `null` if there is none.
    pub reference_residual: Option<f64>,
    /// In scenes with inequalities: their state in the direct solution.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<CompareInequalities>,
}

/// One method in one layout.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct CompareRow {
    /// The method and its result.
    #[serde(flatten)]
    pub run: MethodRun,
    /// Wall-clock time by phase.
    pub seconds: PhaseSeconds<f64>,
    /// Largest resident memory over the ranks, summed, in MB of 10⁶ bytes.
    pub memory_mb: Option<f64>,
    /// The part of `memory_mb` that was used before the problem was read: program and libraries, once per rank.
    pub memory_at_start_mb: Option<f64>,
}

/// A method in one layout, and the result of its run; in `bench` of the first round.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct MethodRun {
    /// The method, such as `fetifeti`, `bddc`, `gamg`.
    pub method: String,
    /// How the method uses the machine: `threads` or `ranks` for ours, for the others a rank per `core`, `body` or
    /// `subdomain`, or `packed`: a rank per core, whose MATIS keeps its subdomains apart.
    #[serde(default)]
    pub layout: String,
    /// Number of parts of the domain for the method; `null` for methods without parts.
    pub subdomains: Option<usize>,
    /// MPI ranks.
    pub ranks: usize,
    /// Threads per rank.
    pub threads: usize,
    /// CG's estimate of κ; `null` where there is none.
    pub kappa: Option<f64>,
    /// Iterations of all contact steps; `null` for a direct solver or a run that failed.
    pub iterations: Option<usize>,
    /// Relative error in the energy norm against the assembled direct solution.
    pub error: Option<f64>,
    /// The relative residual of the assembled problem that was reached.
    pub residual: Option<f64>,
    /// In scenes with inequalities: their state in this method's solution.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<CompareContact>,
    /// Where several load steps are solved: the distance from our solution in the energy norm, relative to that.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_ours: Option<f64>,
    /// Where several load steps are solved, each of them; what stands beside them is then their sum, or the worst of
    /// them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub load_steps: Vec<CompareStep>,
    /// Relative tolerance of the method's own residual in the run that reached `residual`.
    pub rtol: Option<f64>,
    /// Whether the residual was reached; in `bench` in every round. A method that did not reach it is not run again.
    pub converged: bool,
    /// PETSc's name for the reason why the iteration ended; in `bench` the last one.
    pub converged_reason: String,
    /// The options of PETSc that it ran with, those of a second try among them, as a user would write them in a program
    /// of his own; for ours those that the user gave.
    #[serde(default)]
    pub options: String,
    /// The functions of PETSc by which a baseline is told more than options say.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub given: String,
    /// Options of the second try, where the first one failed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rescue: Option<String>,
    /// One sentence if the method could not run or did not converge.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
}

impl MethodRun {
    /// Whether this is our method.
    pub fn is_ours(&self) -> bool {
        self.method == "fetifeti"
    }

    /// Whether the method solves only the equations of an active set that another method has found.
    pub fn set_given(&self) -> bool {
        self.contact.is_some_and(|c| c.outer.is_none())
    }
}

/// A load step of a method.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct CompareStep {
    /// Iterations of all contact steps; `null` for a direct solver.
    pub iterations: Option<usize>,
    /// Seconds of set-up within the step.
    pub setup: Option<f64>,
    /// Seconds of everything else.
    pub solve: Option<f64>,
    /// Relative error in the energy norm against the assembled direct solution.
    pub error: Option<f64>,
    /// The relative residual of the assembled problem.
    pub residual: Option<f64>,
    /// The distance from our solution in the energy norm, relative to that.
    pub from_ours: Option<f64>,
    /// The state of the inequalities.
    #[serde(flatten)]
    pub contact: CompareContact,
}

/// The inequalities in the direct solution of `compare`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct CompareInequalities {
    /// Number of inequality rows.
    pub rows: usize,
    /// Number of rows that hold with equality; `null` if there is no direct solution.
    pub active: Option<usize>,
    /// Number of active sets on the way to the direct solution.
    pub outer: Option<usize>,
    /// Largest violation, relative to the largest |u|.
    pub feasibility: Option<f64>,
    /// Smallest multiplier, relative to the largest; 0 where none pulls.
    pub min_multiplier: Option<f64>,
    /// With friction or soft contact: the largest distance of a force from its law, relative to the largest multiplier.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub law: Option<f64>,
    /// Number of load steps of the scene.
    pub load_steps: usize,
    /// Number of load steps that are solved: with friction all, else the last one.
    #[serde(default)]
    pub solved: usize,
}

/// The state of the inequalities in one row of `compare`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct CompareContact {
    /// Number of active sets that were solved for; `null` for a method that only solved the equations of the last set.
    pub outer: Option<usize>,
    /// Number of active rows at the end.
    pub active: usize,
    /// Number of rows that are active in this solution or in the direct one, but not in both; rows that touch without a
    /// force do not count.
    pub differ: Option<usize>,
    /// Largest violation, relative to the largest |u|.
    pub feasibility: Option<f64>,
    /// Smallest multiplier, relative to the largest; 0 where none pulls.
    pub min_multiplier: Option<f64>,
    /// With friction or soft contact: the largest distance of a force from its law, relative to the largest multiplier.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub law: Option<f64>,
    /// With friction or soft contact: the largest difference of a multiplier from the direct solution, relative to the
    /// largest one there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub forces: Option<f64>,
}

/// Wall-clock seconds by phase; each is a number, or the spread of several.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct PhaseSeconds<T> {
    /// Mesh and matrices; not part of the total.
    pub assemble: Option<T>,
    /// Factorisations, hierarchies, coarse problems.
    pub setup: Option<T>,
    /// Iterations and recovery.
    pub solve: Option<T>,
    /// Set-up and solve.
    pub total: Option<T>,
}

#[cfg(test)]
#[path = "../../tests/json/compare.rs"]
mod tests;
