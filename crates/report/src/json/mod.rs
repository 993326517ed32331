//! The JSON records of the commands: one struct per command, with keys that other programs rely on.
//!
//! A number that is unknown or not finite is written as `null`, never as NaN, and read back as `None` or NaN.

pub mod adaptive;
mod bench;
pub mod certified;
mod compare;
pub mod contact;
pub mod friction;
mod number;
mod plan;
pub mod probes;
mod solve;
mod spectrum;

pub use bench::{BenchCase, BenchReport, BenchRow, BenchSample, BenchSeconds, Spread};
pub use compare::{
    CompareContact, CompareInequalities, CompareReport, CompareRow, CompareStep, ComparedScene,
    MethodRun, PhaseSeconds,
};
pub use plan::{PlanReport, PlannedBody, PlannedInterface, PlannedMemory};
pub use solve::{
    ErrorNorms, FreeMotion, Input, Iterations, Kkt, Multipliers, NaturalCoarse, Operators, Seconds,
    SolveReport,
};
pub use spectrum::{Condition, Spectrum};

use super::output;
use base::{Error, Result};
use serde::Serialize;
use std::path::Path;

/// Serialises any record as indented JSON to a file, or to standard output for the path `-`.
///
/// # Errors
/// [`ErrorKind::Environment`](base::ErrorKind::Environment) with the path when it cannot be written.
pub fn write<T: Serialize>(path: &Path, record: &T) -> Result<()> {
    let mut text = to_string(record)?;
    text.push('\n');
    output::write_text(path, &text)
}

/// Indented JSON of any record.
///
/// # Errors
/// [`ErrorKind::Environment`](base::ErrorKind::Environment) when the record has no JSON form (a map whose keys are not
/// strings).
pub fn to_string<T: Serialize>(record: &T) -> Result<String> {
    serde_json::to_string_pretty(record)
        .map_err(|e| Error::environment("cannot write a result as JSON").because(e))
}
