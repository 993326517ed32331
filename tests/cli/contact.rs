//! `fetifeti solve` and `plan` on scenes with contact: report, files, options, exit codes.

use crate::support::checks::number;
use crate::support::{mpi, program};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use mpi::{Output, Scratch};
use program::{fetifeti, run_fetifeti};
use serde_json::Value;

const MODEL: &str = "../../examples/scenes/model_contact.toml";
const PRESS: &str = "../../examples/scenes/press_ramp.toml";

fn list(v: &Value) -> &[Value] {
    v.as_array().unwrap_or_else(|| panic!("{v} is no list"))
}

fn text(path: &str) -> String {
    fs::read_to_string(path).unwrap_or_else(|e| panic!("{path}: {e}"))
}

fn report(path: &str) -> Value {
    serde_json::from_str(&text(path)).unwrap_or_else(|e| panic!("{path}: {e}"))
}

/// A column of a table with the names of its columns on the first line.
fn column(csv: &str, name: &str) -> Vec<f64> {
    let mut lines = csv.lines();
    let mut names = lines.next().expect("a head").split(',');
    let k = names
        .position(|n| n == name)
        .unwrap_or_else(|| panic!("no column {name} in {csv}"));
    let value = |line: &str| line.split(',').nth(k).expect("a field").parse();
    lines.map(|l| value(l).expect("a number")).collect()
}

fn names(dir: &str) -> BTreeSet<String> {
    let entries = fs::read_dir(dir).unwrap_or_else(|e| panic!("{dir}: {e}"));
    let name = |e: std::io::Result<fs::DirEntry>| e.expect("an entry").file_name();
    entries
        .map(|e| name(e).into_string().expect("UTF-8"))
        .collect()
}

/// The files of a contact solve without load steps.
const FILES: [&str; 6] = [
    "interfaces.csv",
    "interfaces.png",
    "interfaces.svg",
    "report.json",
    "solution.png",
    "solution.vtu",
];

fn has_files(dir: &str) {
    assert_eq!(
        names(dir),
        FILES.iter().map(|f| f.to_string()).collect(),
        "{dir}"
    );
    for file in FILES {
        let path = Path::new(dir).join(file);
        assert!(fs::metadata(&path).expect("the file").len() > 0, "{file}");
    }
}

#[test]
fn the_model_problem_writes_its_files_on_one_and_two_ranks() {
    for ranks in [1, 2] {
        let scratch = Scratch::new(&format!("contact-{ranks}"));
        let (dir, json) = (scratch.path("out"), scratch.path("r.json"));
        let out = run_fetifeti(ranks, &["solve", MODEL, "--out", &dir, "--json", &json]);
        assert_eq!(out.code, 0, "{}", out.all());
        has_files(&dir);
        assert_eq!(report(&json), report(&format!("{dir}/report.json")));
        keys(&report(&json), ranks);
        let vtu = fs::read(format!("{dir}/solution.vtu")).expect("the mesh");
        let vtu = String::from_utf8_lossy(&vtu);
        let points = vtu.split("</PointData>").next().expect("point data");
        for field in ["u", "multiplier", "gap", "contact", "candidate"] {
            assert!(points.contains(&format!("Name=\"{field}\"")), "{field}");
        }
        for (file, start) in [
            ("solution.png", &b"\x89PNG"[..]),
            ("interfaces.png", b"\x89PNG"),
        ] {
            let bytes = fs::read(format!("{dir}/{file}")).expect("the picture");
            assert!(bytes.starts_with(start), "{file}");
        }
        assert!(text(&format!("{dir}/interfaces.svg")).contains("<svg"));
        let csv = text(&format!("{dir}/interfaces.csv"));
        let (multipliers, gaps) = (column(&csv, "multiplier"), column(&csv, "gap"));
        assert_eq!((multipliers.len(), gaps.len()), (33, 33));
        for (m, g) in multipliers.iter().zip(&gaps) {
            assert!(*m >= 0.0 && *g >= -1e-8 && (m * g).abs() < 1e-10, "{m} {g}");
        }
        // The right body floats: the contact carries its load, 1 over a quarter of its area.
        assert!((multipliers.iter().sum::<f64>() - 0.25).abs() < 1e-10);
        let touching = column(&csv, "active").iter().filter(|a| **a == 1.0).count();
        assert_eq!(report(&json)["multipliers"]["active"], touching);
        outer_table(&out, &report(&json));
    }
}

fn keys(r: &Value, ranks: usize) {
    assert_eq!((&r["ranks"], &r["bodies"]), (&ranks.into(), &2.into()));
    let steps = list(&r["contact"]["steps"]);
    let inner = list(&r["iterations"]["inner"]);
    assert_eq!(r["outer_iterations"], steps.len());
    assert!(steps.len() > 1 && inner.len() == steps.len());
    let total: u64 = inner.iter().map(|n| n.as_u64().expect("a count")).sum();
    assert_eq!(r["iterations"]["total"], total);
    assert!(steps.iter().zip(inner).all(|(s, n)| s["iterations"] == *n));
    assert_eq!(r["multipliers"]["active"], r["contact"]["active"]);
    assert_eq!(r["contact"]["candidates"], 33);
    for key in ["stationarity", "feasibility", "complementarity"] {
        assert!(number(&r["kkt"][key]) < 1e-8, "{key}: {}", r["kkt"][key]);
    }
    assert!(number(&r["kkt"]["min_multiplier"]) >= 0.0);
    let interfaces = list(&r["contact"]["interfaces"]);
    assert_eq!(interfaces.len(), 1);
    assert_eq!(interfaces[0]["name"], "left|right");
    assert!((number(&interfaces[0]["force"]) - 0.25).abs() < 1e-10);
    let bodies = list(&r["contact"]["bodies"]);
    assert_eq!(bodies.len(), 2);
    assert!(bodies.iter().all(|b| number(&b["imbalance"]) < 1e-8));
}

/// The summary has one line for each outer step, with the active inequalities of the report.
fn outer_table(out: &Output, r: &Value) {
    let mut lines = out.stdout.lines();
    let head = lines.find(|l| {
        let mut words = l.split_whitespace();
        words.next() == Some("step") && words.next() == Some("active")
    });
    assert!(head.is_some(), "{}", out.stdout);
    let rows: Vec<&str> = lines.skip(1).take_while(|l| !l.is_empty()).collect();
    let steps = list(&r["contact"]["steps"]);
    assert_eq!(rows.len(), steps.len(), "{}", out.stdout);
    for (row, step) in rows.iter().zip(steps) {
        let words: Vec<&str> = row.split_whitespace().take(2).collect();
        assert_eq!(
            words,
            [step["step"].to_string(), step["active"].to_string()]
        );
    }
}

#[test]
fn load_steps_are_a_time_series() {
    let scratch = Scratch::new("press");
    let dir = scratch.path("out");
    let out = fetifeti(&["solve", PRESS, "--out", &dir, "--quiet"]);
    assert_eq!((out.code, out.stdout.as_str()), (0, ""), "{}", out.all());
    let pvd = text(&format!("{dir}/solution.pvd"));
    let files: BTreeSet<&str> = pvd
        .split("file=\"")
        .skip(1)
        .map(|rest| rest.split('"').next().expect("a name"))
        .collect();
    assert_eq!(files.len(), 10, "{pvd}");
    for file in files {
        assert!(Path::new(&dir).join(file).is_file(), "{file}");
    }
    let csv = text(&format!("{dir}/steps.csv"));
    let force = column(&csv, "contact_force");
    assert_eq!(force.len(), 10, "{csv}");
    // At first the block only lies there, with its load of 0.1; from t = 0.5 on the punch presses.
    for (k, f) in force.windows(2).enumerate() {
        let least = if k < 3 { -1e-8 } else { 0.02 };
        assert!(f[1] - f[0] > least, "{csv}");
    }
    assert!((force[0] - 0.1).abs() < 1e-8, "{csv}");
    let r = report(&format!("{dir}/report.json"));
    let contact = &r["contact"];
    assert_eq!(contact["factorisations"], contact["distinct_subdomains"]);
    assert!(number(&contact["factorisations"]) > 0.0);
    assert_eq!(list(&contact["load_steps"]).len(), 10);
}

#[test]
fn both_methods_give_the_same_energy() {
    let scratch = Scratch::new("methods");
    let energies = ["active_set", "augmented_lagrangian", "smalbe"].map(|method| {
        let json = scratch.path(method);
        let options = ["--json", &json, "--quiet", "-fetifeti_contact_type", method];
        let out = fetifeti(&[&["solve", MODEL], &options[..]].concat());
        assert_eq!((out.code, out.stdout.as_str()), (0, ""), "{}", out.all());
        let r = report(&json);
        // After SMALBE, steps of the active set compute the last digits.
        let steps = list(&r["contact"]["steps"]);
        assert_eq!(steps[0]["method"], method, "{}", r["contact"]["method"]);
        number(&r["energy"])
    });
    assert!(
        (energies[0] / energies[1] - 1.0).abs() < 1e-7,
        "{energies:?}"
    );
}

#[test]
fn a_loop_that_stops_early_writes_what_it_has() {
    let scratch = Scratch::new("contact-early");
    let dir = scratch.path("out");
    let out = fetifeti(&[
        "solve",
        MODEL,
        "--quiet",
        "--out",
        &dir,
        "-fetifeti_contact_max_it",
        "1",
    ]);
    assert_eq!(out.code, 1, "{}", out.all());
    for part in [
        "the contact problem of",
        "model_contact.toml",
        "did not converge",
    ] {
        assert!(out.stderr.contains(part), "{part}: {}", out.all());
    }
    has_files(&dir);
    let r = report(&format!("{dir}/report.json"));
    assert_eq!(r["outer_iterations"], 1);
    assert_eq!(r["converged_reason"], "DIVERGED_CONTACT_ITS");
}

#[test]
fn options_that_make_no_sense_are_refused() {
    for (option, value, expected) in [
        (
            "-fetifeti_contact_type",
            "foo",
            "one of active_set, augmented_lagrangian, smalbe",
        ),
        (
            "-fetifeti_contact_inner_rtol",
            "2",
            "a number between 0 and 1",
        ),
    ] {
        let out = fetifeti(&["solve", MODEL, "--quiet", option, value]);
        assert_eq!((out.code, out.stdout.as_str()), (2, ""), "{}", out.all());
        assert_eq!(out.stderr.lines().count(), 1, "{}", out.all());
        for part in [option, value, "expected", expected] {
            assert!(out.stderr.contains(part), "{part}: {}", out.all());
        }
    }
    let help = fetifeti(&["-help"]).stdout;
    for option in ["type", "max_it", "inner_rtol", "face_pc"] {
        let option = format!("-fetifeti_contact_{option}:");
        assert!(help.contains(&option), "{option}: {help}");
    }
}

/// Exit code 2, one sentence with these parts, and no file.
fn refused(name: &str, scene: &str, parts: &[&str]) {
    for ranks in [1, 2] {
        let scratch = Scratch::new(&format!("{name}-{ranks}"));
        let scene = scratch.file("s.toml", scene);
        let (dir, json) = (scratch.path("out"), scratch.path("r.json"));
        let out = run_fetifeti(ranks, &["solve", &scene, "--out", &dir, "--json", &json]);
        assert_eq!(out.code, 2, "{}", out.all());
        let said: Vec<&str> = out
            .stderr
            .lines()
            .filter(|l| l.starts_with("Error: "))
            .collect();
        assert_eq!(said.len(), 1, "{}", out.all());
        for part in parts {
            assert!(said[0].contains(part), "{part}: {}", out.all());
        }
        let left = scratch.files();
        assert!(left.len() == 1 && left[0] == scene, "{left:?}");
    }
}

#[test]
fn a_body_that_is_pushed_away_is_named() {
    let model = text(MODEL);
    let away = model.replace("value = -1 }", "value = 1 }");
    assert_ne!(away, model);
    refused("away", &away, &["\"right\"", "pushed away", "expected"]);
}

#[test]
fn a_contradiction_along_a_chain_is_named() {
    // At (1, 0): a >= 1, b >= a, b <= -1. Any two of these are compatible, all three are not.
    let body = |name: &str, x: usize, more: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\norigin = [{x}, 0]\nsize = [1, 1]\nelements = 4\nload = -1\n{more}\n"
        )
    };
    let contact = "[[contact]]\nbodies = [\"a\", \"b\"]\n";
    let lower =
        "[[obstacle]]\nbody = \"a\"\nside = \"bottom\"\nrange = [0.5, 1]\nbelow = 1\n".to_string();
    let upper =
        "[[obstacle]]\nbody = \"b\"\nside = \"bottom\"\nrange = [0, 0.5]\nabove = -1\n".to_string();
    let bodies = body("a", 0, "dirichlet = [\"left\"]") + &body("b", 1, "dirichlet = [\"right\"]");
    let parts = ["\"a\"", "\"b\"", "at (1, 0)", "contradict", "expected"];
    refused("chain", &format!("{bodies}{contact}{lower}{upper}"), &parts);
    for two in [
        format!("{contact}{lower}"),
        format!("{contact}{upper}"),
        // The same with a gap between the bodies.
        format!("{contact}gap = 3\n{lower}{upper}"),
    ] {
        let scratch = Scratch::new("chain-two");
        let scene = scratch.file("s.toml", &(bodies.clone() + &two));
        let out = fetifeti(&["solve", &scene, "--quiet"]);
        assert_eq!(out.code, 0, "{two}: {}", out.all());
    }
}

#[test]
fn the_plan_has_candidates_and_load_steps() {
    for (scene, parts) in [
        (MODEL, &["33 inequalities", "33 candidate nodes"][..]),
        (
            PRESS,
            &["18 inequalities", "18 candidate nodes", "load steps", "10,"],
        ),
    ] {
        let out = fetifeti(&["plan", scene]);
        assert_eq!((out.code, out.stderr.as_str()), (0, ""), "{}", out.all());
        for part in parts {
            assert!(out.stdout.contains(part), "{part}: {}", out.stdout);
        }
    }
}
