//! Checkpoints that cannot be read or written, and files that are no checkpoints of the scene: they are refused and not
//! changed.

use super::checkpoint::{checkpoint, solve, MODEL, PRESS};
use crate::support::{mpi, program};
use mpi::{Output, Scratch};
use program::{fetifeti, run_fetifeti};
use std::fs;

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
    resume(&older, &["format 1", "format 5"]);
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
    let tied = "../../examples/scenes/model_tied.toml";
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
    // Events go to files, too.
    let events = |place: &str| fetifeti(&["solve", MODEL, "--events", place]);
    refused(&events(&below), 3, &["file/c: "]);
    refused(&events("-"), 2, &["--events - is standard output"]);
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
    assert_eq!(checkpoint(&file).stepper.contact.all.steps, 1);
    assert_eq!(scratch.files().len(), 1, "{:?}", scratch.files());
}
