//! `fetifeti solve` as programs and people use it: report, files, exit codes, options.

use crate::support::checks::number;
use crate::support::sample::sample;
use crate::support::{mpi, program};
use mpi::{Output, Scratch};
use program::fetifeti;
use serde_json::Value;

const EXAMPLE: &str = "../../examples/scenes/poisson_2x2.toml";

/// `solve` with the report on standard output.
fn solve(scene: &str, more: &[&str]) -> (Output, Value) {
    let out = fetifeti(&[&["solve", scene, "--json", "-"], more].concat());
    let report = serde_json::from_str(&out.stdout).unwrap_or_else(|e| panic!("{e}: {}", out.all()));
    (out, report)
}

#[test]
fn the_report_has_every_key_of_the_contract() {
    let (out, r) = solve(
        "../../examples/scenes/exact_sine.toml",
        &["-fetifeti_spectrum", "-fetifeti_check"],
    );
    assert_eq!(out.code, 0, "{}", out.all());
    assert_eq!(out.stderr, "", "{}", out.all());
    for (key, value) in [
        ("ranks", 1),
        ("bodies", 4),
        ("floating_bodies", 0),
        ("subdomains", 16),
        ("outer_iterations", 1),
    ] {
        assert_eq!(r[key], value, "{key}");
    }
    // The mesh has (2 · 2 · 8 + 1)² nodes; those between bodies count twice, those on the boundary are held.
    assert_eq!(r["dofs"], 4 * 16 * 16);
    // Between two bodies 15 nodes, four times, and the cross point; inside a body 2 lines of 2 halves of 7 nodes.
    assert_eq!(r["multipliers"]["global"], 4 * 15 + 6);
    assert_eq!(r["multipliers"]["active"], r["multipliers"]["global"]);
    assert_eq!(r["multipliers"]["local"], 4 * 4 * 7);
    assert_eq!(
        r["iterations"]["inner"].as_array().expect("a list").len(),
        1
    );
    assert_eq!(r["iterations"]["inner"][0], r["iterations"]["total"]);
    assert!(r["scene"].is_string() && r["converged_reason"] == "CONVERGED_RTOL");
    for kind in ["exact", "estimate"] {
        let s = &r["condition"][kind];
        let (low, high, kappa) = (
            number(&s["lambda_min"]),
            number(&s["lambda_max"]),
            number(&s["kappa"]),
        );
        assert!(
            low >= 1.0 - 1e-8 && (high / low / kappa - 1.0).abs() < 1e-12,
            "{s}"
        );
    }
    assert!(number(&r["kkt"]["stationarity"]) < 1e-6 && number(&r["kkt"]["feasibility"]) < 1e-6);
    assert_eq!(number(&r["kkt"]["complementarity"]), 0.0);
    assert!(r["kkt"]
        .as_object()
        .expect("an object")
        .contains_key("min_multiplier"));
    // −½ ∫ |∇u|² = −π²/4 up to the energy of the error.
    let energy = std::f64::consts::PI.powi(2) / -4.0;
    let error = number(&r["error"]["energy"]);
    assert!(
        (number(&r["energy"]) - energy - 0.5 * error * error).abs() < 1e-5,
        "{}",
        r["energy"]
    );
    assert!(number(&r["error"]["l2"]) < 1e-3 && number(&r["error"]["h1"]) == error);
    let phases = ["assemble", "setup", "solve", "recover"].map(|p| number(&r["seconds"][p]));
    let total = number(&r["seconds"]["total"]);
    assert!(phases.iter().all(|s| *s > 0.0), "{phases:?}");
    let sum: f64 = phases.iter().sum();
    assert!(sum <= total * (1.0 + 1e-9), "{phases:?} in {total}");
    assert!(total <= out.seconds, "{total} of {}", out.seconds);
    assert!(
        (1.0..2000.0).contains(&number(&r["memory_mb"])),
        "{}",
        r["memory_mb"]
    );
    // Without an exact solution there is no error.
    assert!(solve(EXAMPLE, &[]).1.get("error").is_none());
    assert!(solve(EXAMPLE, &[]).1["condition"]["exact"].is_null());
}

#[test]
fn a_run_that_stops_early_writes_what_it_has() {
    let scratch = Scratch::new("early");
    let (dir, json) = (scratch.path("out"), scratch.path("r.json"));
    let out = fetifeti(&[
        "solve",
        EXAMPLE,
        "--out",
        &dir,
        "--json",
        &json,
        "-fetifeti_ksp_max_it",
        "2",
    ]);
    assert_eq!(out.code, 1, "{}", out.all());
    assert_eq!(out.stderr.lines().count(), 1, "{}", out.all());
    assert!(
        out.stderr.starts_with("Error: ") && out.stderr.contains("did not converge"),
        "{}",
        out.all()
    );
    assert!(
        out.stderr.contains("2 iterations") && out.stderr.contains("partial"),
        "{}",
        out.all()
    );
    let report: Value =
        serde_json::from_str(&std::fs::read_to_string(&json).expect("the report")).expect("JSON");
    assert_eq!(report["converged_reason"], "DIVERGED_ITS");
    assert_eq!(report["iterations"]["total"], 2);
    assert_eq!(scratch.files().len(), 4, "{:?}", scratch.files());
}

#[test]
fn results_are_written_where_they_were_asked_for() {
    let scratch = Scratch::new("files");
    let dir = scratch.path("deep/er");
    let out = fetifeti(&[
        "solve",
        "../../examples/scenes/unequal_bodies.toml",
        "--out",
        &dir,
    ]);
    assert_eq!(out.code, 0, "{}", out.all());
    let vtu = std::fs::read(format!("{dir}/solution.vtu")).expect("the mesh");
    let vtu = String::from_utf8_lossy(&vtu);
    for part in [
        "UnstructuredGrid",
        "\"u\"",
        "\"rho\"",
        "\"body\"",
        "\"subdomain\"",
    ] {
        assert!(vtu.contains(part), "{part}");
    }
    let png = std::fs::read(format!("{dir}/solution.png")).expect("the picture");
    assert_eq!(&png[1..4], b"PNG");
    let report = std::fs::read_to_string(format!("{dir}/report.json")).expect("the report");
    let report: Value = serde_json::from_str(&report).expect("JSON");
    assert_eq!(report["bodies"], 3);
    // With --quiet the program prints nothing, and writes only the files that were asked for.
    let out = fetifeti(&["solve", EXAMPLE, "--quiet"]);
    assert_eq!(
        (out.code, out.stdout.as_str(), out.stderr.as_str()),
        (0, "", "")
    );
}

#[test]
fn identities_are_printed_and_vanish() {
    for scene in [
        "partly_tied",
        "jump_1e6",
        "one_body",
        "one_subdomain",
        "lee_column_2",
    ] {
        let path = format!("../../examples/scenes/{scene}.toml");
        let (out, report) = solve(&path, &["-fetifeti_check"]);
        assert_eq!(out.code, 0, "{}", out.all());
        let identities = report["check"].as_object().expect("identities");
        assert!(identities.len() >= 5, "{identities:?}");
        for (name, defect) in identities {
            assert!(number(defect) < 1e-10, "{scene}: {name} {defect}");
        }
        let printed = fetifeti(&["solve", &path, "-fetifeti_check"]).stdout;
        for name in identities.keys() {
            assert!(printed.contains(name.as_str()), "{name}: {printed}");
        }
    }
}

#[test]
fn options_come_from_the_scene_and_the_command_line_wins() {
    let scratch = Scratch::new("options");
    let text = std::fs::read_to_string(EXAMPLE).expect("the example");
    let options = "[options]\nfetifeti_pc_type = \"lumped\"\nfetifeti_ksp_type = \"gmres\"\nfetifeti_ksp_rtol = 1e-9\n";
    let scene = scratch.file("s.toml", &format!("{text}\n{options}"));
    let (_, report) = solve(&scene, &[]);
    assert_eq!(
        (&report["preconditioner"], &report["ksp_type"]),
        (&"lumped".into(), &"gmres".into())
    );
    assert_eq!(number(&report["rtol"]), 1e-9);
    let (_, report) = solve(&scene, &["-fetifeti_pc_type", "dirichlet"]);
    assert_eq!(
        (&report["preconditioner"], &report["ksp_type"]),
        (&"dirichlet".into(), &"gmres".into())
    );
    // The same from a file of options.
    let file = scratch.file("opts", "-fetifeti_ksp_type fcg\n-fetifeti_pc_type none\n");
    let (_, report) = solve(EXAMPLE, &["-options_file", &file]);
    assert_eq!(
        (&report["preconditioner"], &report["ksp_type"]),
        (&"none".into(), &"fcg".into())
    );
}

#[test]
fn typos_show_up_as_options_left() {
    let out = fetifeti(&[
        "solve",
        EXAMPLE,
        "-fetifeti_scaling_gama",
        "1",
        "-fetifeti_gtg_ksp_typ",
        "cg",
        "-options_left",
    ]);
    assert_eq!(out.code, 0, "{}", out.all());
    for typo in ["-fetifeti_scaling_gama", "-fetifeti_gtg_ksp_typ"] {
        let left = out
            .stdout
            .lines()
            .chain(out.stderr.lines())
            .filter(|l| l.contains("left") && l.contains(typo));
        assert_eq!(left.count(), 1, "{}", out.all());
    }
    // Options that are used are not left.
    let used = [
        "-fetifeti_scaling",
        "rho",
        "-fetifeti_ksp_rtol",
        "1e-8",
        "-fetifeti_coarse_ksp_type",
        "preonly",
    ];
    let out = fetifeti(&[&["solve", EXAMPLE, "-options_left"], &used[..]].concat());
    assert!(
        out.stdout.contains("no unused") || !out.all().contains("Option left"),
        "{}",
        out.all()
    );
}

#[test]
fn solvers_are_seen_by_their_prefixes() {
    let scene = "../../examples/scenes/lee_column_1.toml";
    let options = [
        "-fetifeti_gtg_ksp_type",
        "cg",
        "-fetifeti_gtg_pc_type",
        "jacobi",
        "-fetifeti_gtg_ksp_rtol",
        "1e-14",
        "-fetifeti_coarse_ksp_type",
        "cg",
        "-fetifeti_coarse_pc_type",
        "jacobi",
        "-fetifeti_coarse_ksp_rtol",
        "1e-13",
        "-fetifeti_ksp_rtol",
        "1e-10",
    ];
    let (out, report) = solve(scene, &options);
    assert_eq!(out.code, 0, "{}", out.all());
    let (_, usual) = solve(scene, &["-fetifeti_ksp_rtol", "1e-10"]);
    assert!((number(&report["energy"]) / number(&usual["energy"]) - 1.0).abs() < 1e-10);
    let viewed = fetifeti(&[
        "solve",
        scene,
        "--quiet",
        "-fetifeti_ksp_view",
        "-fetifeti_ksp_monitor",
        "-fetifeti_gtg_ksp_view",
    ]);
    assert!(viewed.stdout.contains("(fetifeti_)"), "{}", viewed.all());
    assert!(
        viewed.stdout.contains("(fetifeti_gtg_)"),
        "{}",
        viewed.all()
    );
    assert!(
        viewed.stdout.contains("KSP Residual norm"),
        "{}",
        viewed.all()
    );
    let viewed = fetifeti(&["solve", scene, "--quiet", "-fetifeti_coarse_ksp_view"]);
    assert!(
        viewed.stdout.contains("(fetifeti_coarse_)"),
        "{}",
        viewed.all()
    );
}

#[test]
fn an_eigensolver_that_fails_is_said() {
    let scene = "../../examples/scenes/lee_column_1.toml";
    let options = ["-fetifeti_spectrum", "-fetifeti_eps_max_it", "1"];
    let out = fetifeti(&[&["solve", scene, "--quiet"], &options[..]].concat());
    assert_eq!(out.code, 1, "{}", out.all());
    let sentence = "smallest eigenvalue did not converge";
    assert!(out.stderr.contains(sentence), "{}", out.all());
}

#[test]
fn a_coarse_solver_that_fails_is_said() {
    let scene = "../../examples/scenes/lee_column_1.toml";
    let options = [
        "-fetifeti_coarse_ksp_type",
        "cg",
        "-fetifeti_coarse_pc_type",
        "jacobi",
        "-fetifeti_coarse_ksp_max_it",
        "1",
    ];
    let out = fetifeti(&[&["solve", scene, "--quiet"], &options[..]].concat());
    assert_eq!(out.code, 1, "{}", out.all());
    assert!(
        out.stderr.starts_with("Error: ") && out.stderr.contains("coarse"),
        "{}",
        out.all()
    );
    assert!(!out.stderr.contains("() at "), "{}", out.all());
}

#[test]
fn help_lists_our_options() {
    let out = fetifeti(&["-help"]);
    assert_eq!(out.code, 0, "{}", out.all());
    for option in [
        "-fetifeti_pc_type",
        "-fetifeti_scaling",
        "-fetifeti_projector",
        "-fetifeti_spectrum",
        "-fetifeti_ksp_rtol",
    ] {
        assert!(out.stdout.contains(option), "{option}");
    }
    for args in [&["--help"][..], &[]] {
        assert!(fetifeti(args).stdout.contains("fetifeti solve SCENE"));
    }
}

#[test]
fn a_million_unknowns_are_solved() {
    let (out, report) = solve("../../examples/scenes/speed_1024.toml", &[]);
    assert_eq!(out.code, 0, "{}", out.all());
    let [setup, solve, recover] =
        ["setup", "solve", "recover"].map(|p| number(&report["seconds"][p]));
    println!("set-up {setup:.2} s, solve {solve:.2} s, recover {recover:.2} s");
    assert!(number(&report["kkt"]["stationarity"]) < 1e-4);
}

#[test]
fn a_tolerance_below_rounding_is_not_reported_as_reached() {
    let methods = ["active_set", "augmented_lagrangian", "smalbe"];
    let contact = ["obstacle", "contact_grid_100", "model_contact"]
        .iter()
        .flat_map(|scene| methods.map(|method| (*scene, method)));
    let equations = [("model_tied", "active_set"), ("jump_1e6", "active_set")];
    for (scene, method) in sample(3, contact.chain(equations)) {
        let file = format!("../../examples/scenes/{scene}.toml");
        let run = |rtol: &str| {
            let more = ["-fetifeti_contact_type", method, "-fetifeti_ksp_rtol", rtol];
            let (out, report) = solve(&file, &more);
            assert_eq!(out.code, 0, "{scene} {method} {rtol}: {}", out.all());
            report
        };
        let usual = run("1e-10");
        let what = format!("{scene} {method}");
        assert_eq!(usual["converged_reason"], "CONVERGED_RTOL", "{what}");
        for rtol in ["1e-30", "0"] {
            let last = run(rtol);
            assert_eq!(last["converged_reason"], "CONVERGED_ROUNDING", "{what}");
            let more = number(&last["iterations"]["total"]);
            let few = number(&usual["iterations"]["total"]);
            assert!(more < 3.0 * few, "{what}: {more} after {few}");
            for key in ["stationarity", "feasibility"] {
                assert!(number(&last["kkt"][key]) < 1e-13, "{what}: {last}");
            }
            let energy = number(&last["energy"]) / number(&usual["energy"]);
            assert!((energy - 1.0).abs() < 1e-9, "{what}: {energy}");
        }
    }
}

#[test]
fn the_summary_says_what_was_reached_above_a_tolerance_below_rounding() {
    let out = fetifeti(&["solve", EXAMPLE, "-fetifeti_ksp_rtol", "1e-30"]);
    assert_eq!(out.code, 0, "{}", out.all());
    let mut lines = out.stdout.lines().filter(|l| l.starts_with("rounding"));
    let line = lines.next().expect("a line about rounding");
    assert!(line.contains("the tolerance 1.0e-30 is below it"), "{line}");
}

/// With inclusions the lower end of the spectrum is a cluster at 1 whose members Krylov methods cannot separate: the
/// residual of the smallest eigenvalue falls for more than a hundred restarts after its value is known.
#[test]
fn the_spectrum_of_inclusions_takes_few_restarts() {
    let scene = "../../examples/scenes/coefficients_inclusions.toml";
    let more = ["-fetifeti_spectrum", "-fetifeti_eps_max_it", "30"];
    let (out, report) = solve(scene, &more);
    assert_eq!(out.code, 0, "{}", out.all());
    let exact = &report["condition"]["exact"];
    // The bound of theory proves the value; otherwise the record would say that it has settled.
    assert!(exact.get("settled").is_none(), "{exact}");
    let least = number(&exact["lambda_min"]);
    assert!((least - 1.0).abs() < 5e-7, "{exact}");
    // κ of the search to a residual of 4e-7.
    assert!((number(&exact["kappa"]) - 9.7545).abs() < 1e-4, "{exact}");
}
