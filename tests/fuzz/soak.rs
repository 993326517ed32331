//! Random scenes, solved by the method and judged by the direct solution (docs/reliability.md). Compiled into the
//! library for `make soak`, as the readers are for `make fuzz`.

#[path = "mesh.rs"]
mod mesh;
#[path = "../support/rng.rs"]
#[allow(dead_code)]
mod rng;
#[path = "scenes.rs"]
mod scenes;

use std::panic::{catch_unwind, AssertUnwindSafe};
use std::path::{Path, PathBuf};

use base::ErrorKind::{Input, NotConverged, Unfit};
use base::{Error, Result};
use lab::assembled::layout::UnknownLayout;
use lab::assembled::reference::{Reference, ResidualPrecision};
use lab::assembled::rows::Inequalities;
use lab::baselines::{judge, solve_ours, BaselineTask, Job};
use petsc::Session;
use scene::{distribution, Scene};

/// The bound for the residual of the assembled problem.
const RTOL: f64 = 1e-9;
/// Largest error in the energy norm, relative to the solution.
const ERROR: f64 = 1e-5;
/// Largest violation of a row, relative to the largest displacement. The signs of the multipliers are the certificate's
/// to judge: where rows depend on each other the direct solver finds others, of any sign.
const VIOLATION: f64 = 1e-5;

/// Rows up to which a refusal is compared with the direct solver.
const MANY: usize = 40;

/// What a scene has come to.
#[derive(Debug, Clone, PartialEq)]
pub enum Fate {
    /// Solved; the error in the energy norm.
    Right(f64),
    /// Refused when it was read.
    Refused(String),
    /// There is no solution, and both say so.
    NoSolution(String),
    /// The direct solver has no answer to compare with.
    Undecided(String),
    /// The method did not converge, and says so; why.
    NotConverged(String),
    /// A panic, a wrong answer, a refusal of what has a solution, a sentence without a place.
    Wrong(String),
}

/// The text of a scene, and of its mesh.
pub fn text(seed: u64) -> (String, Option<String>) {
    let text = scenes::text(seed);
    (text.scene, text.mesh)
}

/// Writes the scene of a seed into `dir`; returns its path.
pub fn write(seed: u64, dir: &Path) -> std::io::Result<PathBuf> {
    let (scene, mesh) = text(seed);
    std::fs::create_dir_all(dir)?;
    if let Some(mesh) = mesh {
        std::fs::write(dir.join("mesh.msh"), mesh)?;
    }
    let path = dir.join(format!("soak_{seed}.toml"));
    std::fs::write(&path, scene)?;
    Ok(path)
}

/// Solves the scene of a seed with files in `dir`. Collective.
pub fn fate(session: &Session, seed: u64, dir: &Path) -> Fate {
    let work = || -> Result<Fate> {
        let written = match session.rank() {
            0 => write(seed, dir).map(|_| ()),
            _ => Ok(()),
        };
        session.agree(written.map_err(|e| Error::environment(e.to_string())))?;
        let path = dir.join(format!("soak_{seed}.toml"));
        let scene = match session.agree(Scene::load(&path)) {
            Ok(scene) => scene,
            Err(e) => return Ok(refused(&e.to_string(), &path)),
        };
        distribution::with_options(session, &scene.options, || solved(session, &scene, dir))
    };
    let done = catch_unwind(AssertUnwindSafe(work));
    let _ =
        session.rank() == 0 && std::fs::remove_file(dir.join(format!("soak_{seed}.toml"))).is_ok();
    match done {
        Ok(Ok(fate)) => fate,
        Ok(Err(e)) => Fate::Wrong(format!("an error where none was expected: {e}")),
        Err(panic) => {
            let text = panic.downcast_ref::<String>().cloned();
            let text = text.or_else(|| panic.downcast_ref::<&str>().map(|s| s.to_string()));
            Fate::Wrong(format!("a panic: {}", text.unwrap_or_default()))
        }
    }
}

/// A sentence names its place if it has the file, a body, an interface or an option.
fn refused(said: &str, path: &Path) -> Fate {
    let file = path.display().to_string();
    let places = [&file[..], "body", "bodies", "[[", "-fetifeti_"];
    if !said.contains('\n') && places.iter().any(|p| said.contains(p)) {
        Fate::Refused(said.into())
    } else {
        Fate::Wrong(format!("a sentence without a place: {said}"))
    }
}

fn solved(session: &Session, scene: &Scene, dir: &Path) -> Result<Fate> {
    let file = dir.join("solution");
    let job = Job {
        scene: PathBuf::new(),
        rtol: RTOL,
        inner: 1e-2,
        again: false,
        task: BaselineTask::Judge {
            solutions: Vec::new(),
        },
    };
    match solve_ours(session, scene, &job, (1, false), &file) {
        Ok(outcome) => {
            // Where rounding keeps the residual above the bound, the error says whether it matters.
            let converged = outcome.reason.starts_with("CONVERGED");
            if let Some(message) = outcome.message.filter(|_| !converged) {
                return Ok(Fate::NotConverged(message));
            }
            let active = outcome.contact.map(|c| c.active).unwrap_or_default();
            let verdict = match judge(session, scene, &[vec![(file.clone(), active)]]) {
                Ok(verdict) => verdict,
                Err(why) if why.is_input() => return Ok(Fate::Undecided(why.to_string())),
                Err(other) => return Err(other),
            };
            if verdict.reference.is_none() {
                return Ok(Fate::Undecided("the direct solver did not converge".into()));
            }
            let of = verdict.solutions[0];
            let error = of.error.unwrap_or(0.0);
            let violation = of.feasibility.unwrap_or(0.0);
            Ok(if error <= ERROR && violation <= VIOLATION {
                Fate::Right(error)
            } else {
                Fate::Wrong(format!(
                    "an error of {error:.1e}, a violation of {violation:.1e}"
                ))
            })
        }
        Err(e) if matches!(e.kind(), Input | Unfit | NotConverged) => {
            let said = e.to_string();
            if let wrong @ Fate::Wrong(_) = refused(&said, Path::new("soak_")) {
                return Ok(wrong);
            }
            let layout = UnknownLayout::new(scene);
            // Without a solution the direct solver may try sets for hours.
            if Inequalities::new(scene, &layout).len() > MANY {
                return Ok(Fate::Undecided(format!("{said}; many rows")));
            }
            let reference = Reference::new(session, scene, &layout, ResidualPrecision::Twice, None);
            let loud = e.is_not_converged();
            Ok(match reference {
                Ok(r) if r.found.converged && loud => Fate::NotConverged(said),
                Ok(r) if r.found.converged => Fate::Wrong(format!("a solution was missed: {said}")),
                Ok(_) => Fate::NoSolution(said),
                Err(why) if why.is_input() => Fate::Undecided(format!("{said}; {why}")),
                Err(other) => return Err(other),
            })
        }
        Err(other) => Err(other),
    }
}
