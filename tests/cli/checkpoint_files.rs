//! What a checkpoint belongs to: the scene with the files that it reads.

use std::fs;

use crate::support::checks::number;
use crate::support::{mpi, program};
use mpi::Scratch;
use program::{fetifeti, run_fetifeti};
use serde_json::Value;

/// The energy that `solve` reports on one rank; it must end with this exit code.
fn energy(scene: &str, code: i32, more: &[&str]) -> f64 {
    let out = fetifeti(&[&["solve", scene, "--json", "-"], more].concat());
    assert_eq!(out.code, code, "{more:?}: {}", out.all());
    let report: Value = serde_json::from_str(&out.stdout).expect("a report");
    number(&report["energy"])
}

#[test]
fn coefficients_in_files_belong_to_the_scene() {
    let scratch = Scratch::new("checkpoint-files");
    // 8 × 8 elements of the left body, a number each.
    let values = |last: &str| format!("{}{last}\n", "1\n".repeat(63));
    let data = scratch.file("rho.txt", &values("1"));
    let scene = scratch.file(
        "scene.toml",
        "[[body]]\nname = \"left\"\nsize = 1\nelements = 8\nsubdomains = 2\n\
         rho = { file = \"rho.txt\" }\ndirichlet = [\"left\"]\n\
         load = [{ y = [0.75, 1], value = -3 }]\n\
         [[body]]\nname = \"right\"\norigin = [1, 0]\nsize = 1\nelements = 8\nsubdomains = 2\n\
         load = [{ y = [0, 0.25], value = -1 }]\n\
         [[contact]]\nbodies = [\"left\", \"right\"]\ngap = 0\n",
    );
    let file = scratch.path("state");
    let stop = ["--checkpoint", &file, "-fetifeti_contact_max_it", "1"];
    energy(&scene, 1, &stop);
    let whole = energy(&scene, 0, &[]);
    let resumed = energy(&scene, 0, &["--resume", &file]);
    assert!((resumed - whole).abs() < 1e-9 * whole.abs());
    // One coefficient is another one: the scene is another one, though its own text is the same.
    fs::write(&data, values("5")).expect("written");
    let changed = "as it was before it changed";
    let out = fetifeti(&["solve", &scene, "--resume", &file]);
    assert_eq!(out.code, 2, "{}", out.all());
    assert_eq!(out.stderr.lines().count(), 1, "{}", out.all());
    assert!(out.stderr.contains(changed), "{}", out.all());
    let out = run_fetifeti(2, &["solve", &scene, "--resume", &file]);
    assert_eq!(out.code, 2, "{}", out.all());
    assert_eq!(out.stderr.matches(changed).count(), 1, "{}", out.all());
    // The same numbers again are the same scene.
    fs::write(&data, values("1")).expect("written");
    energy(&scene, 0, &["--resume", &file]);
}
