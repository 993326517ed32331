//! The program's answers to bad input: one sentence, the right exit code, no file.

use crate::support::{mpi, program};
use mpi::{Output, Scratch};
use program::{fetifeti, run_fetifeti};

/// One sentence on stderr that contains `parts`; nothing on stdout.
fn refused(out: &Output, code: i32, parts: &[&str]) {
    assert_eq!(out.code, code, "{}", out.all());
    for noise in ["panicked", "PETSC ERROR", "MPI_ABORT", "() at "] {
        assert!(!out.stderr.contains(noise), "{}", out.all());
    }
    assert_eq!(out.stderr.matches("Error").count(), 1, "{}", out.all());
    for part in parts {
        assert!(
            out.stderr.contains(part),
            "\"{part}\" is missing: {}",
            out.all()
        );
    }
    assert_eq!(out.stdout, "", "{}", out.all());
}

/// `solve` refuses this text with exit code 2; it leaves no file behind, although all outputs were asked for.
fn bad_scene(text: &str, parts: &[&str]) {
    let scratch = Scratch::new("bad");
    let scene = scratch.file("s.toml", text);
    let (out, json) = (scratch.path("out"), scratch.path("report.json"));
    let run = fetifeti(&["solve", &scene, "--out", &out, "--json", &json]);
    refused(&run, 2, parts);
    assert_eq!(run.stderr.lines().count(), 1, "{}", run.all());
    assert!(run.stderr.starts_with("Error: "), "{}", run.all());
    assert_eq!(scratch.files(), [scene]);
}

pub const GRID: &str =
    "[grid]\nbodies = 2\nelements = 4\nsubdomains = 2\nload = 1\ndirichlet = \"all\"\n";
const EXAMPLE: &str = "../../examples/scenes/poisson_2x2.toml";

fn grid(line: &str) -> String {
    format!("{GRID}{line}\n")
}

/// A held body and another one at `x`, each of `subdomains`² subdomains.
pub fn two(x: &str, subdomains: usize, more: &str) -> String {
    format!(
        "[[body]]\nname = \"held\"\nsize = 1\nelements = 4\n\
         subdomains = {subdomains}\nload = 1\ndirichlet = [\"left\"]\n\
         [[body]]\nname = \"loose\"\norigin = [{x}, 0]\nsize = 1\n\
         elements = 4\nsubdomains = {subdomains}\nload = 1\n{more}"
    )
}

#[test]
fn keys_and_geometry() {
    bad_scene(&grid("rhoo = 2"), &["s.toml:7", "unknown key `rhoo`"]);
    bad_scene("[grid\n", &["s.toml:1", "not valid TOML"]);
    bad_scene(&two("0.5", 1, ""), &["`held` and `loose` overlap"]);
    let points = "[[tie]]\nbodies = [\"held\", \"loose\"]\npoints = [0.25]\n";
    let finer = two("1", 1, points).replacen("elements = 4", "elements = 3", 1);
    bad_scene(&finer, &["`held` and `loose` are tied", "matching nodes"]);
    bad_scene(
        &GRID.replace("elements = 4", "elements = 0"),
        &["s.toml:3", "positive"],
    );
    bad_scene(
        &GRID.replace("elements = 4", "elements = 5"),
        &["do not divide 5 elements"],
    );
}

#[test]
fn values() {
    bad_scene(&grid("rho = 0"), &["b0_0", "ρ = 0", "positive"]);
    bad_scene(&grid("rho = -1"), &["ρ = -1", "positive"]);
    bad_scene(
        &grid("rho = \"x - 0.5\""),
        &["ρ = -0.4375 at (0.0625, 0.0625)"],
    );
    bad_scene(&grid("rho = \"sqrt(x - 0.3)\""), &["ρ = NaN"]);
    bad_scene(&grid("rho = \"1/(x - 0.0625)\""), &["ρ = inf"]);
    bad_scene(&grid("rho = nan"), &["s.toml:7", "nan"]);
    bad_scene(
        &GRID.replace("load = 1", "load = \"log(x - 0.5)\""),
        &["load NaN"],
    );
    let nan = GRID.replace("\"all\"", "{ left = \"log(y - 0.5)\" }");
    bad_scene(&nan, &["Dirichlet value NaN", "side left"]);
}

#[test]
fn bodies_that_nothing_holds() {
    for subdomains in [1, 2] {
        // Apart, and side by side without a tie.
        let free = "[interface]\ndefault = \"free\"\n";
        for text in [two("3", subdomains, ""), two("1", subdomains, free)] {
            bad_scene(
                &text,
                &[
                    "body \"loose\" is held by nothing",
                    "expected a Dirichlet side or a tie",
                ],
            );
        }
        let row =
            format!("[grid]\nbodies = [3, 1]\nelements = 4\nsubdomains = {subdomains}\nload = 1\n");
        bad_scene(
            &row,
            &[
                "bodies \"b0_0\", \"b1_0\", \"b2_0\" are held by nothing",
                "does not balance",
            ],
        );
        let one = format!("[[body]]\nname = \"only\"\nsize = 1\nelements = 4\nsubdomains = {subdomains}\nload = 1\n");
        bad_scene(&one, &["body \"only\" is held by nothing"]);
    }
    // Five loose bodies: not all of them are listed.
    let row = "[grid]\nbodies = [5, 1]\nelements = 2\nload = 1\n";
    bad_scene(
        row,
        &["bodies \"b0_0\", \"b1_0\", \"b2_0\" and 2 more are held by nothing"],
    );
}

#[test]
fn files_that_cannot_be_read_or_written() {
    refused(
        &fetifeti(&["solve", "no/such.toml"]),
        2,
        &["no/such.toml", "cannot be read"],
    );
    refused(
        &fetifeti(&["plan", "no/such.toml"]),
        2,
        &["no/such.toml", "cannot be read"],
    );
    refused(&fetifeti(&["solve", "src"]), 2, &["src", "cannot be read"]);
    let scratch = Scratch::new("unwritable");
    let plain = scratch.file("plain", "");
    for (flag, target) in [
        ("--out", format!("{plain}/x")),
        ("--out", plain.clone()),
        ("--json", format!("{plain}/x.json")),
        ("--json", scratch.path("")),
        ("--json", "/proc/x.json".into()),
        ("--json", "/dev/full".into()),
    ] {
        let out = fetifeti(&["solve", EXAMPLE, "--quiet", flag, &target]);
        refused(&out, 3, &["cannot write"]);
        assert_eq!(scratch.files(), std::slice::from_ref(&plain));
    }
    let out = fetifeti(&[
        "table1",
        "--rows",
        "2,2,2",
        "--quiet",
        "--out",
        &format!("{plain}/x"),
    ]);
    refused(&out, 3, &["cannot write"]);
}

#[test]
fn a_full_standard_output_is_no_panic() {
    for args in [
        &["solve", EXAMPLE][..],
        &["plan", EXAMPLE],
        &["--help"],
        &["solve", EXAMPLE, "--json", "-"],
    ] {
        let full = std::fs::OpenOptions::new()
            .write(true)
            .open("/dev/full")
            .expect("/dev/full opens");
        let out = std::process::Command::new(program::PATH)
            .args(args)
            .stdout(full)
            .output()
            .expect("the program starts");
        let stderr = String::from_utf8_lossy(&out.stderr);
        assert_eq!(out.status.code(), Some(3), "{args:?}: {stderr}");
        assert!(
            stderr.starts_with("Error: cannot write to standard output: "),
            "{args:?}: {stderr}"
        );
        assert_eq!(stderr.lines().count(), 1, "{args:?}: {stderr}");
    }
}

#[test]
fn option_values() {
    for (option, value, parts) in [
        (
            "-fetifeti_pc_type",
            "nonsense",
            &["\"nonsense\"", "coarse_corrected"][..],
        ),
        (
            "-fetifeti_scaling",
            "nonsense",
            &["\"nonsense\"", "stiffness"],
        ),
        (
            "-fetifeti_projector",
            "nonsense",
            &["\"nonsense\"", "preconditioner"],
        ),
        (
            "-fetifeti_distribution",
            "nonsense",
            &["\"nonsense\"", "cyclic"],
        ),
        ("-fetifeti_scaling_gamma", "0.1", &["0.1", "at least 0.5"]),
        ("-fetifeti_scaling_gamma", "nan", &["finite"]),
        ("-fetifeti_threads", "-3", &["-3"]),
        ("-fetifeti_check", "maybe", &["maybe", "true or false"]),
        ("-fetifeti_ksp_rtol", "abc", &["-fetifeti_", "abc"]),
        ("-fetifeti_ksp_max_it", "abc", &["-fetifeti_", "abc"]),
        (
            "-fetifeti_ksp_type",
            "nonsense",
            &["-fetifeti_", "nonsense"],
        ),
        (
            "-fetifeti_coarse_pc_type",
            "nonsense",
            &["-fetifeti_coarse_", "nonsense"],
        ),
    ] {
        let out = fetifeti(&["solve", EXAMPLE, "--quiet", option, value]);
        refused(&out, 2, parts);
        assert_eq!(out.stderr.lines().count(), 1, "{}", out.all());
    }
    // From the scene as well as from the command line.
    let text = format!("[options]\nfetifeti_pc_type = \"nonsense\"\n{GRID}");
    bad_scene(&text, &["-fetifeti_pc_type", "nonsense"]);
}

#[test]
fn command_lines() {
    for (args, part) in [
        (&["frobnicate"][..], "frobnicate"),
        (&["solve"], "no scene"),
        (&["solve", EXAMPLE, EXAMPLE], "not expected"),
        (&["solve", EXAMPLE, "--jsn", "x"], "did you mean --json?"),
        (&["slove", EXAMPLE], "did you mean solve?"),
        (
            &["compare", EXAMPLE, "--with", "bdcc"],
            "did you mean bddc?",
        ),
        (&["solve", EXAMPLE, "--json", "-ksp_view"], "--json"),
        (&["solve", EXAMPLE, "--json"], "--json"),
        (&["table1", "--rows", "2,4"], "2,4"),
        (&["table1", "--rows", "1,2,2"], "1,2,2"),
    ] {
        let out = fetifeti(args);
        refused(&out, 2, &[part]);
        assert_eq!(out.stderr.lines().count(), 1, "{}", out.all());
    }
}

#[test]
fn the_program_explains_itself() {
    let commands = [
        "solve",
        "plan",
        "compare",
        "bench",
        "table1",
        "study",
        "completions",
        "man",
    ];
    let all = fetifeti(&["--help"]);
    assert_eq!((all.code, all.stderr.as_str()), (0, ""), "{}", all.all());
    let scratch = Scratch::new("pages");
    let dir = scratch.path("man1");
    let written = fetifeti(&["man", "--out", &dir]);
    assert_eq!(written.code, 0, "{}", written.all());
    assert_eq!(scratch.files().len(), 1 + commands.len());
    let script = fetifeti(&["completions", "bash"]).stdout;
    for name in commands {
        let own = fetifeti(&[name, "--help"]);
        assert_eq!(own.code, 0, "{}", own.all());
        assert!(own.stdout.contains(&format!("Usage: fetifeti {name}")));
        assert!(all.stdout.contains(&format!("  {name} ")));
        assert!(script.contains(name), "{script}");
        let page = std::fs::read_to_string(format!("{dir}/fetifeti-{name}.1")).expect(name);
        assert!(
            page.starts_with(".ie") && page.contains(".SH SYNOPSIS"),
            "{page}"
        );
    }
    // Commands by which processes of the program call each other are hidden from users.
    for text in [&all.stdout, &script] {
        assert!(
            !text.contains("baseline") && !text.contains("measure"),
            "{text}"
        );
    }
    let version = concat!("fetifeti ", env!("CARGO_PKG_VERSION"), "\n");
    assert_eq!(fetifeti(&["--version"]).stdout, version);
    // PETSc's list begins with the program's own help.
    let options = fetifeti(&["-help"]);
    assert_eq!(options.code, 0, "{}", options.all());
    for part in ["Usage: fetifeti", "-fetifeti_pc_type", "-fetifeti_ksp_rtol"] {
        assert!(options.stdout.contains(part), "{part}: {}", options.stdout);
    }
}

#[test]
fn bad_input_on_two_ranks_is_said_once() {
    let scratch = Scratch::new("ranks");
    let bad = [
        // ρ is bad in the last subdomain only, which the second rank holds.
        (
            grid("rho = \"if(x > 0.8 && y > 0.8, sqrt(0 - 1), 1)\""),
            "ρ = NaN at (0.8125, 0.8125)",
        ),
        (grid("rhoo = 2"), "unknown key `rhoo`"),
        (two("3", 2, ""), "body \"loose\" is held by nothing"),
        // The first rank does not own the loose body.
        (two("3", 1, ""), "body \"loose\" is held by nothing"),
    ];
    for (text, part) in bad {
        let scene = scratch.file("s.toml", &text);
        let out = run_fetifeti(2, &["solve", &scene, "--out", &scratch.path("out")]);
        refused(&out, 2, &[part]);
        assert_eq!(scratch.files(), [scene]);
    }
    refused(
        &run_fetifeti(2, &["solve", EXAMPLE, "--quiet", "--json", "/dev/full"]),
        3,
        &["cannot write"],
    );
    refused(
        &run_fetifeti(2, &["solve", EXAMPLE, "-fetifeti_ksp_rtol", "abc"]),
        2,
        &["abc"],
    );
}
