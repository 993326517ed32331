//! A signal ends a comparison with all that it has started, and leaves nothing behind but results.

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::support::mpi::{command, Scratch};
use crate::support::program::PATH;
use report::json::BenchReport;

/// For hangs only.
const LIMIT: Duration = Duration::from_secs(300);

/// Looks until `found` is something.
fn wait_for<T>(what: &str, mut found: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(value) = found() {
            return value;
        }
        assert!(start.elapsed() < LIMIT, "waited in vain for {what}");
        sleep(Duration::from_millis(20));
    }
}

/// Starts the program with its temporary files in `tmp`.
fn start(args: &[&str], tmp: &str) -> Child {
    std::fs::create_dir_all(tmp).expect("a directory");
    command(PATH)
        .args(args)
        .env("TMPDIR", tmp)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts")
}

/// Ends it by a signal; checks that jobs and temporary files are gone.
fn end(mut child: Child, signal: &str, tmp: &str) {
    let pid = child.id().to_string();
    let kill = Command::new("kill").args(["-s", signal, &pid]).status();
    assert!(kill.expect("kill runs").success());
    let status = wait_for("the end", || {
        child.try_wait().expect("it can be waited for")
    });
    let mut said = String::new();
    let mut stderr = child.stderr.take().expect("stderr is piped");
    std::io::Read::read_to_string(&mut stderr, &mut said).expect("text");
    assert_eq!(status.code(), Some(3), "{said}");
    assert!(
        said.contains(&format!("Error: ended by SIG{signal}")),
        "{said}"
    );
    let left: Vec<String> = entries(Path::new(tmp));
    assert!(
        left.iter().all(|name| !name.starts_with("fetifeti-")),
        "{left:?}"
    );
    // mpirun waits for its ranks before it ends.
    let processes = std::fs::read_dir("/proc").expect("/proc").flatten();
    let lines = processes.filter_map(|p| std::fs::read(p.path().join("cmdline")).ok());
    let running = lines.filter(|line| String::from_utf8_lossy(line).contains(tmp));
    assert_eq!(running.count(), 0, "jobs are left");
}

fn entries(dir: &Path) -> Vec<String> {
    let all = std::fs::read_dir(dir).into_iter().flatten().flatten();
    all.map(|e| e.file_name().to_string_lossy().into_owned())
        .collect()
}

const SCENE: &str = "[grid]\nbodies = 2\nsubdomains = [2, 1]\nelements_per_subdomain = 4\n\
                     load = \"1 + x\"\ndirichlet = [\"left\"]\n";

#[test]
fn bench_keeps_its_results() {
    let scratch = Scratch::new("sig");
    let (scene, json) = (scratch.file("four.toml", SCENE), scratch.path("bench.json"));
    let tmp = scratch.path("tmp");
    let args = [
        "bench", &scene, "--rounds", "1000", "--with", "gamg", "--json", &json,
    ];
    let child = start(&[&args[..], &["-compare_cores", "1"]].concat(), &tmp);
    wait_for("a round", || Path::new(&json).is_file().then_some(()));
    end(child, "TERM", &tmp);
    let text = std::fs::read_to_string(&json).expect("the report");
    let report: BenchReport = serde_json::from_str(&text).expect("a whole report");
    assert!((1..1000).contains(&report.cases[0].rounds), "{text}");
    assert!(
        report.cases[0]
            .methods
            .iter()
            .all(|m| !m.samples.is_empty()),
        "{text}"
    );
}

#[test]
fn compare_ends_its_jobs() {
    let scratch = Scratch::new("sig");
    let large = SCENE.replace("elements_per_subdomain = 4", "elements_per_subdomain = 400");
    let (scene, tmp) = (scratch.file("large.toml", &large), scratch.path("tmp"));
    let child = start(&["compare", &scene, "--with", "mumps"], &tmp);
    wait_for("a job", || {
        let dirs = entries(Path::new(&tmp));
        let ours = dirs.iter().filter(|d| d.starts_with("fetifeti-"));
        let mut files = ours.flat_map(|d| entries(&Path::new(&tmp).join(d)));
        files.find(|f| f.ends_with(".err"))
    });
    end(child, "INT", &tmp);
}
