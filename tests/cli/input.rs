//! The program's answers to bad input: one sentence, the right exit code, no file. Also unusual, but valid scenes.

use crate::support::checks::identities;
use crate::support::session::with_session;
use crate::support::{direct, mpi, program};
use direct::{tight, Direct};
use fetifeti::scene::Scene;
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

const GRID: &str =
    "[grid]\nbodies = 2\nelements = 4\nsubdomains = 2\nload = 1\ndirichlet = \"all\"\n";
const EXAMPLE: &str = "examples/scenes/poisson_2x2.toml";

fn grid(line: &str) -> String {
    format!("{GRID}{line}\n")
}

/// A held body and another one at `x`, each of `subdomains`² subdomains.
fn two(x: &str, subdomains: usize, more: &str) -> String {
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
fn a_balanced_load_on_loose_bodies_is_solved() {
    for subdomains in [1, 2] {
        let text = format!(
            "[grid]\nbodies = [2, 1]\nelements = [4, 8]\nsubdomains = {subdomains}\nload = \"if(x < 0.5, 1, -1)\"\n"
        );
        let scratch = Scratch::new("balanced");
        let scene = scratch.file("s.toml", &text);
        let out = fetifeti(&[
            "solve",
            &scene,
            "--json",
            "-",
            "-fetifeti_ksp_rtol",
            "1e-10",
        ]);
        assert_eq!(out.code, 0, "{}", out.all());
        let report: serde_json::Value = serde_json::from_str(&out.stdout).expect("JSON");
        assert_eq!(report["floating_bodies"], 2);
        // u depends on x alone, linear elements are nodally exact in one dimension: −½ ∫ u'², u' = min(x, 1 − x) up to
        // sign, and the energy lost to interpolation, h²/24 of ∫ f².
        let (h, energy) = (1.0f64 / 8.0, report["energy"].as_f64().expect("a number"));
        let exact = -0.5 * (1.0 / 12.0) + h * h / 24.0;
        assert!((energy - exact).abs() < 1e-10, "{energy} {exact}");
    }
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

/// The solution of the scene agrees with the direct solution.
fn solves(name: &'static str, text: impl Into<String>, multipliers: usize) {
    let text = text.into();
    with_session(move |session| {
        let direct = Direct::new(Scene::parse("s.toml", &text).expect(name));
        let solver = direct.solver(session, &tight());
        let facts = solver.facts();
        assert_eq!(
            facts.multipliers_local + facts.multipliers_active,
            multipliers,
            "{name}"
        );
        identities(&solver, 1e-10, name);
        let spectrum = solver.spectrum().expect("eigenvalues");
        assert_eq!(spectrum.is_some(), multipliers > 0, "{name}");
        assert!(
            spectrum.is_none_or(|s| s.lambda_min > 1.0 - 1e-8),
            "{name}: {spectrum:?}"
        );
        let solution = solver.solve().expect(name);
        assert!(solution.converged(), "{name}: {}", solution.status);
        let distance = direct.distance(&solution.u);
        println!("{name}: {} iterations, {distance:.1e}", solution.iterations);
        assert!(distance < 1e-10, "{name}: {distance:.1e}");
    });
}

#[test]
fn a_single_subdomain_needs_no_iteration() {
    solves(
        "plain",
        "[[body]]\nsize = 1\nelements = 8\nload = \"1 + x\"\ndirichlet = [\"left\"]\n",
        0,
    );
    // Two of them, apart.
    solves("two apart", two("3", 1, "dirichlet = [\"right\"]\n"), 0);
}

#[test]
fn a_body_without_free_nodes() {
    // 3 × 3 bodies of one element, the outer ones held: the middle one has four free corners, the corner bodies one.
    let ring = "[grid]\nbodies = 3\nelements = 1\nload = 1\ndirichlet = \"all\"\n";
    solves("3x3", ring, 4 * 6);
    // All nodes of `stamp` are prescribed, and so are the nodes of its right neighbour that are tied to it.
    let text = "[[body]]\nname = \"stamp\"\nsize = 1\nelements = 1\ndirichlet = { left = \"y\", right = 2 }\n\
                [[body]]\nname = \"right\"\norigin = [1, 0]\nsize = 1\nelements = [2, 1]\nload = 1\n\
                [[body]]\nname = \"lid\"\norigin = [0, 1]\nsize = [2, 1]\n\
                elements = [4, 2]\nsubdomains = 2\nload = -1\n\
                [[tie]]\nbodies = [\"stamp\", \"lid\"]\nwhere = \"none\"\n";
    let scene = Scene::parse("s.toml", text).expect("valid");
    assert_eq!(scene.subdomain(0).expect("assembled").k.n(), 0);
    with_session(move |session| {
        let direct = Direct::new(scene);
        let (solution, distance) = direct.run(session, &tight());
        assert!(solution.converged() && distance < 1e-10, "{distance:.1e}");
    });
}

#[test]
fn subdomains_of_one_element() {
    // Every node is a vertex: there are no multipliers inside bodies.
    let text = "[grid]\nbodies = 2\nelements = 2\nsubdomains = 2\nload = 1\ndirichlet = \"all\"\n";
    solves("2,2,1", text, 6 + 4);
    let text =
        "[grid]\nbodies = 3\nelements = 3\nsubdomains = 3\nload = \"x\"\ndirichlet = \"all\"\n";
    solves("3,3,1", text, 4 * 6 + 4 * 6);
}

#[test]
fn bodies_in_a_row() {
    // One end is held: all other bodies float, and the multipliers form a chain.
    let text = "[grid]\nbodies = [6, 1]\nsize = [6, 1]\nelements = 4\n\
                subdomains = 2\nload = 1\ndirichlet = [\"left\"]\n";
    // Inside each body, each half of two lines has one dual node; there are 5 faces of 5 nodes between bodies.
    let multipliers = 6 * 4 + 5 * 5;
    solves("row", text, multipliers);
    solves(
        "column",
        text.replace("[6, 1]", "[1, 6]").replace("left", "bottom"),
        multipliers,
    );
}

#[test]
fn no_load_at_all() {
    for dirichlet in ["\"all\"", "[\"left\"]"] {
        let scratch = Scratch::new("zero");
        let text = GRID.replace("load = 1\n", "").replace("\"all\"", dirichlet);
        let scene = scratch.file("s.toml", &text);
        let out = fetifeti(&[
            "solve",
            &scene,
            "--json",
            "-",
            "--out",
            &scratch.path("out"),
            "-fetifeti_spectrum",
        ]);
        assert_eq!(out.code, 0, "{}", out.all());
        let report: serde_json::Value = serde_json::from_str(&out.stdout).expect("JSON");
        assert_eq!(report["iterations"]["total"], 0);
        assert_eq!(report["energy"], 0.0);
        assert_eq!(report["kkt"]["stationarity"], 0.0);
        assert!(
            report["condition"]["exact"]["kappa"]
                .as_f64()
                .expect("a number")
                > 1.0
        );
        assert_eq!(scratch.files().len(), 4, "{:?}", scratch.files());
    }
}
