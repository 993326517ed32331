//! The record of `compare`.

use super::number;
use serde::{Deserialize, Serialize};

/// What `compare` reports: facts about the problem, then one row per method and layout.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CompareReport {
    /// The scene's title.
    pub scene: String,
    /// Bodies.
    pub bodies: usize,
    /// Subdomains over all bodies.
    pub subdomains: usize,
    /// Unknowns of the assembled problem: one where tied bodies have several copies.
    pub dofs: usize,
    /// Relative residual ‖b − A u‖₂ / ‖b‖₂ of the assembled problem that every method was driven to.
    #[serde(with = "number")]
    pub rtol: f64,
    /// Cores that methods without a layout of their own were given.
    pub cores: usize,
    /// Rigid motions that nothing in the scene holds: the assembled problem has as many supports, which bear no force.
    #[serde(default)]
    pub supports: usize,
    /// Relative residual of the refined direct solution that errors are measured against; `null` if there is none.
    pub reference_residual: Option<f64>,
    /// In scenes with inequalities: what they are in the direct solution.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<CompareInequalities>,
    /// The methods.
    pub rows: Vec<CompareRow>,
}

/// One method in one layout.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct CompareRow {
    /// The method, such as `fetifeti`, `bddc`, `gamg`.
    pub method: String,
    /// Parts of the domain that the method sees; `null` for methods that see none.
    pub subdomains: Option<usize>,
    /// MPI ranks.
    pub ranks: usize,
    /// Threads per rank.
    pub threads: usize,
    /// κ as CG estimates it; `null` where there is none.
    pub kappa: Option<f64>,
    /// Iterations, of all contact steps; `null` for a direct solver or a run that failed.
    pub iterations: Option<usize>,
    /// Wall-clock time by phase.
    pub seconds: CompareSeconds,
    /// Largest resident memory over the ranks, summed, in MB of 10⁶ bytes.
    pub memory_mb: Option<f64>,
    /// The part of `memory_mb` that was there before the problem: program and libraries, once per rank.
    pub memory_at_start_mb: Option<f64>,
    /// Error in the energy norm against the assembled direct solution, relative.
    pub error: Option<f64>,
    /// Relative residual of the assembled problem that was reached.
    pub residual: Option<f64>,
    /// In scenes with inequalities: how they came out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<CompareContact>,
    /// Relative tolerance of the method's own residual with which that was reached.
    pub rtol: Option<f64>,
    /// Whether the residual was reached.
    pub converged: bool,
    /// PETSc's name for why the iteration ended.
    pub converged_reason: String,
    /// Options with which a second try was made after the first had failed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rescue: Option<String>,
    /// One sentence when the method could not run or did not converge.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
}

/// Inequalities in the direct solution of `compare`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct CompareInequalities {
    /// Inequality rows.
    pub rows: usize,
    /// Those that hold with equality; `null` if there is no direct solution.
    pub active: Option<usize>,
    /// Active sets that the direct solution took.
    pub outer: Option<usize>,
    /// Largest violation, relative to the largest |u|.
    pub feasibility: Option<f64>,
    /// Smallest multiplier, relative to the largest; 0 where none pulls.
    pub min_multiplier: Option<f64>,
    /// Load steps of the scene, of which the last one is solved.
    pub load_steps: usize,
}

/// How the inequalities came out in one row of `compare`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct CompareContact {
    /// Active sets that were solved for; `null` for a method that solved the equations of the last one only.
    pub outer: Option<usize>,
    /// Rows of the last one.
    pub active: usize,
    /// Rows that hold here or in the direct solution, but not in both; rows that touch without a force do not count.
    pub differ: Option<usize>,
    /// Largest violation, relative to the largest |u|.
    pub feasibility: Option<f64>,
    /// Smallest multiplier, relative to the largest; 0 where none pulls.
    pub min_multiplier: Option<f64>,
}

/// Wall-clock seconds of one method in `compare`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct CompareSeconds {
    /// Mesh and matrices.
    pub assemble: Option<f64>,
    /// Factorisations, hierarchies, coarse problems.
    pub setup: Option<f64>,
    /// Iterations and recovery.
    pub solve: Option<f64>,
    /// Set-up and solve.
    pub total: Option<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_known_is_null() {
        let nothing = CompareSeconds {
            assemble: Some(0.5),
            setup: Some(f64::NAN),
            solve: None,
            total: Some(1.0),
        };
        assert_eq!(
            serde_json::to_string(&nothing).unwrap(),
            r#"{"assemble":0.5,"setup":null,"solve":null,"total":1.0}"#
        );
    }
}
