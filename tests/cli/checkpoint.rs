//! `fetifeti solve --checkpoint FILE` and `--resume FILE`: an interrupted run resumes and finds the same answer, on any
//! number of ranks and by either method. Files that are no checkpoints of the scene are refused and not changed.

use crate::support::checks::number;
use crate::support::{mpi, program};
use std::fs;
use std::path::Path;

use fetifeti::checkpoint::{file::read, Checkpoint};
use mpi::{Output, Scratch};
use program::{fetifeti, run_fetifeti};
use serde_json::Value;

const MODEL: &str = "examples/scenes/model_contact.toml";
const PRESS: &str = "examples/scenes/press_ramp.toml";

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
fn solve(ranks: usize, scene: &str, code: i32, more: &[&str]) -> Value {
    let out = run_fetifeti(ranks, &[&["solve", scene, "--json", "-"], more].concat());
    assert_eq!(out.code, code, "{scene} {more:?}: {}", out.all());
    serde_json::from_str(&out.stdout).unwrap_or_else(|e| panic!("{e}: {}", out.all()))
}

fn checkpoint(path: &str) -> Checkpoint {
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
    assert_eq!(found.state.all.steps.to_string(), cut);
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
        assert_eq!(end.state.all.active, whole.state.all.active, "{what}");
        let own = end.state.all.steps - found.state.all.steps;
        assert!(own < whole.state.all.steps, "{what}: {own} steps");
        // The report covers both parts of the run.
        let steps = warm["contact"]["steps"].as_array().expect("a list");
        assert_eq!(steps.len(), end.state.all.steps, "{what}");
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
    for case in fetifeti::study::hard_cases::trackers() {
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
    let mesh = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/scenes/die.msh");
    let die = std::fs::read_to_string("examples/scenes/die.toml").expect("the example");
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
        let (a, b) = (&one.state, &other.state);
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
        let before = checkpoint(&file).state;
        let files = ["--resume", &file, "--checkpoint", &file];
        let report = solve(ranks, &scene, 0, &files);
        let after = checkpoint(&file).state;
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
    assert_eq!(found.load_step, cut - 1);
    assert_eq!(found.state.all.steps, most - 1);
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
    assert_eq!(checkpoint(&file).load_step, n - 1);
}

/// One sentence on stderr with these parts, nothing on stdout.
fn refused(out: &Output, code: i32, parts: &[&str]) {
    assert_eq!(out.code, code, "{}", out.all());
    assert!(out.stderr.starts_with("Error: "), "{}", out.all());
    assert_eq!(out.stderr.lines().count(), 1, "{}", out.all());
    assert_eq!(out.stdout, "", "{}", out.all());
    for part in parts {
        assert!(out.stderr.contains(part), "\"{part}\": {}", out.all());
    }
}

#[test]
fn bad_files_are_refused_and_stay() {
    let scratch = Scratch::new("bad-checkpoint");
    let good = scratch.path("good");
    solve(
        1,
        MODEL,
        1,
        &["--checkpoint", &good, "-fetifeti_contact_max_it", "1"],
    );
    let good = fs::read(&good).expect("the file");
    let n = good.len();
    let file = scratch.path("bad.ckpt");
    let resume = |bytes: &[u8], parts: &[&str]| {
        fs::write(&file, bytes).expect("written");
        let out = fetifeti(&["solve", MODEL, "--resume", &file, "--checkpoint", &file]);
        refused(&out, 2, &[&["bad.ckpt", "expected"], parts].concat());
        assert_eq!(fs::read(&file).expect("still there"), bytes);
    };
    for length in [0, 7, 20, 31, 32, 60, n / 2, n - 9, n - 1] {
        resume(&good[..length], &["truncated", &format!("{length} bytes")]);
    }
    for at in [33, n / 3, n / 2, n - 3] {
        let mut bytes = good.clone();
        bytes[at] ^= 0x10;
        resume(&bytes, &["damaged", "checksum"]);
    }
    resume(
        &[&good[..], b"more"].concat(),
        &["damaged", &format!("{} bytes", n + 4)],
    );
    let mut older = good.clone();
    older[20..24].copy_from_slice(&1u32.to_le_bytes());
    resume(&older, &["format 1", "format 3"]);
    let foreign = fs::read(MODEL).expect("the scene");
    resume(&foreign, &["no checkpoint"]);
    assert_eq!(scratch.files().len(), 2, "{:?}", scratch.files());

    let missing = fetifeti(&["solve", MODEL, "--resume", &scratch.path("nowhere")]);
    refused(&missing, 2, &["nowhere", "cannot be read"]);
    // The message is printed once, on any number of ranks.
    let out = run_fetifeti(2, &["solve", MODEL, "--resume", MODEL]);
    assert_eq!(out.code, 2, "{}", out.all());
    assert_eq!(
        out.stderr.matches("no checkpoint").count(),
        1,
        "{}",
        out.all()
    );
}

#[test]
fn a_checkpoint_belongs_to_its_scene() {
    let scratch = Scratch::new("other-scene");
    let file = scratch.path("c");
    let text = fs::read_to_string(MODEL).expect("the scene");
    solve(
        1,
        MODEL,
        1,
        &["--checkpoint", &file, "-fetifeti_contact_max_it", "1"],
    );
    let changed = |name: &str, from: &str, to: &str| {
        assert!(text.contains(from));
        scratch.file(name, &text.replace(from, to))
    };
    let resume = |scene: &str| fetifeti(&["solve", scene, "--resume", &file, "--quiet"]);
    // Words and options of the scene may change.
    let same = changed(
        "same.toml",
        "fetifeti_ksp_rtol = 1e-10",
        "fetifeti_ksp_rtol = 1e-9 # looser",
    );
    assert_eq!(resume(&same).code, 0, "{}", resume(&same).all());
    let heavier = changed("heavier.toml", "value = -3", "value = -4");
    refused(
        &resume(&heavier),
        2,
        &["The model problem", "changed", "heavier.toml"],
    );
    let finer = changed("finer.toml", "elements = 32", "elements = 64");
    refused(&resume(&finer), 2, &["The model problem", "finer.toml"]);
    refused(&resume(PRESS), 2, &["The model problem", "A press"]);
    let tied = "examples/scenes/model_tied.toml";
    refused(
        &resume(tied),
        2,
        &["--resume", "model_tied.toml", "inequalities"],
    );
    let out = fetifeti(&["solve", tied, "--checkpoint", &file]);
    refused(&out, 2, &["--checkpoint", "model_tied.toml"]);
}

#[test]
fn a_place_that_cannot_be_written_is_found_before_the_work() {
    let scratch = Scratch::new("unwritable");
    let file = scratch.file("file", "old");
    let below = format!("{file}/c");
    refused(
        &fetifeti(&["solve", MODEL, "--checkpoint", &below]),
        3,
        &["file"],
    );
    let dir = scratch.0.to_str().expect("UTF-8");
    refused(
        &fetifeti(&["solve", MODEL, "--checkpoint", dir]),
        3,
        &["directory"],
    );
    refused(
        &fetifeti(&["solve", MODEL, "--checkpoint", "-"]),
        2,
        &["standard output"],
    );
    assert_eq!(fs::read_to_string(&file).expect("still there"), "old");
    // A full disk ends the run with one sentence, on all ranks.
    for ranks in [1, 2] {
        let out = run_fetifeti(ranks, &["solve", MODEL, "--checkpoint", "/dev/full"]);
        assert_eq!(out.code, 3, "{}", out.all());
        assert_eq!(out.stderr.matches("/dev/full").count(), 1, "{}", out.all());
    }
    // An existing file is replaced as a whole, and no other file is left behind.
    solve(
        1,
        MODEL,
        1,
        &["--checkpoint", &file, "-fetifeti_contact_max_it", "1"],
    );
    assert_eq!(checkpoint(&file).state.all.steps, 1);
    assert_eq!(scratch.files().len(), 1, "{:?}", scratch.files());
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
    assert!(found.state.all.steps > 0 || found.load_step > 0);
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
