//! Starting one job on its own ranks, and waiting for it.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use serde::de::DeserializeOwned;
use serde::Serialize;

use base::{Error, Result};
use petsc::signals::{self, Signals};
use petsc::{Options, Session};
use report::json;

/// A directory for jobs, results and solutions that only this user can read; removed with the value.
pub struct Workspace {
    dir: PathBuf,
}

impl Workspace {
    /// Makes the directory.
    ///
    /// # Errors
    /// [`ErrorKind::Environment`](base::ErrorKind::Environment) with the path.
    pub fn new() -> Result<Workspace> {
        use std::os::unix::fs::DirBuilderExt;
        let stamp = std::time::SystemTime::now()
            .duration_since(std::time::UNIX_EPOCH)
            .map_or(0, |d| d.as_nanos());
        let name = format!("fetifeti-{}-{stamp}", std::process::id());
        let dir = std::env::temp_dir().join(name);
        std::fs::DirBuilder::new()
            .mode(0o700)
            .create(&dir)
            .map_err(|e| {
                Error::environment(format!("cannot make the directory {}", dir.display()))
                    .because(e)
            })?;
        Ok(Workspace { dir })
    }

    /// The path of the directory.
    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// The path of a file in it.
    pub fn file(&self, name: &str) -> PathBuf {
        self.dir.join(name)
    }
}

impl Drop for Workspace {
    fn drop(&mut self) {
        // Files that cannot be removed stay in the system's directory for temporary files.
        let _ = std::fs::remove_dir_all(&self.dir);
    }
}

/// Starts jobs, with the settings common to all of them.
pub struct Launcher {
    /// Directory for the files of the jobs.
    pub workspace: Workspace,
    /// A job that takes longer is ended.
    pub limit: Duration,
    /// PETSc's arguments for every job.
    pub petsc: Vec<String>,
    /// Whose options jobs ask for, too; `None` where jobs have options of their own.
    pub session: Option<Session>,
}

/// The reason why a job has no result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Failure {
    /// The exit code of the program, if it had one.
    pub code: Option<i32>,
    /// One sentence.
    pub message: String,
}

impl Failure {
    /// This failure as an error of this process, of the kind that the exit code names.
    pub fn into_error(self) -> Error {
        match self.code {
            Some(1) => Error::not_converged(self.message),
            Some(2) => Error::input(self.message),
            _ => Error::environment(self.message),
        }
    }
}

/// A job that ran: what it printed, and its record.
pub struct Finished<T> {
    /// Standard output of all ranks: PETSc's monitors and views.
    pub printed: String,
    /// The record that the job has left, or why there is none.
    pub record: std::result::Result<T, Failure>,
}

impl Launcher {
    /// Runs `fetifeti VERB FILE` on `ranks` ranks and waits until it ends. The file contains `task`; the record that
    /// the job leaves is the file beside it that ends in `json`.
    ///
    /// # Errors
    /// [`ErrorKind::Environment`](base::ErrorKind::Environment) where the job cannot be started at all: no disk, no
    /// mpirun; or where its record cannot be read.
    pub fn run<T: DeserializeOwned>(
        &self,
        name: &str,
        (verb, task): (&str, &impl Serialize),
        ranks: usize,
    ) -> Result<Finished<T>> {
        let files = ["job", "out", "err"].map(|end| self.workspace.file(&format!("{name}.{end}")));
        let [job, out, err] = &files;
        // The record of an earlier job must not be taken for that of this one.
        let _ = std::fs::remove_file(record(job));
        let _ = std::fs::remove_file(asked(job));
        json::write(job, task)?;
        let create = |path: &Path| {
            File::create(path).map_err(|e| {
                Error::environment(format!("cannot write {}", path.display())).because(e)
            })
        };
        let mut command = Command::new("mpirun");
        command
            .arg("-n")
            .arg(ranks.to_string())
            .arg(own()?)
            .arg(verb)
            .arg(job);
        command.args(&self.petsc);
        // Every job leaves the options of the others; the parent says which ones nobody asked for.
        command.args(["-options_left", "no"]);
        environment(&mut command, self.limit);
        command
            .stdin(Stdio::null())
            .stdout(create(out)?)
            .stderr(create(err)?);
        let _signals = Signals::watch();
        interrupted()?;
        let mut child = command.spawn().map_err(|e| {
            Error::environment("cannot start mpirun, which runs on several ranks need").because(e)
        })?;
        let clock = Instant::now();
        // mpirun ends itself after the limit; if it hangs, it is killed from here.
        let patience = self.limit + LATE;
        let status = loop {
            match child.try_wait().map_err(lost)? {
                Some(status) => break status,
                None if clock.elapsed() < patience && Signals::noted().is_none() => {
                    std::thread::sleep(Duration::from_millis(10));
                }
                None => break end(&mut child)?,
            }
        };
        interrupted()?;
        let text = |path: &Path| {
            let bytes = std::fs::read(path).unwrap_or_default();
            String::from_utf8_lossy(&bytes).into_owned()
        };
        // The record is the last act of a job: if hundreds of ranks fail while they finalise, it remains valid.
        let record = match std::fs::read_to_string(record(job)) {
            Ok(text) => Ok(read(&text)?),
            Err(e) if status.success() => Err(Failure {
                code: None,
                message: format!("left no result: {e}"),
            }),
            Err(_) => Err(self.failure(status, clock.elapsed(), &text(err))),
        };
        self.note_asked(job)?;
        Ok(Finished {
            printed: text(out),
            record,
        })
    }

    /// Marks the options that the job has asked for as asked for; all that it was given, if it does not say.
    fn note_asked(&self, job: &Path) -> Result<()> {
        let Some(session) = &self.session else {
            return Ok(());
        };
        let told = std::fs::read_to_string(asked(job));
        let told = told.ok().and_then(|t| serde_json::from_str(&t).ok());
        let asked: Vec<String> = told.unwrap_or_else(|| self.petsc.clone());
        let all = Options::new(session, "");
        for name in asked.iter().filter_map(|name| name.strip_prefix('-')) {
            all.has(name)?;
        }
        Ok(())
    }

    fn failure(&self, status: ExitStatus, took: Duration, stderr: &str) -> Failure {
        if took >= self.limit {
            let message = format!(
                "ended after {} s (-compare_time_limit)",
                self.limit.as_secs()
            );
            return Failure {
                code: None,
                message,
            };
        }
        let code = status.code();
        let message = spoken(stderr).unwrap_or_else(|| match code {
            Some(code) => format!("ended with exit code {code} and no message"),
            None => "was ended by a signal".to_string(),
        });
        Failure { code, message }
    }
}

/// An mpirun that should have ended gets this time to end itself and its ranks.
const LATE: Duration = Duration::from_secs(20);

/// Ends a job: mpirun ends its ranks when it is asked to end; if it does not, it is killed.
fn end(child: &mut Child) -> Result<ExitStatus> {
    signals::terminate(child);
    let clock = Instant::now();
    while clock.elapsed() < LATE {
        if let Some(status) = child.try_wait().map_err(lost)? {
            return Ok(status);
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    let _ = child.kill();
    child.wait().map_err(lost)
}

fn lost(e: std::io::Error) -> Error {
    Error::environment("mpirun is lost").because(e)
}

/// An error if a signal has come that asks this process to end.
///
/// # Errors
/// [`ErrorKind::Environment`](base::ErrorKind::Environment) with the name of the signal.
pub fn interrupted() -> Result<()> {
    match Signals::noted() {
        None => Ok(()),
        Some(signal) => Err(Error::environment(format!(
            "ended by {signal}, and the processes that were started with it"
        ))),
    }
}

/// Reads a record that a process has left.
pub fn read<T: DeserializeOwned>(text: &str) -> Result<T> {
    serde_json::from_str(text)
        .map_err(|e| Error::environment("a process has left an unreadable result").because(e))
}

/// Reads the task in `file` in a process that the program has started; `what` names the expected task. On all ranks.
/// Collective.
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input) for a file that is no such task.
pub fn task<T: DeserializeOwned>(session: &Session, file: &Path, what: &str) -> Result<T> {
    let read = || -> std::result::Result<T, String> {
        let text = std::fs::read_to_string(file).map_err(|e| e.to_string())?;
        serde_json::from_str(&text).map_err(|e| e.to_string())
    };
    session.agree(read().map_err(|e| {
        let file = file.display();
        Error::input(format!("{file}: {e}, expected {what}"))
    }))
}

/// Writes the record of the job in `file` on rank 0, and the options that it has asked for. Collective.
///
/// # Errors
/// [`ErrorKind::Environment`](base::ErrorKind::Environment) with the path.
pub fn leave<T: Serialize>(session: &Session, file: &Path, found: &T) -> Result<()> {
    let write = || {
        let all = Options::new(session, "");
        let left: Vec<String> = all.left()?.into_iter().map(|(name, _)| name).collect();
        let mut names: Vec<String> = all.all()?.into_iter().map(|(name, _)| name).collect();
        names.retain(|name| !left.contains(name));
        json::write(&asked(file), &names)?;
        json::write(&record(file), found)
    };
    session.agree(match session.rank() {
        0 => write(),
        _ => Ok(()),
    })
}

/// The file for the record of the job in `file`.
fn record(file: &Path) -> PathBuf {
    file.with_extension("json")
}

/// The file for the options that the job in `file` has asked for.
fn asked(file: &Path) -> PathBuf {
    file.with_extension("asked")
}

/// The program's own error message among the output of mpirun and other ranks, or else the first message of mpirun.
fn spoken(stderr: &str) -> Option<String> {
    // mpirun frames its messages with dashes and hard line breaks.
    let is_frame = |l: &str| l.starts_with("---") || l.starts_with("===");
    let mut lines = stderr
        .lines()
        .map(str::trim)
        .filter(|l| !l.is_empty() && !is_frame(l));
    let Some(at) = lines.clone().position(|l| l.starts_with("Error")) else {
        let sentence: Vec<&str> = lines.take(3).collect();
        return (!sentence.is_empty()).then(|| sentence.join(" "));
    };
    let first = lines.nth(at)?;
    let text = first
        .split_once(": ")
        .map_or(first, |(_, rest)| rest)
        .to_string();
    // PETSc's own reason is in the first line below.
    if text.contains("failed with PETSc error") {
        if let Some(why) = lines.next() {
            return Some(format!("{text}: {why}"));
        }
    }
    Some(text)
}

/// The path of this program's executable.
///
/// # Errors
/// [`ErrorKind::Environment`](base::ErrorKind::Environment) where the system does not know it.
pub fn own() -> Result<PathBuf> {
    let own = std::env::current_exe();
    own.map_err(|e| Error::environment("the program's own path is unknown").because(e))
}

/// Removes environment variables that this process has inherited from an mpirun around it; they would mislead another
/// mpirun.
pub fn without_mpi(command: &mut Command) {
    // Settings about transports that a user may have made are kept.
    const KEPT: [&str; 6] = ["btl_", "btl", "pml", "mtl", "coll_", "opal_"];
    for (name, _) in std::env::vars_os() {
        let text = name.to_string_lossy();
        let foreign = ["OMPI_", "PMIX_", "PMI_", "ORTE_"]
            .iter()
            .any(|p| text.starts_with(p));
        let transport = text
            .strip_prefix("OMPI_MCA_")
            .is_some_and(|rest| KEPT.iter().any(|k| rest.starts_with(k)));
        if foreign && !transport {
            command.env_remove(&name);
        }
    }
}

/// Sets the environment of mpirun: there may be more ranks than cores.
fn environment(command: &mut Command, limit: Duration) {
    without_mpi(command);
    command
        .env("OMPI_MCA_rmaps_base_oversubscribe", "1")
        .env("OMPI_MCA_mpi_yield_when_idle", "1")
        .env("OMPI_MCA_hwloc_base_binding_policy", "none")
        .env("MPIEXEC_TIMEOUT", limit.as_secs().max(1).to_string())
        .env("OMP_NUM_THREADS", "1")
        .env("OPENBLAS_NUM_THREADS", "1");
    if is_root() {
        command
            .env("OMPI_ALLOW_RUN_AS_ROOT", "1")
            .env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
    }
}

fn is_root() -> bool {
    use std::os::unix::fs::MetadataExt;
    std::fs::metadata("/proc/self").is_ok_and(|m| m.uid() == 0)
}

#[cfg(test)]
#[path = "../../tests/baselines/launch.rs"]
mod tests;
