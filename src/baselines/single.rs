//! Single methods for studies: MUMPS in this process, and one row of the table as a job of its own.

use std::path::Path;
use std::time::Duration;

use super::judge;
use super::launch::{read, Launcher, Workspace};
use super::task::{Job, Outcome, Task};
use crate::assembled::layout::Layout;
use crate::assembled::rows::Rows;
use crate::assembled::system::{Format, System};
use crate::assembled::unknowns::Unknowns;
use crate::petsc::Session;
use crate::scene::Scene;
use crate::substructures::Subdomain;
use crate::{Error, Result};

/// What MUMPS finds with iterative refinement.
pub struct Refined {
    /// u of the given subdomains, by local dof.
    pub u: Vec<Vec<f64>>,
    /// The inequalities that hold, by their place among those of the scene.
    pub active: Vec<usize>,
    /// Whether refinement, and the active set where there are inequalities, have settled.
    pub converged: bool,
}

/// Solves `scene` by MUMPS with iterative refinement; `subdomains` are all of its subdomains. Where the active set around MUMPS does not settle and
/// `known` is one that is known to be right, its equations are solved. On one rank.
///
/// # Errors
/// Those of the scene and PETSc's.
pub fn refined(
    session: &Session,
    scene: &Scene,
    subdomains: &[Subdomain],
    known: Option<&[bool]>,
) -> Result<Refined> {
    let layout = Layout::new(scene);
    if let Some(trouble) = &layout.trouble {
        return Err(Error::input(format!("not for this scene: {trouble}")));
    }
    let unknowns = Unknowns::all(&layout);
    let system = System::new(session, scene, &unknowns, Format::Assembled)?;
    let rows = match scene.has_contact() {
        true => Rows::new(scene, &layout),
        false => Rows::default(),
    };
    let solve = |set| judge::reference(session, scene, &unknowns, &system, &rows, set);
    let mut found = solve(None)?;
    if let Some(known) = known.filter(|k| !found.converged && k.len() == rows.len()) {
        found = solve(Some(known))?;
    }
    let w = found.u.array()?;
    // Along the frames of contact: u = Σ coefficient · w.
    let value = |&dof: &u64| {
        let terms = layout.terms(layout.index(dof));
        terms.iter().map(|&(at, c)| c * w[at as usize]).sum()
    };
    let u = subdomains
        .iter()
        .map(|s| s.dofs.iter().map(value).collect())
        .collect();
    Ok(Refined {
        u,
        active: rows.list(&found.active),
        converged: found.converged,
    })
}

/// Runs the row `name` of the table on `ranks` ranks with these options of PETSc, to a relative residual of `rtol` of the assembled problem and for
/// at most `seconds`. Where there are inequalities it solves the equations of the rows `active`. The inner `Err` is one sentence.
///
/// # Errors
/// [`Error::Environment`] without mpirun or disk.
pub fn baseline(
    name: &str,
    scene: &Path,
    ranks: usize,
    options: &[&str],
    active: &[usize],
    rtol: f64,
    seconds: u64,
) -> Result<std::result::Result<Outcome, String>> {
    let launcher = Launcher {
        workspace: Workspace::new()?,
        limit: Duration::from_secs(seconds),
        petsc: options.iter().map(|o| o.to_string()).collect(),
    };
    let job = Job {
        scene: scene.to_path_buf(),
        result: launcher.workspace.file("result.json"),
        rtol,
        inner: rtol,
        again: false,
        task: Task::Baseline {
            name: name.into(),
            rescue: false,
            active: active.to_vec(),
            solution: launcher.workspace.file("result.u"),
        },
    };
    match launcher.run(name, &job, ranks)?.record {
        Ok(text) => read(&text).map(Ok),
        Err(failure) => Ok(Err(failure.message)),
    }
}
