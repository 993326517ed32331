//! Runs that a signal ends: the checkpoint is whole, so are the results so far, and the exit code says it.

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::faults::whole;
use crate::support::mpi::{of_petsc, Scratch};
use crate::support::program::PATH;
use scene::checkpoint::{file::read, NoRecords};

/// For hangs only.
const LIMIT: Duration = Duration::from_secs(300);

/// A run of more load steps than anyone waits for, or of one solve without an end.
struct Run {
    scratch: Scratch,
    child: Child,
}

impl Run {
    fn start(ranks: usize, scene: &str, more: &[&str]) -> Run {
        let scratch = Scratch::new("ended");
        let scene = scratch.file("scene.toml", scene);
        let (out, checkpoint) = (scratch.path("out"), scratch.path("state"));
        let mut run = match ranks {
            1 => of_petsc(PATH),
            _ => {
                let mut run = of_petsc("mpirun");
                run.args(["-n", &ranks.to_string(), PATH]);
                run
            }
        };
        run.args(["solve", &scene, "--quiet", "--out", &out])
            .args(more);
        if more.is_empty() {
            run.args(["--checkpoint", &checkpoint]);
        }
        let run = run
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        let child = run.spawn().expect("it starts");
        Run { scratch, child }
    }

    /// Waits until so many load steps are written.
    fn after(&self, steps: usize) {
        let last = self.scratch.path(&format!("out/step_{steps:04}.vtu"));
        let start = Instant::now();
        while !Path::new(&last).is_file() {
            assert!(start.elapsed() < LIMIT, "waited in vain for {last}");
            sleep(Duration::from_millis(10));
        }
    }

    /// The last of its ranks.
    fn rank(&self) -> String {
        let scene = self.scratch.path("scene.toml");
        let processes = std::fs::read_dir("/proc").expect("/proc").flatten();
        let ours = processes.filter_map(|p| {
            let id: u32 = p.file_name().to_str()?.parse().ok()?;
            let line = std::fs::read_to_string(p.path().join("cmdline")).ok()?;
            (line.starts_with(PATH) && line.contains(&scene)).then_some(id)
        });
        ours.max().expect("a rank").to_string()
    }

    /// Sends a signal; returns the exit code and what was said.
    fn end(&mut self, signal: &str) -> (i32, String) {
        let kill = Command::new("kill")
            .args(["-s", signal, &self.rank()])
            .status();
        assert!(kill.expect("kill runs").success());
        let start = Instant::now();
        let status = loop {
            if let Some(status) = self.child.try_wait().expect("it can be waited for") {
                break status;
            }
            if start.elapsed() > LIMIT {
                let _ = self.child.kill();
                panic!("it hangs after SIG{signal}");
            }
            sleep(Duration::from_millis(10));
        };
        let mut said = String::new();
        let mut stderr = self.child.stderr.take().expect("stderr is piped");
        std::io::Read::read_to_string(&mut stderr, &mut said).expect("text");
        (status.code().unwrap_or(-1), said)
    }

    /// What was written is whole, and no more steps than the checkpoint knows.
    fn is_whole(&self) {
        let steps = whole(&self.scratch.path("out")) - 1;
        let state =
            read::<NoRecords>(Path::new(&self.scratch.path("state"))).expect("a checkpoint");
        // Killed between the two, it may have one of them only.
        assert!(
            state.stepper.load_step.abs_diff(steps) <= 1,
            "{} {steps}",
            state.stepper.load_step
        );
    }
}

fn many_steps() -> String {
    let text = std::fs::read_to_string("../../examples/scenes/press_ramp.toml").expect("the scene");
    text.replace("count = 10", "count = 100000")
}

#[test]
fn a_signal_ends_a_run_between_its_steps() {
    for (ranks, signal) in [(1, "TERM"), (2, "INT"), (4, "TERM")] {
        let mut run = Run::start(ranks, &many_steps(), &[]);
        run.after(12);
        let (code, said) = run.end(signal);
        assert_eq!(code, 3, "{said}");
        let sentence = format!("Error: ended by SIG{signal} in load step ");
        assert_eq!(said.matches(&sentence).count(), 1, "{said}");
        let resume = format!("--resume {} goes on", run.scratch.path("state"));
        assert!(said.contains(&resume), "{said}");
        run.is_whole();
        assert!(run.scratch.files().iter().all(|f| !f.ends_with(".tmp")));
    }
}

#[test]
fn a_rank_that_is_killed_ends_the_run() {
    for ranks in [1, 2, 4] {
        let mut run = Run::start(ranks, &many_steps(), &[]);
        run.after(12);
        let (code, said) = run.end("KILL");
        assert_ne!(code, 0, "{said}");
        for file in run.scratch.files().iter().filter(|f| f.ends_with(".tmp")) {
            std::fs::remove_file(file).expect("what was being written");
        }
        run.is_whole();
    }
}

/// A solve that never ends by itself: Richardson's iteration without a test.
#[test]
fn a_signal_ends_a_solve_in_its_middle() {
    let scene = "[grid]\nbodies = 2\nsubdomains = 2\nelements_per_subdomain = 8\nload = 1\n\
                 dirichlet = [\"left\"]\n[steps]\ncount = 2\nload = \"t\"\n";
    let endless = "-fetifeti_ksp_type richardson -fetifeti_ksp_norm_type none -fetifeti_ksp_max_it 1000000000";
    let endless: Vec<&str> = endless.split(' ').collect();
    for ranks in [1, 2, 4] {
        let mut run = Run::start(ranks, scene, &endless);
        sleep(Duration::from_secs(3));
        let (code, said) = run.end("TERM");
        assert_eq!(code, 3, "{said}");
        assert!(
            said.contains("Error: ended by SIGTERM in load step 1 of 2"),
            "{said}"
        );
    }
}
