//! `fetifeti solve --checkpoint FILE` and `--resume FILE`: an interrupted run resumes and finds the same answer, on any
//! number of ranks and by either method.

use crate::support::checks::number;
use crate::support::{mpi, program};
use std::fs;
use std::path::Path;

use mpi::Scratch;
use program::run_fetifeti;
use scene::checkpoint::file::read;
use scene::Checkpoint;
use serde_json::Value;

pub const MODEL: &str = "../../examples/scenes/model_contact.toml";
pub const PRESS: &str = "../../examples/scenes/press_ramp.toml";

/// Two floating bodies and cross points: four bodies in contact, the lower left one held.
const FOUR: &str = r#"
title = "Four bodies"
[options]
fetifeti_ksp_rtol = 1e-11
[interface]
default = "free"
[[body]]
name = "a"
size = 1
elements = 8
subdomains = 2
dirichlet = ["left"]
load = "-1 - x + y"
[[body]]
name = "b"
origin = [1, 0]
size = 1
elements = 8
subdomains = 2
load = "-2 + 3*y"
[[body]]
name = "c"
origin = [0, 1]
size = 1
elements = 8
subdomains = 2
dirichlet = ["left"]
load = "sin(6*x)"
[[body]]
name = "d"
origin = [1, 1]
size = 1
elements = 8
subdomains = 2
load = "-1 + cos(9*y)"
[[contact]]
bodies = ["a", "b"]
gap = 0
[[contact]]
bodies = ["c", "d"]
gap = "0.01*y"
[[contact]]
bodies = ["a", "c"]
gap = 0.002
[[contact]]
bodies = ["b", "d"]
gap = 0.001
"#;

fn near(a: &Value, b: &Value) -> bool {
    let (a, b) = (number(a), number(b));
    (a - b).abs() <= 1e-10 * b.abs()
}

/// `solve` on these ranks with the report on standard output, and its exit code.
pub fn solve(ranks: usize, scene: &str, code: i32, more: &[&str]) -> Value {
    let out = run_fetifeti(ranks, &[&["solve", scene, "--json", "-"], more].concat());
    assert_eq!(out.code, code, "{scene} {more:?}: {}", out.all());
    serde_json::from_str(&out.stdout).unwrap_or_else(|e| panic!("{e}: {}", out.all()))
}

pub fn checkpoint(path: &str) -> Checkpoint {
    read(Path::new(path)).expect("a checkpoint")
}

fn count(report: &Value) -> u64 {
    report["iterations"]["total"].as_u64().expect("a count")
}

/// A run that is interrupted after `cut` outer steps resumes, and finds the answer of an uninterrupted run.
fn goes_on(scratch: &Scratch, scene: &str, method: &str, cut: &str, resume: &[(usize, &str)]) {
    let kind = ["-fetifeti_contact_type", method];
    let (whole, part) = (scratch.path("whole"), scratch.path("part"));
    let cold = solve(
        1,
        scene,
        0,
        &[&kind[..], &["--checkpoint", &whole]].concat(),
    );
    let limit = ["-fetifeti_contact_max_it", cut, "--checkpoint", &part];
    let early = solve(1, scene, 1, &[&kind[..], &limit].concat());
    assert_eq!(early["converged_reason"], "DIVERGED_CONTACT_ITS");
    let (whole, found) = (checkpoint(&whole), checkpoint(&part));
    assert_eq!(found.stepper.contact.all.steps.to_string(), cut);
    assert_eq!(found.scene, whole.scene);
    let end = scratch.path("end");
    for &(ranks, method) in resume {
        let what = format!("{scene}, {cut} steps, then {method} on {ranks} ranks");
        let kind = ["-fetifeti_contact_type", method];
        let files = ["--resume", &part, "--checkpoint", &end];
        let distribution = ["-fetifeti_distribution", "cyclic"];
        let warm = solve(
            ranks,
            scene,
            0,
            &[&kind[..], &files, &distribution].concat(),
        );
        assert!(near(&warm["energy"], &cold["energy"]), "{what}");
        for key in ["candidates", "active"] {
            assert_eq!(warm["contact"][key], cold["contact"][key], "{what}: {key}");
        }
        let end = checkpoint(&end);
        assert_eq!(
            end.stepper.contact.all.active, whole.stepper.contact.all.active,
            "{what}"
        );
        let own = end.stepper.contact.all.steps - found.stepper.contact.all.steps;
        assert!(own < whole.stepper.contact.all.steps, "{what}: {own} steps");
        // The report covers both parts of the run.
        let steps = warm["contact"]["steps"].as_array().expect("a list");
        assert_eq!(steps.len(), end.stepper.contact.all.steps, "{what}");
        assert_eq!(warm["outer_iterations"], steps.len(), "{what}");
        assert!(count(&warm) > count(&early), "{what}");
    }
    assert_eq!(
        found,
        checkpoint(&part),
        "a run must not touch what it resumes from"
    );
}

#[test]
fn an_active_set_run_goes_on() {
    let scratch = Scratch::new("resume-set");
    let ranks = [1, 2, 4].map(|n| (n, "active_set"));
    goes_on(
        &scratch,
        MODEL,
        "active_set",
        "2",
        &[&ranks[..], &[(2, "smalbe")]].concat(),
    );
}

#[test]
fn a_smalbe_run_goes_on() {
    let scratch = Scratch::new("resume-smalbe");
    let resume = [(1, "smalbe"), (4, "smalbe"), (2, "active_set")];
    goes_on(&scratch, MODEL, "smalbe", "2", &resume);
}

#[test]
fn bodies_around_a_point_go_on() {
    let scratch = Scratch::new("resume-four");
    let scene = scratch.file("four.toml", FOUR);
    goes_on(
        &scratch,
        &scene,
        "active_set",
        "3",
        &[(1, "active_set"), (3, "active_set")],
    );
}

/// Sides whose nodes do not match: rows of many terms, on other ranks than before.
#[test]
fn mortar_rows_go_on() {
    let scratch = Scratch::new("resume-mortar");
    for case in lab::study::hard_cases::trackers() {
        if case.name == "moose-10950-facets" || case.name == "flow123d-1381-crossing" {
            let tight = "[options]\nfetifeti_ksp_rtol = 1e-11\n";
            let scene = scratch.file("mortar.toml", &format!("{}{tight}", case.text));
            let resume = [(4, "active_set"), (7, "active_set"), (2, "smalbe")];
            goes_on(&scratch, &scene, "active_set", "2", &resume);
        }
    }
}

#[test]
fn rows_beside_a_rigid_surface_go_on() {
    let scratch = Scratch::new("resume-die");
    let mesh = concat!(env!("FETIFETI_ROOT"), "/examples/scenes/die.msh");
    let die = std::fs::read_to_string("../../examples/scenes/die.toml").expect("the example");
    let once = die
        .replace("[steps]\ncount = 5\n", "")
        .replace("die.msh", mesh);
    let once = once.replace("ramp = \"t\"\n", "");
    let tight = "[options]\nfetifeti_ksp_rtol = 1e-11\n";
    let scene = scratch.file("die.toml", &format!("{once}{tight}"));
    let resume = [(4, "active_set"), (7, "active_set"), (2, "smalbe")];
    goes_on(&scratch, &scene, "active_set", "2", &resume);
}

/// The checkpoint does not depend on the number of ranks. A permuted λ would not be a solution.
#[test]
fn a_solved_run_is_confirmed_on_any_ranks() {
    let scratch = Scratch::new("confirm");
    let scene = scratch.file("four.toml", FOUR);
    let path = |ranks: usize| scratch.path(&format!("on{ranks}"));
    let mut energy = None;
    for (ranks, distribution) in [(1, "block"), (4, "block"), (3, "cyclic")] {
        let file = path(ranks);
        let options = [
            "--checkpoint",
            &file,
            "-fetifeti_distribution",
            distribution,
        ];
        let report = solve(ranks, &scene, 0, &options);
        let first = energy.get_or_insert(report["energy"].clone());
        assert!(near(&report["energy"], first));
        let (one, other) = (checkpoint(&path(1)), checkpoint(&file));
        let (a, b) = (&one.stepper.contact, &other.stepper.contact);
        assert_eq!((one.scene, &one.title), (other.scene, &other.title));
        assert_eq!((&a.local, &a.blocks), (&b.local, &b.blocks));
        let (a, b) = (&a.all, &b.all);
        assert_eq!((&a.active, &a.before), (&b.active, &b.before));
        assert_eq!((a.progress, a.safeguarded), (b.progress, b.safeguarded));
        let largest = a.lambda.iter().fold(0.0f64, |m, l| m.max(l.abs()));
        for (x, y) in a.lambda.iter().zip(&b.lambda) {
            assert!((x - y).abs() < 1e-6 * largest, "{x} {y}");
        }
    }
    for (ranks, file) in [(1, path(4)), (2, path(1)), (4, path(3)), (3, path(4))] {
        // The same file may be read and written.
        let before = checkpoint(&file).stepper.contact;
        let files = ["--resume", &file, "--checkpoint", &file];
        let report = solve(ranks, &scene, 0, &files);
        let after = checkpoint(&file).stepper.contact;
        assert_eq!(after.all.steps, before.all.steps + 1);
        assert_eq!(after.all.active, before.all.active);
        let last = &report["contact"]["steps"].as_array().expect("a list")[before.all.steps];
        assert!(last["iterations"].as_u64().expect("a count") <= 1, "{last}");
        assert!(near(&report["energy"], energy.as_ref().expect("known")));
    }
}

#[test]
fn load_steps_go_on() {
    let scratch = Scratch::new("resume-press");
    let (file, dir) = (scratch.path("c"), scratch.path("out"));
    let cold = solve(1, PRESS, 0, &["-fetifeti_ksp_rtol", "1e-10"]);
    // The iteration limit suffices for the first load steps, but not for a later one.
    let needed = |load_step: usize| {
        let steps = cold["contact"]["steps"].as_array().expect("a list");
        let of_it = steps.iter().filter(|s| s["load_step"] == load_step);
        of_it.count()
    };
    let n = cold["contact"]["load_steps"]
        .as_array()
        .expect("a list")
        .len();
    let most = (1..=n).map(needed).max().expect("load steps");
    let cut = (2..=n)
        .find(|&k| needed(k) == most && needed(1) < most)
        .expect("a harder one");
    let limit = (most - 1).to_string();
    let options = [
        "-fetifeti_ksp_rtol",
        "1e-10",
        "--out",
        &dir,
        "--checkpoint",
        &file,
    ];
    solve(
        1,
        PRESS,
        1,
        &[&options[..], &["-fetifeti_contact_max_it", &limit]].concat(),
    );
    let found = checkpoint(&file);
    assert_eq!(found.stepper.load_step, cut - 1);
    assert_eq!(found.stepper.contact.all.steps, most - 1);
    for ranks in [2, 1] {
        let warm = solve(
            ranks,
            PRESS,
            0,
            &[&options[..], &["--resume", &file]].concat(),
        );
        let of = |r: &Value| {
            r["contact"]["load_steps"]
                .as_array()
                .expect("a list")
                .clone()
        };
        let (one, two) = (of(&cold), of(&warm));
        assert_eq!(one.len(), two.len());
        for (a, b) in one.iter().zip(&two) {
            assert!(near(&a["energy"], &b["energy"]), "{a} {b}");
            assert_eq!((&a["t"], &a["active"]), (&b["t"], &b["active"]));
        }
        let series = fs::read_to_string(format!("{dir}/solution.pvd")).expect("the series");
        assert_eq!(series.matches("<DataSet").count(), n, "{series}");
    }
    assert_eq!(checkpoint(&file).stepper.load_step, n - 1);
}

/// Whenever the run is interrupted, the file is a checkpoint of a finished step.
#[test]
fn a_run_that_is_killed_leaves_a_whole_file() {
    let scratch = Scratch::new("killed");
    let file = scratch.path("c");
    let mut child = std::process::Command::new(program::PATH)
        .args(["solve", PRESS, "--quiet", "--checkpoint", &file])
        .spawn()
        .expect("the program starts");
    while !Path::new(&file).exists() {
        if child.try_wait().expect("it can be asked").is_some() {
            break;
        }
        std::thread::yield_now();
    }
    let _ = child.kill();
    child.wait().expect("it ends");
    let found = checkpoint(&file);
    assert!(found.stepper.contact.all.steps > 0 || found.stepper.load_step > 0);
    let cold = solve(1, PRESS, 0, &["-fetifeti_ksp_rtol", "1e-10"]);
    let warm = solve(
        1,
        PRESS,
        0,
        &["--resume", &file, "-fetifeti_ksp_rtol", "1e-10"],
    );
    assert!(near(&warm["energy"], &cold["energy"]));
    assert_eq!(warm["contact"]["active"], cold["contact"]["active"]);
}
