//! What reports say of themselves, and what does not get between their lines.

use serde_json::Value;

use crate::support::mpi::Scratch;
use crate::support::program::{fetifeti, run_fetifeti};

const SCENE: &str = "../../examples/scenes/model_contact.toml";

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|e| panic!("{e}: {text}"))
}

#[test]
fn a_misspelt_option_is_a_warning_on_standard_error() {
    let misspelt = ["solve", SCENE, "-fetifeti_ksp_rtoll", "1e-9", "--json", "-"];
    for ranks in [1, 2] {
        let out = match ranks {
            1 => fetifeti(&misspelt),
            n => run_fetifeti(n, &misspelt),
        };
        assert_eq!(out.code, 0, "{}", out.all());
        let report = json(&out.stdout);
        // That of the scene.
        assert_eq!(report["rtol"], 1e-10, "{report}");
        let warned = "Warning: nobody has asked for -fetifeti_ksp_rtoll (did you mean -fetifeti_ksp_rtol?): misspelt";
        assert_eq!(out.stderr.matches(warned).count(), 1, "{}", out.all());
    }
    // PETSc's own list takes the place of the warning.
    let out = fetifeti(&[
        "solve",
        SCENE,
        "-options_left",
        "-fetifeti_tolerance",
        "1e-9",
    ]);
    assert_eq!((out.code, out.stderr.as_str()), (0, ""), "{}", out.all());
    assert!(out.stdout.contains("-fetifeti_tolerance"), "{}", out.all());
}

/// What every command says of options: those that nobody knows with the nearest name, none of those that it knows.
#[test]
fn every_command_warns_of_misspelt_options() {
    let small = "../../examples/scenes/poisson_2x2.toml";
    let warned = |args: &[&str], expected: &[&str]| {
        let out = fetifeti(args);
        assert_eq!(out.code, 0, "{args:?}: {}", out.all());
        let line = out
            .stderr
            .lines()
            .find(|l| l.starts_with("Warning: nobody"));
        for name in expected {
            let line = line.unwrap_or_else(|| panic!("{args:?}: {}", out.all()));
            assert!(line.contains(name), "{args:?}: no {name} in {line}");
        }
        let names = line.map_or(0, |l| l.matches('-').count());
        let expected = expected.join(" ").matches('-').count();
        // One of the last words of the sentence.
        let own = usize::from(line.is_some());
        assert_eq!(names, expected + own, "{args:?}: {}", out.all());
    };
    let right = [
        "-fetifeti_ksp_rtol",
        "1e-7",
        "-fetifeti_contact_max_it",
        "9",
        "-fetifeti_coarse_pc_factor_mat_solver_type",
        "mumps",
        "-fetifeti_coarse_mat_mumps_icntl_14",
        "30",
        "-fetifeti_ksp_converged_reason",
        "-log_view",
        ":/dev/null",
    ];
    warned(&[&["plan", small][..], &right].concat(), &[]);
    let meant = "-fetifeti_ksp_rtl (did you mean -fetifeti_ksp_rtol?)";
    let wrong = ["-fetifeti_ksp_rtl", "1", "-ksp_rtol", "1"];
    let both = [meant, "-ksp_rtol (did you mean -fetifeti_ksp_rtol?)"];
    warned(&[&["plan", small][..], &wrong].concat(), &both);
    warned(&[&["solve", small, "--quiet"][..], &wrong].concat(), &both);
    warned(
        &[&["table1", "--rows", "2,1,2", "--quiet"][..], &wrong].concat(),
        &both,
    );
    let jobs = [
        "compare",
        small,
        "--with",
        "mumps",
        "--quiet",
        "-fetifeti_ksp_type",
        "pipecg",
        "-mumps_mat_mumps_icntl_14",
        "30",
        "-fetifeti_ksp_rtl",
        "1",
        "-compare_maxranks",
        "9",
    ];
    warned(
        &jobs,
        &[
            "-compare_maxranks (did you mean -compare_max_ranks?)",
            meant,
        ],
    );
    warned(&["bench", "--list", "-x"], &["-x"]);
}

#[test]
fn monitors_do_not_mix_into_a_report_on_standard_output() {
    let monitored = [
        "-fetifeti_ksp_monitor",
        "-fetifeti_ksp_view",
        "-options_left",
    ];
    for verb in ["solve", "plan"] {
        let out = fetifeti(&[&[verb, SCENE, "--json", "-"], &monitored[..]].concat());
        assert_eq!(out.code, 0, "{}", out.all());
        json(&out.stdout);
        let monitors = out.stderr.matches("KSP Residual norm").count();
        assert_eq!(monitors > 0, verb == "solve", "{}", out.all());
    }
    let out = fetifeti(&[&["solve", SCENE], &monitored[..1]].concat());
    assert!(out.stdout.contains("KSP Residual norm"), "{}", out.all());
}

#[test]
fn a_report_names_schema_version_options_and_convergence() {
    let options = ["-fetifeti_ksp_rtol", "1e-9", "-fetifeti_check"];
    let out = fetifeti(&[&["solve", SCENE, "--json", "-"], &options[..]].concat());
    let report = json(&out.stdout);
    assert_eq!(report["schema"], "fetifeti.solve/1", "{report}");
    assert_eq!(report["version"], env!("CARGO_PKG_VERSION"), "{report}");
    assert_eq!(report["converged"], true, "{report}");
    let set = serde_json::json!({ "-fetifeti_ksp_rtol": "1e-9", "-fetifeti_check": "" });
    assert_eq!(report["options"], set, "{report}");
    // What it takes to run it again.
    assert_eq!(report["ranks"], 1, "{report}");
    assert!(report["threads"].as_u64() >= Some(1), "{report}");
    assert!(
        report["petsc"]
            .as_str()
            .is_some_and(|v| v.starts_with("3.")),
        "{report}"
    );
    assert_eq!(
        (&report["command"][1], &report["command"][2]),
        (&"solve".into(), &SCENE.into())
    );
    let inputs = report["inputs"].as_array().expect("a list");
    assert_eq!(
        (inputs.len(), &inputs[0]["file"]),
        (1, &SCENE.into()),
        "{report}"
    );
    let hash = inputs[0]["sha256"].as_str().expect("a hash");
    assert_eq!(hash.len(), 64, "{report}");
    let out = fetifeti(&[
        "solve",
        SCENE,
        "--json",
        "-",
        "-fetifeti_contact_max_it",
        "1",
    ]);
    assert_eq!(out.code, 1, "{}", out.all());
    assert_eq!(json(&out.stdout)["converged"], false, "{}", out.stdout);
}

#[test]
fn a_plan_is_a_report_too() {
    let scratch = Scratch::new("plan-json");
    let file = scratch.path("plan.json");
    let out = fetifeti(&["plan", SCENE, "--json", &file]);
    assert_eq!((out.code, out.stderr.as_str()), (0, ""), "{}", out.all());
    assert!(out.stdout.contains("for a solve"), "{}", out.stdout);
    let plan = json(&std::fs::read_to_string(&file).expect("the plan"));
    assert_eq!(plan["schema"], "fetifeti.plan/1", "{plan}");
    assert_eq!(plan["bodies"].as_array().map(Vec::len), Some(2), "{plan}");
    assert_eq!(plan["inequalities"], 33, "{plan}");
    assert_eq!(plan["bodies"][1]["floating"], 1, "{plan}");
    let memory = &plan["memory"];
    assert!(memory["solve_mb"].as_f64() > Some(50.0), "{plan}");
    assert!(
        memory["available_mb"].as_f64() > memory["solve_mb"].as_f64(),
        "{plan}"
    );
}
