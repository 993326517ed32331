//! `study adaptive`: condition numbers that the user chooses, on coefficients that jump inside bodies.
//!
//! Every case is a scene in the text form with its coefficients in a file. It is solved without deflation and with each τ, to the same residual; exact spectra are
//! SLEPc's. Errors are distances from a direct solution with residuals in twice the working precision, and are held against what MUMPS attains
//! on the same problem. PCBDDC with its own adaptive constraints runs on the same scenes.
//!
//! Nothing here makes a case pass: a bound that is missed is what the study is for, and says which one it was.

mod cases;
mod fields;
mod measure;
mod table;

pub use cases::{cases, Case, Meshes, Problem};
pub use fields::Field;
pub use table::{fine, table, text};

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::petsc::Session;
use crate::Result;

/// Relative residual that is asked of all methods.
pub const RTOL: f64 = 1e-8;

/// The bounds that are asked for.
const TAUS: [f64; 3] = [5.0, 10.0, 50.0];

/// τ of the runs on finer elements.
const USUAL: f64 = 10.0;

/// κ may be this many times τ.
pub const OVER: f64 = 1.5;

/// The smallest eigenvalue may be this much below one.
pub const BELOW_ONE: f64 = 1e-6;

/// Our attainable error may be this many times that of MUMPS.
pub const WORSE: f64 = 10.0;

/// The study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Report {
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
    /// What it is.
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
    /// What the direct solution that errors refer to has left; `None` where there is none.
    pub reference: Option<f64>,
    /// Error of MUMPS with iterative refinement.
    pub mumps: Option<f64>,
    /// Error of the direct solution with every entry off by one unit in its last place, up or down.
    pub last_place: Option<f64>,
    /// With deflation, by τ.
    pub runs: Vec<Run>,
    /// The same fields on finer elements.
    pub fine: Option<Fine>,
}

/// Seconds on finer elements, with τ = 10 and without; medians.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Fine {
    /// Unknowns.
    pub dofs: usize,
    /// CG's estimate of κ without deflation.
    pub estimate: Option<f64>,
    /// Iterations without.
    pub plain_iterations: usize,
    /// Seconds of set-up and solve without.
    pub plain_seconds: f64,
    /// Vectors.
    pub vectors: usize,
    /// Iterations with, those before the search included.
    pub iterations: usize,
    /// Seconds of set-up, search and solve.
    pub seconds: f64,
    /// Of which for the search.
    pub search: f64,
    /// What did not converge.
    pub message: Option<String>,
}

/// A run without deflation.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Plain {
    /// Exact κ, where SLEPc converged.
    pub exact: Option<f64>,
    /// CG's estimate, a lower bound.
    pub estimate: Option<f64>,
    /// Krylov iterations in all.
    pub iterations: usize,
    /// Seconds of set-up and solve.
    pub seconds: f64,
    /// Error at [`RTOL`].
    pub error: Option<f64>,
    /// Why it did not converge, where it did not.
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
pub struct Run {
    /// τ.
    pub tau: f64,
    /// Whether the first iterations of the solve called for a search.
    pub searched: bool,
    /// Exact κ with what is deflated, what is searched for after the solve included.
    pub kappa: Option<f64>,
    /// The smallest eigenvalue.
    pub lambda_min: Option<f64>,
    /// Vectors of all bodies and those that bodies share.
    pub vectors: usize,
    /// Vectors of the body that has most.
    pub most: usize,
    /// Bodies in which the search ended early.
    pub capped: usize,
    /// Seconds of the search and the matrices of the deflation.
    pub search: f64,
    /// Krylov iterations in all, those before the search included.
    pub iterations: usize,
    /// Seconds of set-up, search and solve.
    pub seconds: f64,
    /// Error at [`RTOL`].
    pub error: Option<f64>,
    /// Error when the iteration goes on until rounding stops it.
    pub attainable: Option<f64>,
    /// Why it did not converge, where it did not.
    pub message: Option<String>,
    /// PCBDDC with the same threshold.
    pub bddc: Option<Bddc>,
    /// What does not hold; empty: all is well.
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
    /// Why there is no result, or that its residual was not reached.
    pub message: Option<String>,
}

impl Run {
    /// What of the promises of deflation does not hold, given the error of MUMPS.
    pub fn judge(&self, reference: bool, mumps: Option<f64>) -> Vec<String> {
        let mut fails = Vec::new();
        if let Some(message) = &self.message {
            fails.push(message.clone());
        }
        match self.kappa {
            Some(kappa) if kappa <= OVER * self.tau => {}
            Some(kappa) => fails.push(format!("κ = {}", table::number(Some(kappa)))),
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
    /// The runs in which something does not hold.
    pub fn failing(&self) -> impl Iterator<Item = &Run> {
        self.runs.iter().filter(|r| !r.fails.is_empty())
    }
}

/// What is measured, and how often.
#[derive(Debug, Clone, Copy)]
struct Effort {
    taus: &'static [f64],
    repeats: usize,
    /// Seconds that PCBDDC may take; 0: it is not run.
    patience: u64,
    /// Exact spectra without deflation up to so many multipliers.
    plain: usize,
}

/// Runs all cases, telling `progress` before each. Scenes and their coefficients are written into `dir`, so that
/// every case can be solved again by itself.
///
/// # Errors
/// [`Error::Input`](crate::Error::Input) on several ranks; those of the disk; PETSc's own errors.
pub fn run(
    session: &Session,
    quick: bool,
    only: Option<&str>,
    dir: &Path,
    progress: &mut dyn FnMut(&str),
) -> Result<Report> {
    super::alone(session, "adaptive", "it starts PCBDDC on ranks of its own")?;
    let effort = match quick {
        false => Effort {
            taus: &TAUS,
            repeats: 3,
            patience: 15,
            plain: 20_000,
        },
        true => Effort {
            taus: &TAUS[1..2],
            repeats: 1,
            patience: 0,
            plain: 1200,
        },
    };
    let mut records = Vec::new();
    let meshes = if quick { Meshes::Quick } else { Meshes::Small };
    let fine = cases(Meshes::Fine);
    for case in super::chosen(cases(meshes), |c| &c.name, only)? {
        progress(&case.name);
        let mut record = measure::one(session, &case, effort, dir)?;
        if let Some(fine) = fine.iter().find(|f| f.name == case.name && !quick) {
            progress(&format!("{}, finer elements", case.name));
            record.fine = Some(measure::fine(session, fine, effort, dir)?);
        }
        records.push(record);
    }
    Ok(Report {
        study: "adaptive".into(),
        rtol: RTOL,
        repeats: effort.repeats,
        cases: records,
    })
}
