//! `study adaptive`: condition numbers below a bound that the user chooses, on coefficients that jump inside bodies.
//!
//! Every case is a scene file with its coefficients in a second file. It is solved without deflation and with each τ,
//! to the same residual; exact spectra are SLEPc's. Errors are distances from a direct solution with residuals in twice
//! the working precision, and are compared with the error of MUMPS on the same problem. PCBDDC with its own adaptive
//! constraints runs on the same scenes.
//!
//! Cases are not tuned to pass: the purpose of the study is to find bounds that are missed, and the result names them.

mod cases;
mod fields;
mod measure;
mod table;

pub use cases::{cases, AdaptiveCase, CaseEquations, Meshes};
pub use fields::CoefficientField;
pub use table::{fine, table, text};

use std::path::Path;

use serde::{Deserialize, Serialize};

use base::Result;
use petsc::Session;
use report::tables::table::condition;

/// Relative residual that is asked of all methods.
pub const RTOL: f64 = 1e-8;

/// The values of τ.
const TAUS: [f64; 3] = [5.0, 10.0, 50.0];

/// τ of the runs on finer elements.
const USUAL: f64 = 10.0;

/// κ may be at most this many times τ.
pub const OVER: f64 = 1.5;

/// The smallest eigenvalue may be below one by at most this.
pub const BELOW_ONE: f64 = 1e-6;

/// Our attainable error may be at most this many times that of MUMPS.
pub const WORSE: f64 = 10.0;

/// The study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AdaptiveReport {
    /// Its name, "adaptive".
    pub study: String,
    /// Relative residual that was asked for.
    pub rtol: f64,
    /// Runs of which seconds are the median.
    pub repeats: usize,
    /// The cases.
    pub cases: Vec<Record>,
}

/// One case.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Its name.
    pub case: String,
    /// A description.
    pub title: String,
    /// Unknowns.
    pub dofs: usize,
    /// Bodies.
    pub bodies: usize,
    /// Subdomains.
    pub subdomains: usize,
    /// Multipliers.
    pub multipliers: usize,
    /// Without deflation.
    pub plain: Plain,
    /// Relative residual of the direct solution that errors refer to; `None` where there is none.
    pub reference: Option<f64>,
    /// Error of MUMPS with iterative refinement.
    pub mumps: Option<f64>,
    /// Error of the direct solution if every entry is wrong by one unit in its last place, up or down.
    pub last_place: Option<f64>,
    /// With deflation, by τ.
    pub runs: Vec<AdaptiveRun>,
    /// Results for the same fields on finer elements.
    pub fine: Option<Fine>,
}

/// Seconds on finer elements, with τ = 10 and without; medians.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Fine {
    /// Unknowns.
    pub dofs: usize,
    /// CG's estimate of κ without deflation.
    pub estimate: Option<f64>,
    /// Iterations without deflation.
    pub plain_iterations: usize,
    /// Seconds of set-up and solve without deflation.
    pub plain_seconds: f64,
    /// Number of deflation vectors.
    pub vectors: usize,
    /// Iterations with deflation, including those before the search.
    pub iterations: usize,
    /// Seconds of set-up, search and solve with deflation.
    pub seconds: f64,
    /// The part of `seconds` for the search.
    pub search: f64,
    /// A message if something did not converge.
    pub message: Option<String>,
}

/// A run without deflation.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Plain {
    /// Exact κ, where SLEPc converged.
    pub exact: Option<f64>,
    /// CG's estimate, a lower bound.
    pub estimate: Option<f64>,
    /// Krylov iterations in total.
    pub iterations: usize,
    /// Seconds of set-up and solve.
    pub seconds: f64,
    /// Error at [`RTOL`].
    pub error: Option<f64>,
    /// Why the run did not converge; `None` if it did.
    pub message: Option<String>,
}

impl Plain {
    /// The exact κ, or the estimate.
    pub fn kappa(&self) -> Option<f64> {
        self.exact.or(self.estimate)
    }
}

/// A run with deflation.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct AdaptiveRun {
    /// τ.
    pub tau: f64,
    /// Whether the first iterations of the solve called for a search.
    pub searched: bool,
    /// Exact κ with all deflation vectors, including those that are searched for after the solve.
    pub kappa: Option<f64>,
    /// The smallest eigenvalue.
    pub lambda_min: Option<f64>,
    /// Number of vectors: those of all bodies, and those that bodies share.
    pub vectors: usize,
    /// The largest number of vectors of a body.
    pub most: usize,
    /// Number of bodies in which the search ended early.
    pub capped: usize,
    /// Seconds of the search and the matrices of the deflation.
    pub search: f64,
    /// Krylov iterations in total, including those before the search.
    pub iterations: usize,
    /// Seconds of set-up, search and solve.
    pub seconds: f64,
    /// Error at [`RTOL`].
    pub error: Option<f64>,
    /// Error if the iteration continues until rounding stops it.
    pub attainable: Option<f64>,
    /// Why the run did not converge; `None` if it did.
    pub message: Option<String>,
    /// PCBDDC with the same threshold.
    pub bddc: Option<Bddc>,
    /// The checks that fail; empty if all hold.
    pub fails: Vec<String>,
}

/// A run of PCBDDC.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Bddc {
    /// Subdomains, one for each rank.
    pub ranks: usize,
    /// CG's estimate of κ.
    pub kappa: Option<f64>,
    /// Iterations.
    pub iterations: Option<usize>,
    /// Seconds of set-up and solve.
    pub seconds: f64,
    /// Why there is no result, or a message if the residual was not reached.
    pub message: Option<String>,
}

impl AdaptiveRun {
    /// The guarantees of deflation that are violated, given the error of MUMPS.
    pub fn judge(&self, reference: bool, mumps: Option<f64>) -> Vec<String> {
        let mut fails = Vec::new();
        if let Some(message) = &self.message {
            fails.push(message.clone());
        }
        match self.kappa {
            Some(kappa) if kappa <= OVER * self.tau => {}
            Some(kappa) => fails.push(format!("κ = {}", condition(Some(kappa)))),
            None => fails.push("no exact κ".into()),
        }
        let low = |l: &f64| l.is_nan() || *l < 1.0 - BELOW_ONE;
        if let Some(least) = self.lambda_min.filter(low) {
            fails.push(format!("λ_min = {least:.8}"));
        }
        match (self.attainable, mumps) {
            (Some(error), Some(mumps)) if error <= WORSE * mumps => {}
            (Some(error), Some(mumps)) => {
                fails.push(format!("error {error:.0e}, MUMPS {mumps:.0e}"));
            }
            _ if !reference => fails.push("no direct solution".into()),
            (_, None) => fails.push("MUMPS has no solution".into()),
            (None, _) => fails.push("no error".into()),
        }
        fails
    }
}

impl Record {
    /// The runs with a failed check.
    pub fn failing(&self) -> impl Iterator<Item = &AdaptiveRun> {
        self.runs.iter().filter(|r| !r.fails.is_empty())
    }
}

/// The parts of the study that are run, and how often.
#[derive(Debug, Clone, Copy)]
struct Effort {
    taus: &'static [f64],
    repeats: usize,
    /// Time limit of PCBDDC in seconds; 0: it is not run.
    patience: u64,
    /// Exact spectra without deflation are computed up to this number of multipliers.
    plain: usize,
}

/// Runs all cases, and calls `progress` before each. Scenes and their coefficients are written into `dir`, so that
/// every case can be solved again separately.
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input) on several ranks; those of the disk; PETSc's own errors.
pub fn run(
    session: &Session,
    quick: bool,
    only: Option<&str>,
    dir: &Path,
    progress: &mut dyn FnMut(&str),
) -> Result<AdaptiveReport> {
    super::alone(session, "adaptive", "it starts PCBDDC on ranks of its own")?;
    let effort = if quick {
        Effort {
            taus: &TAUS[1..2],
            repeats: 1,
            patience: 0,
            plain: 1200,
        }
    } else {
        Effort {
            taus: &TAUS,
            repeats: 3,
            patience: 15,
            plain: 20_000,
        }
    };
    let mut records = Vec::new();
    let meshes = if quick { Meshes::Quick } else { Meshes::Small };
    let fine = cases(Meshes::Fine);
    for (of, case) in super::numbered(super::chosen(cases(meshes), |c| &c.name, only)?) {
        progress(&format!("{of}, {}", case.name));
        let mut record = measure::one(session, &case, effort, dir)?;
        if let Some(fine) = fine.iter().find(|f| f.name == case.name && !quick) {
            progress(&format!("{of}, {}, finer elements", case.name));
            record.fine = Some(measure::fine(session, fine, effort, dir)?);
        }
        records.push(record);
    }
    Ok(AdaptiveReport {
        study: "adaptive".into(),
        rtol: RTOL,
        repeats: effort.repeats,
        cases: records,
    })
}
