//! Mortar rows by the program: exact condition numbers of the example, and the identities of the operators.

use crate::support::checks::number;
use crate::support::mpi::Scratch;
use crate::support::program::fetifeti;
use serde_json::Value;

/// `examples/scenes/mortar_2d.toml` with other counts and coefficients; the first body carries the multipliers.
fn scene(row: &Value) -> String {
    let text = std::fs::read_to_string("../../examples/scenes/mortar_2d.toml").expect("a scene");
    let n = row["subdomains"].as_u64().expect("a count");
    let parts = text.split("[[body]]").enumerate().map(|(k, part)| {
        let Some(side) = k.checked_sub(1) else {
            return part.to_string();
        };
        let key = ["elements_multiplier_side", "elements_other_side"][side];
        let m = n * row[key].as_u64().expect("a count");
        let line = |line: &str| match line.split(" =").next() {
            Some("elements") => format!("elements = {m}\n"),
            Some("subdomains") => format!("subdomains = {n}\n"),
            Some("rho") => format!("rho = {}\n", row["rho"][side]),
            _ => format!("{line}\n"),
        };
        part.lines().map(line).collect()
    });
    parts.collect::<Vec<String>>().join("[[body]]")
}

/// The report of `solve` with exact spectrum and checks.
fn solve(file: &str, more: &[&str]) -> Value {
    let base = [
        "solve",
        file,
        "--quiet",
        "--json",
        "-",
        "-fetifeti_spectrum",
        "-fetifeti_check",
    ];
    let out = fetifeti(&[&base[..], more].concat());
    assert_eq!(out.code, 0, "{}", out.all());
    serde_json::from_str(&out.stdout).expect("JSON")
}

/// Checks the identities of a report: B B_Dᵀ B = B and the others, and P² = P where bodies float.
fn identities(report: &Value, what: &str) {
    let check = report["check"].as_object().expect("checks");
    for (name, defect) in check {
        // What a sparse factor of a subdomain that is long or nearly incompressible loses.
        let limit = if name == "S S^+ S = S" { 1e-8 } else { 1e-12 };
        assert!(number(defect) < limit, "{what}: {name} {defect}");
    }
    let has = |name: &str| check.contains_key(name);
    assert!(
        has("B B_D^T B = B") && has("lambda_min >= 1"),
        "{what}: {check:?}"
    );
    let floating = report["floating_bodies"] != 0;
    assert_eq!(has("P P = P"), floating, "{what}: {check:?}");
    let lifted = report["preconditioner"] == "coarse_corrected";
    assert_eq!(has("B Z_c = 0"), lifted, "{what}: {check:?}");
}

#[test]
fn kappa_of_the_example_is_that_of_the_oracle() {
    let scratch = Scratch::new("mortar-kappa");
    let text = include_str!("../data/mortar2d.json");
    let table: Vec<Value> = serde_json::from_str(text).expect("JSON");
    assert_eq!(table.len(), 8);
    for row in table {
        let file = scratch.file("s.toml", &scene(&row));
        for (pc, key) in [("dirichlet", "full M_D"), ("coarse_corrected", "full M_C")] {
            let report = solve(&file, &["-fetifeti_pc_type", pc]);
            let what = format!("{row}, {pc}");
            let kappa = number(&report["condition"]["exact"]["kappa"]);
            let expected = number(&row[key]);
            assert!((kappa / expected - 1.0).abs() < 1e-4, "{what}: {kappa}");
            identities(&report, &what);
        }
    }
    // As the comment of the example says.
    let of = |more: &[&str]| {
        let report = solve("../../examples/scenes/mortar_2d.toml", more);
        number(&report["condition"]["exact"]["kappa"])
    };
    assert!((of(&[]) - 2.4302).abs() < 1e-4);
    assert!((of(&["-fetifeti_pc_type", "dirichlet"]) - 18.2603).abs() < 1e-4);
}

/// Hard cases with mortar rows, tied and in contact, in the plane and in space.
#[test]
fn the_program_checks_mortar_rows() {
    let scratch = Scratch::new("mortar-check");
    for case in lab::study::hard_cases::trackers() {
        let file = scratch.file("s.toml", &case.text);
        for more in [&[][..], &["-fetifeti_pc_type", "dirichlet"]] {
            let report = solve(&file, more);
            assert!(report["multipliers"]["global"] != 0, "{}", case.name);
            identities(&report, case.name);
        }
    }
}
