//! Every example runs on one rank and on two, and its own check is satisfied.

use crate::support::mpi;
use std::path::PathBuf;
use std::process::Command;
use std::sync::OnceLock;

/// The path of an example, next to the directory of the test executables. A plain `cargo test` builds the examples; one
/// that names this test does not, or leaves older ones there.
fn path(name: &str) -> PathBuf {
    static BUILT: OnceLock<()> = OnceLock::new();
    BUILT.get_or_init(|| {
        let mut cargo = Command::new(env!("CARGO"));
        cargo
            .args(["build", "--quiet", "--examples"])
            .current_dir(env!("FETIFETI_ROOT"));
        if !cfg!(debug_assertions) {
            cargo.arg("--release");
        }
        let out = cargo.output().expect("cargo starts");
        assert!(
            out.status.success(),
            "{}",
            String::from_utf8_lossy(&out.stderr)
        );
    });
    let own = std::env::current_exe().expect("the test knows its own path");
    let profile = own.ancestors().nth(2).expect("target/<profile>/deps");
    profile.join("examples").join(name)
}

/// Runs an example and returns what it prints for the given labels.
fn run(name: &str, ranks: usize, labels: &[&str]) -> Vec<String> {
    let path = path(name);
    let out = mpi::mpirun(ranks, path.to_str().expect("UTF-8"), &[], &[]);
    assert_eq!(out.code, 0, "{name} on {ranks} ranks: {}", out.all());
    let line = |label: &&str| {
        let found = out.stdout.lines().find(|l| l.starts_with(*label));
        found
            .map(String::from)
            .unwrap_or_else(|| panic!("no line '{label}' in {}", out.all()))
    };
    labels.iter().map(line).collect()
}

/// Compares the printed facts on one rank and on two.
fn compare(name: &str, labels: &[&str]) {
    assert_eq!(run(name, 1, labels), run(name, 2, labels), "{name}");
}

#[test]
fn poisson_2x2() {
    compare(
        "poisson_2x2",
        &["multipliers", "spectrum", "iterations", "error in L2"],
    );
}

#[test]
fn feti1() {
    compare("feti1", &["bodies", "multipliers", "iterations"]);
}

#[test]
fn feti_dp() {
    compare("feti_dp", &["multipliers", "primal", "kappa"]);
}

#[test]
fn custom_substructures() {
    compare("custom_substructures", &["bodies", "multipliers", "kappa"]);
}

/// An example whose check cannot hold fails with a message: so the checks of the other runs are effective.
#[test]
fn a_check_can_fail() {
    let path = path("feti1");
    let args = ["-fetifeti_ksp_rtol", "1e-2"];
    let out = mpi::mpirun(2, path.to_str().expect("UTF-8"), &args, &[]);
    assert_ne!(out.code, 0, "{}", out.all());
    assert!(out.stderr.contains("not the solution"), "{}", out.all());
}
