//! The record of `solve`.

use super::adaptive::Adaptive;
use super::certified::Certified;
use super::contact::ContactReport;
use super::number;
use super::probes::{NodePrint, ProbeValue};
use super::spectrum::Condition;
use fetifeti::solution::Communication;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The report of `solve`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SolveReport {
    /// Name and version of this record: [`SolveReport::SCHEMA`].
    #[serde(default)]
    pub schema: String,
    /// Version of fetifeti.
    #[serde(default)]
    pub version: String,
    /// Version of PETSc.
    #[serde(default)]
    pub petsc: String,
    /// Whether the iteration, and with inequalities the contact loop, reached its tolerance.
    #[serde(default)]
    pub converged: bool,
    /// PETSc options that were set, on the command line, in a file, in the environment or in the scene.
    #[serde(default)]
    pub options: BTreeMap<String, String>,
    /// The scene's name or file.
    pub scene: String,
    /// The words of the command line.
    #[serde(default)]
    pub command: Vec<String>,
    /// The scene and the files that it names, with hashes.
    #[serde(default)]
    pub inputs: Vec<Input>,
    /// 2 or 3.
    #[serde(default)]
    pub dimension: usize,
    /// `scalar` or `elasticity`.
    #[serde(default)]
    pub physics: String,
    /// Components of the field.
    #[serde(default)]
    pub components: usize,
    /// Equation and elements in words, such as `plane strain elasticity, Q1, no cure of locking`.
    #[serde(default)]
    pub form: String,
    /// MPI ranks.
    pub ranks: usize,
    /// Threads per rank.
    pub threads: usize,
    /// Bodies.
    pub bodies: usize,
    /// Bodies whose stiffness matrix is singular.
    pub floating_bodies: usize,
    /// Bodies of the method: bodies that are merged count once. 0 in reports of earlier versions.
    #[serde(default)]
    pub groups: usize,
    /// Subdomains over all bodies.
    pub subdomains: usize,
    /// Free degrees of freedom; one shared by subdomains of a body counts once.
    pub dofs: usize,
    /// Rows of B.
    pub multipliers: Multipliers,
    /// Steps of the contact loop; 1 without inequalities.
    pub outer_iterations: usize,
    /// Krylov iterations.
    pub iterations: Iterations,
    /// Extreme eigenvalues of the preconditioned operator.
    pub condition: Condition,
    /// The deflation; absent where nothing was searched for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub adaptive: Option<Adaptive>,
    /// Residuals of the Karush-Kuhn-Tucker conditions.
    pub kkt: Kkt,
    /// Guaranteed bounds of the error, with `-fetifeti_certify` or `-fetifeti_rtol auto`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub certified: Option<Certified>,
    /// The value of the Lagrangian ½ uᵀKu − fᵀu + λᵀ(Bu − c), given values included: at the solution the potential
    /// energy.
    #[serde(with = "number")]
    pub energy: f64,
    /// The contact loop and the contact forces; absent where no sides may touch.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<ContactReport>,
    /// Error against the exact solution, where the scene has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<ErrorNorms>,
    /// Sentences on parts of the input that are left out, ignored or replaced.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
    /// Motions that nothing holds and no load drives: the place along them is arbitrary.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub free_motions: Vec<FreeMotion>,
    /// Warnings, a sentence for each circumstance that makes the answer doubtful; on standard error, too.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// The values at the scene's probes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub probes: Vec<ProbeValue>,
    /// The displacements and forces that a deck prints, step by step.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub node_print: Vec<NodePrint>,
    /// The messages of a Krylov iteration; `null` where there was none.
    #[serde(default)]
    pub communication: Option<Communication>,
    /// Wall-clock time by phase.
    pub seconds: Seconds,
    /// Largest resident memory, summed over the ranks, in MB of 10⁶ bytes.
    #[serde(with = "number")]
    pub memory_mb: f64,
    /// The storage of the subdomains' operators.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub operators: Option<Operators>,
    /// PETSc's name for the reason why the iteration ended, such as `CONVERGED_RTOL`.
    pub converged_reason: String,
    /// Krylov method, such as `cg`.
    pub ksp_type: String,
    /// `none`, `lumped`, `dirichlet` or `coarse_corrected`.
    pub preconditioner: String,
    /// Weights of the scaled jump operator: `rho`, `stiffness`, `multiplicity` or `deluxe`.
    #[serde(default)]
    pub scaling: String,
    /// Factorisation of the subdomains: `multifrontal`, `faer`, `cholmod` or `mumps`.
    #[serde(default)]
    pub local_solver: String,
    /// Its order of elimination: `nd`, `amd`, `metis` or `scotch`.
    #[serde(default)]
    pub local_ordering: String,
    /// Weight Q of the projector: `none` without floating bodies, else `identity`, `diagonal` or `preconditioner`.
    pub projector: String,
    /// How GᵀQG was solved, where options with the prefix `fetifeti_gtg_` have chosen that.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub natural_coarse: Option<NaturalCoarse>,
    /// Relative defects of the operators' identities, with `-fetifeti_check`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub check: Option<BTreeMap<String, f64>>,
    /// Relative tolerance of the inner iteration.
    #[serde(with = "number")]
    pub rtol: f64,
}

/// A solver of GᵀQG that options have chosen.
#[derive(Debug, Clone, Serialize, Deserialize, PartialEq)]
pub struct NaturalCoarse {
    /// KSP and PC.
    pub solver: String,
    /// Whether FGMRES iterates around it, because it is no factorisation.
    pub iterated: bool,
    /// Relative residual of FGMRES.
    pub rtol: Option<f64>,
    /// Iterations of FGMRES for a solution, on average with the rows that hold in the end.
    pub iterations: Option<f64>,
}

impl SolveReport {
    /// The value of `schema`.
    pub const SCHEMA: &'static str = "fetifeti.solve/1";
}

/// A file that a run has read.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Input {
    /// Its path.
    pub file: String,
    /// Its length.
    pub bytes: u64,
    /// The SHA-256 hash of its content, as `sha256sum` prints it.
    pub sha256: String,
}

/// The storage of the subdomains' operators, over all ranks.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Operators {
    /// Number of different subdomains: on each rank, subdomains whose matrices are multiples of each other count once.
    pub kinds: usize,
    /// Number of kinds whose S and T are applied by sparse solves; the others have dense matrices.
    pub sparse: usize,
    /// Number of subdomains with S in single precision (`-fetifeti_precision mixed`).
    #[serde(default)]
    pub single: usize,
    /// MB of sparse factors.
    #[serde(with = "number")]
    pub factor_mb: f64,
    /// MB of S, T, Ψ and Σ.
    #[serde(with = "number")]
    pub dense_mb: f64,
}

/// Numbers of rows of B.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Multipliers {
    /// Rows of B_loc, inside the bodies.
    pub local: usize,
    /// Rows of B_gl, between bodies.
    pub global: usize,
    /// Rows of B_gl that hold in the last contact step.
    pub active: usize,
}

/// Numbers of Krylov iterations.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Iterations {
    /// Per contact step.
    pub inner: Vec<usize>,
    /// Their sum.
    pub total: usize,
}

impl Iterations {
    /// Makes the record from the counts per contact step.
    pub fn new(inner: Vec<usize>) -> Self {
        let total = inner.iter().sum();
        Iterations { inner, total }
    }
}

/// Residuals of the Karush-Kuhn-Tucker conditions, relative to the load and the solution.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Kkt {
    /// ‖Ku + Bᵀλ − f‖ / (‖f‖ + ‖Bᵀλ‖) in the norm of diag(K)⁻¹.
    #[serde(with = "number")]
    pub stationarity: f64,
    /// Largest violation of Bu = c and Bu ≤ c.
    #[serde(with = "number")]
    pub feasibility: f64,
    /// Largest |λ_r (Bu − c)_r| over the inequalities; 0 without any.
    #[serde(with = "number")]
    pub complementarity: f64,
    /// Smallest multiplier of an inequality; `null` without any.
    pub min_multiplier: Option<f64>,
    /// Estimate of the error of u in the energy norm, relative to that of u; `null` where the iteration did not
    /// converge.
    pub error: Option<f64>,
}

impl Kkt {
    /// The record of these residuals.
    pub fn new(kkt: &fetifeti::solution::Kkt, inequalities: bool) -> Kkt {
        Kkt {
            stationarity: kkt.stationarity,
            feasibility: kkt.feasibility,
            complementarity: kkt.complementarity,
            min_multiplier: inequalities.then_some(kkt.min_multiplier),
            error: kkt.error,
        }
    }

    /// The largest residual of stationarity, feasibility and complementarity.
    pub fn largest(&self) -> f64 {
        let larger = self.stationarity.max(self.feasibility);
        larger.max(self.complementarity)
    }
}

/// Error against an exact solution.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ErrorNorms {
    /// L² norm.
    #[serde(with = "number")]
    pub l2: f64,
    /// H¹ seminorm.
    #[serde(with = "number")]
    pub h1: f64,
    /// Energy norm of the error; a norm, in contrast to the `energy` of the report.
    #[serde(rename = "energy", with = "number")]
    pub energy_norm: f64,
}

/// Wall-clock seconds of `solve` by phase; `total` is their sum.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Seconds {
    /// Files, checks, subdomains and rows.
    #[serde(default)]
    pub read: f64,
    /// Matrices and loads.
    pub assemble: f64,
    /// Factorisations and coarse problems, also those between load steps.
    pub setup: f64,
    /// Iterations.
    pub solve: f64,
    /// The recovery of u from λ.
    pub recover: f64,
    /// The certificate, balances, probes, spectra and checks of the solution.
    #[serde(default)]
    pub evaluate: f64,
    /// Fields and pictures.
    #[serde(default)]
    pub write: f64,
    /// The whole run but for this report.
    pub total: f64,
}

impl Seconds {
    /// The run has taken `total`; what no other phase took is evaluation.
    pub fn end(&mut self, total: f64) {
        let Seconds {
            read,
            assemble,
            setup,
            solve,
            recover,
            write,
            ..
        } = *self;
        let others = read + assemble + setup + solve + recover + write;
        self.evaluate = (total - others).max(0.0);
        self.total = total;
    }
}

#[cfg(test)]
#[path = "../../tests/json/solve.rs"]
mod tests;

/// A motion that nothing holds.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct FreeMotion {
    /// The bodies that move.
    pub bodies: Vec<String>,
    /// The motion in words, such as "slides along x".
    pub motion: String,
}
