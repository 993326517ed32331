//! Running things under mpirun, and tests that run on several ranks.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::OnceLock;
use std::thread;
use std::time::{Duration, Instant};

use petsc::Session;

/// The result of a run.
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

/// Time limit: a run that hangs is a failure. Other work on the machine must not look like one.
const LIMIT: Duration = Duration::from_secs(1200);

/// A command that may start MPI, without the environment variables of MPI: a test that has started MPI in its own
/// process has some, and they would mislead another MPI program.
pub fn command(program: &str) -> Command {
    let mut command = Command::new(program);
    // MPI that begins in another thread adds variables of its own until the program is started.
    let of_mpi = |name: &str| {
        let prefixes = ["OMPI_", "PMIX_", "PMI_", "ORTE_"];
        prefixes.iter().any(|p| name.starts_with(p))
    };
    let others = std::env::vars_os().filter(|v| !of_mpi(&v.0.to_string_lossy()));
    command.env_clear().envs(others);
    command
        // Containers run as root, and small machines have fewer cores than ranks.
        .env("OMPI_ALLOW_RUN_AS_ROOT", "1")
        .env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
        .env("OMPI_MCA_rmaps_base_oversubscribe", "1")
        .env("OMPI_MCA_mpi_yield_when_idle", "1")
        .env("OMPI_MCA_hwloc_base_binding_policy", "none")
        // To look for networks takes 0.2 s, thousands of times.
        .env("OMPI_MCA_pml", "ob1")
        .env("RUST_BACKTRACE", "0");
    command
}

/// As `command`, for a program that uses PETSc, or starts ranks that do. Ranks sleep where they wait long: beside two
/// programs that compute, a test of five seconds takes fifteen with that, and 140 without. And a program starts in
/// 0.07 s of a core in place of 0.11 s.
pub fn of_petsc(program: &str) -> Command {
    let mut command = command(program);
    command.env("LD_PRELOAD", patient());
    command
}

/// The library of `patient.c`, which is built beside the tests.
fn patient() -> &'static Path {
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    PATH.get_or_init(|| {
        // Packages with such tests lie in the root of the repository, and in crates/.
        let package = Path::new(env!("CARGO_MANIFEST_DIR"));
        let root = package.ancestors().find(|d| d.join("Cargo.lock").is_file());
        let source = root.expect("a workspace").join("tests/support/patient.c");
        let own = std::env::current_exe().expect("the test knows its own path");
        let (name, pid) = ("patient.so", std::process::id());
        let fresh = own.with_file_name(format!("{name}.{pid}"));
        let mut compiler = Command::new("cc");
        let name_of_ml = "-Wl,-soname,libtrilinos_ml.so.13.2";
        compiler.args(["-O2", "-shared", "-fPIC", name_of_ml, "-o"]);
        let status = compiler.arg(&fresh).arg(&source).status();
        assert!(status.is_ok_and(|s| s.success()), "{source:?} can be built");
        // Other tests may be doing the same.
        let path = own.with_file_name(name);
        fs::rename(&fresh, &path).expect("a file can be renamed");
        path
    })
}

/// `mpirun -n ranks program args` with these extra environment variables.
pub fn mpirun(ranks: usize, program: &str, args: &[&str], env: &[(&str, &str)]) -> Output {
    let mut command = of_petsc("mpirun");
    command
        .arg("-n")
        .arg(ranks.to_string())
        .arg(program)
        .args(args)
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

const CASE: &str = "FETIFETI_TEST_CASE";

/// A test that runs on several ranks: it starts itself once more under mpirun.
pub struct Ranks {
    test: String,
}

/// Defines the work of a test on several ranks. In an ordinary run, returns the value that starts the ranks. In a
/// process started by [`Ranks::run`], runs `work` with PETSc and the name of the case and ends the process with its
/// exit code.
///
/// `work` must be a closure in the test itself: the name of its type contains the name of the test.
pub fn as_rank<W>(work: W) -> Ranks
where
    W: FnOnce(&Session, &str) -> base::Result<()>,
{
    Ranks::new::<W>(|case| {
        let session = Session::new(&[], "").expect("PETSc starts");
        session.run(|session| work(session, case))
    })
}

/// As `as_rank`, for a test that starts PETSc itself; `work` returns the exit code.
pub fn as_process<W: FnOnce(&str) -> i32>(work: W) -> Ranks {
    Ranks::new::<W>(work)
}

/// The name of the test that contains a closure of this type.
fn test_of<W>() -> &'static str {
    let path = std::any::type_name::<W>();
    let test = path.trim_end_matches("::{{closure}}");
    test.split_once("::").expect("a test of a program").1
}

/// Runs a test that uses PETSc in a process of its own: PETSc is bound to one thread of a process, and long tests would
/// wait for each other. `work` must be a closure in the test itself.
pub fn alone<W: FnOnce()>(work: W) {
    const ALONE: &str = "alone";
    if std::env::var(CASE).is_ok_and(|case| case == ALONE) {
        return work();
    }
    let own = std::env::current_exe().expect("the test knows its own path");
    let out = of_petsc(own.to_str().expect("the path is UTF-8"))
        .args(["--exact", test_of::<W>(), "--nocapture"])
        .env(CASE, ALONE)
        .output()
        .expect("it runs again");
    let text = String::from_utf8_lossy(&out.stdout);
    println!("{text}{}", String::from_utf8_lossy(&out.stderr));
    assert!(out.status.success() && text.contains("1 passed"));
}

impl Ranks {
    fn new<W>(work: impl FnOnce(&str) -> i32) -> Ranks {
        if let Ok(case) = std::env::var(CASE) {
            std::process::exit(work(&case));
        }
        let test = test_of::<W>().into();
        Ranks { test }
    }

    /// Runs a case on this many ranks.
    pub fn run(&self, ranks: usize, case: &str) -> Output {
        let own = std::env::current_exe().expect("the test knows its own path");
        let own = own.to_str().expect("the path is UTF-8");
        let args = ["--exact", &self.test, "--nocapture", "--test-threads=1"];
        let out = mpirun(ranks, own, &args, &[(CASE, case)]);
        // A rank ends before the test harness prints its summary: the summary appears only if no test has this name.
        let ran = !out.stdout.contains("test result:");
        assert!(ran, "no test {}: {}", self.test, out.all());
        out
    }

    /// As `run`, for a case that must succeed: returns the numbers that it prints after `RESULT`.
    pub fn numbers(&self, ranks: usize, case: &str) -> Vec<f64> {
        let out = self.run(ranks, case);
        assert_eq!(out.code, 0, "{}", out.all());
        let line = out.stdout.lines().find_map(|l| l.split("RESULT ").nth(1));
        let line = line.unwrap_or_else(|| panic!("{}", out.all()));
        let words = line.split_whitespace();
        words.map(|v| v.parse().expect("a number")).collect()
    }
}

/// A fresh directory that is removed again when the test ends.
pub struct Scratch(pub PathBuf);

impl Scratch {
    pub fn new(name: &str) -> Scratch {
        static NEXT: AtomicUsize = AtomicUsize::new(0);
        let next = NEXT.fetch_add(1, Ordering::Relaxed);
        let name = format!("fetifeti-test-{name}-{}-{next}", std::process::id());
        let dir = std::env::temp_dir().join(name);
        let _ = fs::remove_dir_all(&dir);
        fs::create_dir_all(&dir).expect("the directory can be made");
        Scratch(dir)
    }

    /// The path of `name` in the directory.
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

    /// Names of all files in the directory and below.
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
