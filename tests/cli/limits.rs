//! What does not fit, or is too large to be computed with, is refused with a sentence before the work.

use std::process::Stdio;

use crate::support::mpi::{command, Scratch};
use crate::support::program::{fetifeti, run_fetifeti, PATH};

fn grid(subdomains: usize, elements: usize, more: &str) -> String {
    format!(
        "[grid]\nbodies = 1\nsubdomains = {subdomains}\nelements_per_subdomain = {elements}\n\
         dirichlet = [\"left\"]\n{more}\n"
    )
}

/// One sentence with `parts` on standard error, and nothing else.
fn refused(code: Option<i32>, stdout: &str, stderr: &str, parts: &[&str]) {
    assert_eq!(code, Some(3), "{stderr}");
    assert_eq!((stdout, stderr.lines().count()), ("", 1), "{stderr}");
    for part in parts {
        assert!(stderr.contains(part), "\"{part}\" is missing: {stderr}");
    }
}

#[test]
fn what_does_not_fit_is_refused_before_it_is_made() {
    let scratch = Scratch::new("limits");
    let asked = ["plan", "solve"];
    for (text, need) in [
        // 10⁹ elements, 10⁶ subdomains, and one subdomain that is too large for the limit of this process.
        (grid(100, 320, ""), "1.0e9 elements in 10000 subdomains"),
        (grid(1000, 2, ""), "4.0e6 elements in 1.0e6 subdomains"),
        (grid(1, 9999, ""), "1.0e8 elements in 1 subdomains"),
        (grid(1, 9999, "order = 2"), "1.0e8 elements in 1 subdomains"),
    ] {
        let scene = scratch.file("large.toml", &text);
        for verb in asked {
            let limited = format!("ulimit -v 3000000 && exec {PATH} {verb} {scene}");
            let out = command("sh")
                .args(["-c", &limited])
                .stdin(Stdio::null())
                .output()
                .expect("a shell");
            let [stdout, stderr] = [&out.stdout, &out.stderr].map(|b| String::from_utf8_lossy(b));
            let parts = [need, "ulimit -v", "-fetifeti_memory_limit", "large.toml: "];
            refused(out.status.code(), &stdout, &stderr, &parts);
        }
    }
}

#[test]
fn the_limit_can_be_set() {
    let scene = "../../examples/scenes/model_contact.toml";
    let out = fetifeti(&["solve", scene, "-fetifeti_memory_limit", "40"]);
    let parts = [scene, "where 40 MB of -fetifeti_memory_limit are left"];
    refused(Some(out.code), &out.stdout, &out.stderr, &parts);
    let out = fetifeti(&["solve", scene, "-fetifeti_memory_limit", "1000"]);
    assert_eq!((out.code, out.stderr.as_str()), (0, ""), "{}", out.all());
    // All ranks of a machine share it.
    let out = run_fetifeti(2, &["plan", scene, "-fetifeti_memory_limit", "60"]);
    assert_eq!(out.code, 3, "{}", out.all());
    assert!(out.stderr.contains("on each of 2 ranks"), "{}", out.all());
}

#[test]
fn rows_of_table_1_have_the_limits_of_scenes() {
    for (row, code, part) in [
        ("100000,1,3", 2, "100000 × 100000 bodies"),
        ("2,99999,99999", 2, "elements along a side of a body"),
        ("2,1,400000", 3, "6.4e11 elements"),
    ] {
        let out = fetifeti(&["table1", "--rows", row]);
        assert_eq!((out.code, out.stdout.as_str()), (code, ""), "{}", out.all());
        assert!(out.stderr.contains(part), "{}", out.all());
        assert!(out.stderr.contains(row), "{}", out.all());
    }
}

#[test]
fn numbers_beyond_all_units_are_named() {
    let scratch = Scratch::new("units");
    for (more, part) in [
        ("load = 1e308", "load 1e308 where"),
        ("rho = 1e308", "ρ = 1e308 where"),
        ("rho = 1e-308", "ρ = 1e-308 where"),
        ("size = 1e300", "size 1e300 in x"),
        ("origin = [1e300, 0]", "origin 1e300 in x"),
        ("load = \"1e300*exp(x)\"", "load "),
        // Each is a number that could be, together they are not.
        ("load = 1e100\nsize = 1e45", "take other units"),
    ] {
        let scene = scratch.file("units.toml", &grid(2, 4, more));
        let out = fetifeti(&["solve", &scene]);
        assert_eq!(
            (out.code, out.stdout.as_str()),
            (2, ""),
            "{more}: {}",
            out.all()
        );
        assert_eq!(out.stderr.lines().count(), 1, "{more}: {}", out.all());
        assert!(out.stderr.contains(part), "{more}: {}", out.all());
        assert!(
            out.stderr.contains("take other units"),
            "{more}: {}",
            out.all()
        );
    }
}

/// Gaps, and lengths of meshes by their scale.
#[test]
fn gaps_and_meshes_beyond_all_units_are_named() {
    let scratch = Scratch::new("lengths");
    let refused = |text: String, part: &str| {
        let scene = scratch.file("lengths.toml", &text);
        let out = fetifeti(&["solve", &scene]);
        assert_eq!((out.code, out.stdout.as_str()), (2, ""), "{}", out.all());
        assert_eq!(out.stderr.lines().count(), 1, "{}", out.all());
        for part in ["lengths.toml:", part] {
            assert!(out.stderr.contains(part), "{part}: {}", out.all());
        }
    };
    let scene = std::fs::read_to_string("../../examples/scenes/contact_gap_table.toml");
    let scene = scene.expect("the scene");
    let table = scene.lines().find(|l| l.starts_with("gap = "));
    let table = table.expect("a gap");
    for (gap, part) in [
        (
            "1e308",
            "is 1e308 at (0, 1) where at most 1e50 was expected",
        ),
        ("nan", "nan where a finite number was expected"),
        ("\"1/0\"", "is inf at (0, 1) where a finite number"),
        ("[[0, 1e308], [1, 0]]", "is 1e308 at (0, 1)"),
    ] {
        refused(scene.replace(table, &format!("gap = {gap}")), part);
    }
    let mesh = "[mesh]\nfile = \"FILE\"\nscale = SCALE\n[[body]]\nname = \"quads\"\ndirichlet = [\"all\"]\n";
    let file =
        std::fs::canonicalize("../../tests/fixtures/meshes/plate.gmsh22.msh").expect("a mesh");
    let mesh = mesh.replace("FILE", &file.display().to_string());
    for scale in ["1e300", "1e-300"] {
        refused(mesh.replace("SCALE", scale), "(take another `scale`)");
    }
}

/// Devices that have no end; a pipe has one.
#[test]
fn what_has_no_end_is_refused() {
    let zero = "/dev/zero";
    let contact = "../../examples/scenes/model_contact.toml";
    for (args, part) in [
        (&["solve", zero][..], "has more than 256 MB, or no end"),
        (&["plan", zero], "has more than 256 MB, or no end"),
        (&["solve", contact, "--resume", zero], "is no checkpoint"),
        (
            &["solve", contact, "-options_file", zero],
            "a device, where",
        ),
    ] {
        let out = fetifeti(args);
        assert_eq!((out.code, out.stdout.as_str()), (2, ""), "{}", out.all());
        assert_eq!(out.stderr.lines().count(), 1, "{}", out.all());
        for part in [zero, part] {
            assert!(out.stderr.contains(part), "{}", out.all());
        }
    }
    let mut set = command(PATH);
    set.args(["solve", contact])
        .env("PETSC_OPTIONS", format!("-options_file {zero}"));
    let out = set.output().expect("the program");
    let said = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(2), "{said}");
    let expected = format!("Error: PETSC_OPTIONS: -options_file is {zero}, a device");
    assert!(said.starts_with(&expected), "{said}");
    let piped = format!("cat {contact} | {PATH} solve /dev/stdin --quiet -options_file /dev/null");
    let out = command("sh").args(["-c", &piped]).output();
    let out = out.expect("a shell");
    assert!(
        out.status.success(),
        "{}",
        String::from_utf8_lossy(&out.stderr)
    );
}
