//! `fetifeti compare` from the outside: a scene in a file, and the program's report on it.

use super::keys::{self, Keys};
use super::mpi::{Output, Scratch};
use super::program::fetifeti;
use report::json::{CompareReport, CompareRow};

/// Required keys of a report of `compare`.
pub const KEYS: Keys = &[
    ("", "scene bodies subdomains dofs rtol cores supports reference_residual rows"),
    ("contact", "rows active outer feasibility min_multiplier load_steps"),
    (
        "rows[]",
        "method subdomains ranks threads kappa iterations seconds memory_mb memory_at_start_mb error \
         residual rtol converged converged_reason",
    ),
    ("rows[].seconds", "assemble setup solve total"),
    ("rows[].contact", "outer active differ feasibility min_multiplier"),
];

/// Whether a row has a solution. Ours must have one. A row of another method may give a reason instead: whether PETSc's
/// solvers converge is beyond our control and differs from processor to processor.
pub fn solved(row: &CompareRow) -> bool {
    let what = format!("{} on {} ranks: {row:?}", row.run.method, row.run.ranks);
    let Some(message) = &row.run.message else {
        assert!(row.run.converged, "{what}");
        assert!(row.run.converged_reason.starts_with("CONVERGED"), "{what}");
        return true;
    };
    assert_ne!(row.run.method, "fetifeti", "{what}");
    assert!(!message.trim().is_empty() && !row.run.converged, "{what}");
    // A method that broke down has no measurements; one that stopped early has those of the judge.
    let left = row.run.converged_reason.is_empty();
    assert!(
        !left || (row.run.error, row.run.iterations, row.run.kappa) == (None, None, None),
        "{what}"
    );
    println!("{}: {message}", row.run.method);
    false
}

/// A scene file that is removed when the value is dropped.
pub struct SceneFile {
    path: String,
    /// Its directory, for more files.
    pub scratch: Scratch,
}

impl SceneFile {
    /// `name` must be unique among the scenes of the test file.
    pub fn new(name: &str, text: &str) -> SceneFile {
        let scratch = Scratch::new(&format!("compare-{name}"));
        SceneFile {
            path: scratch.file("scene.toml", text),
            scratch,
        }
    }

    /// A deck instead of a scene.
    pub fn deck(name: &str, text: &str) -> SceneFile {
        let scratch = Scratch::new(&format!("compare-{name}"));
        SceneFile {
            path: scratch.file("deck.inp", text),
            scratch,
        }
    }

    pub fn path(&self) -> &str {
        &self.path
    }

    /// Runs `fetifeti compare` on two cores with more arguments; it must succeed.
    pub fn run(&self, more: &[&str]) -> Output {
        let args = [&["compare", self.path(), "-compare_cores", "2"], more].concat();
        let output = fetifeti(&args);
        assert_eq!(output.code, 0, "{}", output.all());
        output
    }

    /// As `run`, and returns the report.
    pub fn compare(&self, more: &[&str]) -> CompareReport {
        let output = self.run(&[&["--json", "-"], more].concat());
        keys::read(&output.stdout, KEYS)
    }
}
