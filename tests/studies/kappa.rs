//! `study kappa --quick`: the measured condition numbers, also of contact with friction, and the error message for a
//! wrong case.

use crate::support::keys::{self, Keys};
use crate::support::{mpi, program};
use lab::study::kappa::friction::FrictionRow;
use lab::study::kappa::KappaReport;
use mpi::Scratch;
use program::run_fetifeti;

/// Required keys of the report.
const KEYS: Keys = &[
    ("", "study rows friction"),
    (
        "rows[]",
        "family subdomains elements dofs dirichlet coarse_corrected",
    ),
    ("rows[].dirichlet", "kappa exact lambda_min iterations"),
    (
        "rows[].coarse_corrected",
        "kappa exact lambda_min iterations",
    ),
    (
        "friction[]",
        "scene law stiffness elements dofs sticking slipping steps iterations estimate exact last_step",
    ),
    ("friction[].estimate", "lambda_min lambda_max kappa"),
    ("friction[].exact", "lambda_min lambda_max kappa"),
];

#[test]
fn condition_numbers_are_those_that_were_measured() {
    let dir = Scratch::new("study-kappa");
    let file = dir.path("kappa.json");
    let args = [
        "study",
        "kappa",
        "--quick",
        "--quiet",
        "--json",
        &file,
        "-fetifeti_spectrum",
    ];
    let run = run_fetifeti(1, &args);
    assert_eq!(run.code, 0, "{}", run.all());
    let text = std::fs::read_to_string(&file).expect("a report");
    let report: KappaReport = keys::read(&text, KEYS);
    for row in &report.rows {
        for found in [&row.dirichlet, &row.coarse_corrected] {
            let exact = found.exact.expect("asked for");
            // The Lanczos estimate is a lower bound.
            assert!(found.kappa <= exact * (1.0 + 1e-6), "{row:?}");
            assert!(found.kappa > 0.98 * exact, "{row:?}");
            assert!(found.lambda_min > 1.0 - 1e-6, "{row:?}");
        }
        let (d, c) = (row.dirichlet.kappa, row.coarse_corrected.kappa);
        assert!(c < d, "M_C is never worse than M_D: {row:?}");
    }
    // Growth with the subdomains across a body: M_C against M_D, (2,2,4) and (2,4,4).
    let plane: Vec<_> = report
        .rows
        .iter()
        .filter(|r| r.family == "scalar-2d")
        .collect();
    let grows = |f: fn(&lab::study::kappa::KappaRow) -> f64| f(plane[1]) / f(plane[0]);
    assert!(grows(|r| r.coarse_corrected.kappa) < 1.7);
    assert!(grows(|r| r.dirichlet.kappa) > 2.0);
    friction_is_near_ties(&report.friction);
}

/// Contact with friction against ties of the same scene and size.
fn friction_is_near_ties(rows: &[FrictionRow]) {
    let mut tied = 0.0;
    let (mut sticking, mut slipping) = (0, 0);
    for row in rows {
        let exact = row.exact.expect("asked for");
        // The Lanczos estimate is a lower bound.
        assert!(row.estimate.kappa <= exact.kappa * (1.0 + 1e-6), "{row:?}");
        assert!(row.estimate.kappa > 0.98 * exact.kappa, "{row:?}");
        // F + C is not below F: λ_min ≥ 1 with springs, too.
        let last = row.last_step.unwrap_or(exact);
        for ends in [exact, last] {
            assert!(ends.lambda_min >= 1.0 - 1e-8, "{row:?}");
        }
        // In the plane the last step has the rows of the solution, but for those that depend on others.
        let apart = (last.kappa / exact.kappa - 1.0).abs();
        let near = if row.scene == "blocks-2d" { 1e-5 } else { 0.2 };
        assert!(apart < near, "{row:?}");
        match row.law.as_str() {
            "tied" => tied = exact.kappa,
            // At most 2.1 times as large, measured.
            "frictionless" | "friction" => assert!(exact.kappa < 3.0 * tied, "{row:?}"),
            _ => assert!(row.stiffness == Some(1.0)),
        }
        if row.law == "friction" {
            (sticking, slipping) = (sticking + row.sticking, slipping + row.slipping);
        }
    }
    let count = |law: &str| rows.iter().filter(|r| r.law == law).count();
    for law in ["tied", "frictionless", "friction", "soft", "elastic slip"] {
        assert_eq!(count(law), 4, "{law}");
    }
    assert!(sticking > 20 && slipping > 20, "{sticking}, {slipping}");
}

#[test]
fn a_case_that_there_is_not_is_refused() {
    let run = run_fetifeti(1, &["study", "kappa", "scalar-4d", "--quick"]);
    assert_eq!(run.code, 2, "{}", run.all());
    assert!(run.stderr.contains("scalar-4d") && run.stderr.contains("elastic-3d-0.3"));
}
