//! One baseline as a job of its own, for studies.

use std::path::Path;
use std::time::Duration;

use super::launch::{Launcher, Workspace};
use super::task::{BaselineTask, Job, Outcome};
use base::Result;

/// Runs the baseline `name` on `ranks` ranks with these options of PETSc, to a relative residual of `rtol` of the
/// assembled problem and for at most `seconds`. Where there are inequalities it solves the equations of the rows
/// `active`. The inner `Err` is one sentence.
///
/// # Errors
/// [`ErrorKind::Environment`](base::ErrorKind::Environment) without mpirun or disk.
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
        session: None,
    };
    let job = Job {
        scene: scene.to_path_buf(),
        rtol,
        inner: rtol,
        again: false,
        task: BaselineTask::Baseline {
            name: name.into(),
            rescue: false,
            separate: false,
            active: active.to_vec(),
            solution: launcher.workspace.file("result.u"),
        },
    };
    let finished = launcher.run(name, ("baseline", &job), ranks)?;
    Ok(finished.record.map_err(|failure| failure.message))
}
