//! Running things under mpirun: the program itself, or one case of a test file on several ranks.
#![allow(dead_code)] // every test file uses its own part

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use fetifeti::petsc::Session;

/// What a run left behind.
pub struct Output {
    /// Exit code of mpirun; -1 when it was killed after the time limit.
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
    pub seconds: f64,
}

impl Output {
    /// Both streams, for messages.
    pub fn all(&self) -> String {
        format!("exit code {}\n{}\n{}", self.code, self.stdout, self.stderr)
    }
}

/// A run that hangs is a failure, not a wait.
const LIMIT: Duration = Duration::from_secs(120);

/// `mpirun -n ranks program args` with these extra environment variables.
pub fn mpirun(ranks: usize, program: &str, args: &[&str], env: &[(&str, &str)]) -> Output {
    let mut command = Command::new("mpirun");
    // A test that has started MPI in its own process carries variables that would lead mpirun astray.
    for (name, _) in std::env::vars_os() {
        let text = name.to_string_lossy();
        if ["OMPI_", "PMIX_", "PMI_", "ORTE_"]
            .iter()
            .any(|p| text.starts_with(p))
        {
            command.env_remove(&name);
        }
    }
    command
        .arg("-n")
        .arg(ranks.to_string())
        .arg(program)
        .args(args)
        // Containers run as root, and small machines have fewer cores than ranks.
        .env("OMPI_ALLOW_RUN_AS_ROOT", "1")
        .env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
        .env("OMPI_MCA_rmaps_base_oversubscribe", "1")
        .env("OMPI_MCA_mpi_yield_when_idle", "1")
        .env("OMPI_MCA_hwloc_base_binding_policy", "none")
        .env("RUST_BACKTRACE", "0")
        .envs(env.iter().copied())
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let start = Instant::now();
    let mut child = command.spawn().expect("mpirun starts");
    let out = collect(child.stdout.take().expect("stdout is piped"));
    let err = collect(child.stderr.take().expect("stderr is piped"));
    let code = loop {
        if let Some(status) = child.try_wait().expect("mpirun can be waited for") {
            break status.code().unwrap_or(-2);
        }
        if start.elapsed() > LIMIT {
            child.kill().expect("mpirun can be killed");
            child.wait().expect("mpirun ends");
            break -1;
        }
        thread::sleep(Duration::from_millis(10));
    };
    Output {
        code,
        stdout: out.join().expect("the reader does not panic"),
        stderr: err.join().expect("the reader does not panic"),
        seconds: start.elapsed().as_secs_f64(),
    }
}

fn collect(mut stream: impl Read + Send + 'static) -> thread::JoinHandle<String> {
    thread::spawn(move || {
        let mut bytes = Vec::new();
        stream
            .read_to_end(&mut bytes)
            .expect("the stream can be read");
        String::from_utf8_lossy(&bytes).into_owned()
    })
}

/// `mpirun -n ranks fetifeti args`.
pub fn run_fetifeti(ranks: usize, args: &[&str]) -> Output {
    mpirun(ranks, env!("CARGO_BIN_EXE_fetifeti"), args, &[])
}

const CASE: &str = "FETIFETI_TEST_CASE";

/// Runs one case of the calling test file on several ranks: this executable starts itself again under mpirun, where only its
/// test `on_ranks` runs and finds the name by [`case`].
pub fn run_case(ranks: usize, case: &str) -> Output {
    let own = std::env::current_exe().expect("the test knows its own path");
    mpirun(
        ranks,
        own.to_str().expect("the path is UTF-8"),
        &["--exact", "on_ranks", "--nocapture", "--test-threads=1"],
        &[(CASE, case)],
    )
}

/// The body of a test `on_ranks`: where this process is a rank that [`run_case`] has started, runs `work` with PETSc and the name
/// of the case and ends the process with its exit code; otherwise does nothing.
pub fn as_rank(work: impl FnOnce(&Session, &str) -> fetifeti::Result<()>) {
    let Some(case) = case() else {
        return;
    };
    let session = Session::new(&[], "").expect("PETSc starts");
    let code = session.run(|session| work(session, &case));
    drop(session);
    std::process::exit(code);
}

/// The case that this process is to run as a rank; `None` in the ordinary test run.
pub fn case() -> Option<String> {
    std::env::var(CASE).ok()
}

/// `fetifeti args` without mpirun.
pub fn fetifeti(args: &[&str]) -> Output {
    let start = Instant::now();
    let out = Command::new(env!("CARGO_BIN_EXE_fetifeti"))
        .args(args)
        .env("RUST_BACKTRACE", "0")
        .stdin(Stdio::null())
        .output()
        .expect("the program starts");
    Output {
        code: out.status.code().unwrap_or(-2),
        stdout: String::from_utf8_lossy(&out.stdout).into_owned(),
        stderr: String::from_utf8_lossy(&out.stderr).into_owned(),
        seconds: start.elapsed().as_secs_f64(),
    }
}

/// A fresh directory that is removed again when the test ends.
pub struct Scratch(pub PathBuf);

impl Scratch {
    pub fn new(name: &str) -> Scratch {
        let dir = std::env::temp_dir().join(format!("fetifeti-test-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&dir);
        fs::create_dir_all(&dir).expect("the directory can be made");
        Scratch(dir)
    }

    /// The path of `name` in it.
    pub fn path(&self, name: &str) -> String {
        self.0
            .join(name)
            .to_str()
            .expect("the path is UTF-8")
            .to_string()
    }

    /// Writes a file and returns its path.
    pub fn file(&self, name: &str, text: &str) -> String {
        fs::write(self.0.join(name), text).expect("the file can be written");
        self.path(name)
    }

    /// Names of all files in it and below.
    pub fn files(&self) -> Vec<String> {
        fn walk(dir: &Path, out: &mut Vec<String>) {
            for entry in fs::read_dir(dir).expect("the directory can be read") {
                let path = entry.expect("the entry can be read").path();
                if path.is_dir() {
                    walk(&path, out);
                } else {
                    out.push(path.display().to_string());
                }
            }
        }
        let mut out = Vec::new();
        walk(&self.0, &mut out);
        out
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}
