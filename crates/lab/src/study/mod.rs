//! Studies: questions about the method that need many runs, with the tables and pictures that answer them.
//!
//! A study is library code that returns data; `fetifeti study NAME` writes them to files. Every scene of a study is
//! text in the format of scene files.

pub mod adaptive;
pub mod benchmarks;
pub mod hard_cases;
pub mod hertz;
pub mod kappa;
pub mod scaling;
mod solved;
pub mod speed_error;
pub mod table1;
pub mod walls;

use base::{Error, Result};
use petsc::Session;

/// Refuses to run the study `name` on several ranks; `why` says why it needs a single one.
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input).
fn alone(session: &Session, name: &str, why: &str) -> Result<()> {
    match session.size() {
        1 => Ok(()),
        ranks => Err(Error::input(format!(
            "study {name} was started on {ranks} ranks, expected one: {why}"
        ))),
    }
}

/// The cases of a study, or the single one that is asked for.
fn chosen<T>(all: Vec<T>, name: impl Fn(&T) -> &str, only: Option<&str>) -> Result<Vec<T>> {
    let Some(wanted) = only else {
        return Ok(all);
    };
    let names: Vec<&str> = all.iter().map(&name).collect();
    let message = format!(
        "the study has no case \"{wanted}\", expected one of {}",
        names.join(", ")
    );
    let found: Vec<T> = all.into_iter().filter(|c| name(c) == wanted).collect();
    if found.is_empty() {
        return Err(Error::input(message));
    }
    Ok(found)
}

/// Cases, each with its number in words: "3 of 10".
fn numbered<T>(cases: Vec<T>) -> impl Iterator<Item = (String, T)> {
    let n = cases.len();
    let cases = cases.into_iter().enumerate();
    cases.map(move |(k, case)| (format!("{} of {n}", k + 1), case))
}
