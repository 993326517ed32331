//! `study speed-error`: the distance of solutions from the solution of the continuous problem over seconds, for ours
//! and every baseline of `compare`, over meshes and tolerances.
//!
//! ```text
//!     ‖u_h,k − u‖² = ‖u_h − u‖² + ‖u_h,k − u_h‖²         (Galerkin)
//! ```
//!
//! The first part is the error of the mesh. It is measured once per mesh on a tight solution of ours: against the known
//! solution, or against a mesh twice as fine as the finest. The second part is the error of the solver. It is reported
//! by `compare`: the distance from a direct solution on the same mesh. With inequalities the sum is only an
//! approximation of the distance; the two parts are exact. For every mesh and tolerance `compare` runs all methods one
//! after the other, so that other load on the machine affects all of them.

mod meshes;
mod picture;
mod scenes;

pub use picture::{figure, table, text};
pub use scenes::SpeedErrorCase;

use std::process::{Command, Stdio};

use serde::{Deserialize, Serialize};

use crate::baselines::launch::{own, read, without_mpi, Workspace};
use base::{Error, Result};
use petsc::Session;
use report::json::CompareReport;
use report::output;

/// A variant of our method, with a curve of its own. The baselines run together with the first variant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Variant {
    /// Its name in tables and pictures.
    pub name: &'static str,
    /// PETSc options.
    pub options: &'static [&'static str],
}

/// The variants of ours.
pub const VARIANTS: [Variant; 2] = [
    Variant {
        name: "fetifeti",
        options: &[],
    },
    Variant {
        name: "fetifeti, mixed",
        options: &["-fetifeti_precision", "mixed"],
    },
];

/// The study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SpeedErrorReport {
    /// Its name, "speed-error".
    pub study: String,
    /// Cores that every method may use.
    pub cores: usize,
    /// The scenes.
    pub cases: Vec<SpeedErrorScene>,
}

/// One scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SpeedErrorScene {
    /// Its name.
    pub case: String,
    /// A description.
    pub title: String,
    /// Error of every mesh itself, relative, in the energy norm.
    pub meshes: Vec<MeshError>,
    /// All runs.
    pub runs: Vec<SpeedErrorRun>,
}

/// The discretisation error of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MeshError {
    /// Elements across a subdomain.
    pub elements: usize,
    /// Unknowns.
    pub dofs: usize,
    /// ‖u_h − u‖ / ‖u_h‖ in the energy norm.
    pub error: f64,
}

/// One method on one mesh with one tolerance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SpeedErrorRun {
    /// `fetifeti` or a baseline; a name with "(set given)" solves only the equations of the last active set.
    pub method: String,
    /// Elements across a subdomain.
    pub elements: usize,
    /// Unknowns.
    pub dofs: usize,
    /// Relative residual that was asked for.
    pub rtol: f64,
    /// MPI ranks.
    pub ranks: usize,
    /// Threads per rank.
    pub threads: usize,
    /// Iterations.
    pub iterations: Option<usize>,
    /// Seconds of set-up.
    pub setup: f64,
    /// Seconds of the solve.
    pub solve: f64,
    /// Distance from the direct solution of the mesh, relative.
    pub solver_error: f64,
    /// The error of mesh and solver together.
    pub error: f64,
    /// Whether the residual was reached; pictures show only these.
    pub converged: bool,
}

/// Tolerances of the study.
pub fn tolerances(quick: bool) -> &'static [f64] {
    if quick {
        &[1e-4]
    } else {
        &[1e-2, 1e-4, 1e-6]
    }
}

/// Runs the study with the program itself, and calls `progress` before every step. It is called on one rank: the
/// methods need the machine.
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input) on several ranks; those of `compare`.
pub fn run(
    session: &Session,
    quick: bool,
    only: Option<&str>,
    progress: &mut dyn FnMut(&str),
) -> Result<SpeedErrorReport> {
    super::alone(
        session,
        "speed-error",
        "it starts the methods on ranks of their own",
    )?;
    let mut cores = 0;
    let mut cases = Vec::new();
    for (of, case) in super::numbered(super::chosen(
        SpeedErrorCase::ALL.to_vec(),
        |c| c.name(),
        only,
    )?) {
        let meshes = case.meshes(quick);
        progress(&format!("{of}, {}: errors of the meshes", case.name()));
        let errors = meshes::errors(session, case, meshes)?;
        let mut runs = Vec::new();
        for &rtol in tolerances(quick) {
            for mesh in &errors {
                for (k, variant) in VARIANTS.iter().enumerate() {
                    progress(&format!(
                        "{of}, {}, {} elements per subdomain, rtol {rtol:e}",
                        case.name(),
                        mesh.elements
                    ));
                    // A direct solver has no tolerance: it runs with the first one only. `compare` needs a baseline
                    // beside each variant.
                    let with = match (k, quick) {
                        (0, false) => None,
                        _ => Some("mumps"),
                    };
                    let report = compare(case, mesh.elements, rtol, variant, with)?;
                    cores = report.cores;
                    runs.extend(rows(&report, mesh, rtol, variant, k == 0));
                }
            }
        }
        cases.push(SpeedErrorScene {
            case: case.name().into(),
            title: case.title().into(),
            meshes: errors,
            runs,
        });
    }
    Ok(SpeedErrorReport {
        study: "speed-error".into(),
        cores,
        cases,
    })
}

/// The runs of a comparison that have a result; baselines only where wanted.
fn rows(
    report: &CompareReport,
    mesh: &MeshError,
    rtol: f64,
    variant: &Variant,
    baselines: bool,
) -> Vec<SpeedErrorRun> {
    let mut out = Vec::new();
    for row in &report.rows {
        let run = &row.run;
        let (Some(setup), Some(solve), Some(error)) =
            (row.seconds.setup, row.seconds.solve, run.error)
        else {
            continue;
        };
        if !(run.is_ours() || baselines) {
            continue;
        }
        // Methods that are set up for a mesh and its parts do not search for the active set.
        let method = match (run.is_ours(), run.set_given()) {
            (true, _) => variant.name.into(),
            (false, true) => format!("{} (set given)", run.method),
            (false, false) => run.method.clone(),
        };
        out.push(SpeedErrorRun {
            method,
            elements: mesh.elements,
            dofs: mesh.dofs,
            rtol,
            ranks: run.ranks,
            threads: run.threads,
            iterations: run.iterations,
            setup,
            solve,
            solver_error: error,
            error: mesh.error.hypot(error),
            converged: run.converged,
        });
    }
    out
}

/// Runs `fetifeti compare` as a process of its own.
fn compare(
    case: SpeedErrorCase,
    n: usize,
    rtol: f64,
    variant: &Variant,
    with: Option<&str>,
) -> Result<CompareReport> {
    let workspace = Workspace::new()?;
    let [scene, file] = ["scene.toml", "compare.json"].map(|name| workspace.file(name));
    output::write_text(&scene, &case.scene(n))?;
    let mut command = Command::new(own()?);
    without_mpi(&mut command);
    command
        .arg("compare")
        .arg(&scene)
        .arg("--json")
        .arg(&file)
        .arg("--quiet");
    if let Some(with) = with {
        command.args(["--with", with]);
    }
    command.args(["-fetifeti_ksp_rtol", &format!("{rtol:e}")]);
    command.args(variant.options);
    command.args(["-compare_time_limit", "120"]);
    let out = command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .output()
        .map_err(|e| Error::environment("cannot start compare").because(e))?;
    let text = std::fs::read_to_string(&file).map_err(|_| {
        let said = String::from_utf8_lossy(&out.stderr);
        let said = said
            .lines()
            .find(|l| l.starts_with("Error"))
            .unwrap_or("no message");
        Error::environment(format!("compare left no result: {said}"))
    })?;
    read(&text)
}

impl SpeedErrorScene {
    /// The methods, ours first.
    pub fn methods(&self) -> Vec<String> {
        let mut out: Vec<String> = Vec::new();
        for run in &self.runs {
            if !out.contains(&run.method) {
                out.push(run.method.clone());
            }
        }
        out
    }

    /// For every mesh and tolerance, the run of a method in its fastest layout, if one converged.
    pub fn fastest(&self, method: &str) -> Vec<&SpeedErrorRun> {
        let mut out: Vec<&SpeedErrorRun> = Vec::new();
        for run in self
            .runs
            .iter()
            .filter(|r| r.method == method && r.converged)
        {
            let total = |r: &SpeedErrorRun| r.setup + r.solve;
            match out
                .iter_mut()
                .find(|r| (r.elements, r.rtol.to_bits()) == (run.elements, run.rtol.to_bits()))
            {
                Some(best) if total(run) < total(best) => *best = run,
                Some(_) => {}
                None => out.push(run),
            }
        }
        out
    }
}
