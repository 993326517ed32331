//! Models that once had a wrong answer, or were refused with a sentence that misleads: tests/data/cases.

mod balances;
mod blocks;
mod cells;
mod energy;
mod left_out;
mod mesh_files;
mod motions;
mod own_contact;
mod own_meshes;
mod parts;
mod pins;
mod pressures;
mod slack;
mod ties;

use crate::support::mpi::{Output, Scratch};
use crate::support::program::run_fetifeti;
use serde_json::Value;

/// A run of `solve`, and its record if there is one.
pub struct Solved {
    pub run: Output,
    record: Option<Value>,
}

impl Solved {
    /// The record of a solve that has converged.
    pub fn report(&self) -> Value {
        assert_eq!(self.run.code, 0, "{}", self.run.all());
        self.record.clone().expect("a record")
    }
}

/// Solves one of the models.
pub fn case(name: &str, ranks: usize, options: &[&str]) -> Solved {
    let scratch = Scratch::new(&format!("case_{ranks}_{name}"));
    solve(
        &scratch,
        ranks,
        &format!("../../tests/data/cases/{name}"),
        options,
    )
}

/// Solves a scene or deck.
pub fn solve(scratch: &Scratch, ranks: usize, path: &str, options: &[&str]) -> Solved {
    let json = scratch.path("report.json");
    let run = run_fetifeti(
        ranks,
        &[&["solve", path, "--json", &json], options].concat(),
    );
    let text = std::fs::read_to_string(&json).ok();
    let record = text.and_then(|text| serde_json::from_str(&text).ok());
    Solved { run, record }
}
