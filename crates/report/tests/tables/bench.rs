//! Unit tests of `crates/report/src/tables/bench.rs`.

use super::*;
use crate::json::{BenchSample, ComparedScene, MethodRun, PhaseSeconds};

fn report() -> BenchReport {
    let row = |method: &str, layout: &str, seconds: &[f64]| BenchRow {
        run: MethodRun {
            method: method.into(),
            layout: layout.into(),
            options: format!("-pc_type {method}"),
            ranks: 2,
            threads: 1,
            error: Some(1e-8),
            converged: true,
            converged_reason: "CONVERGED_RTOL".into(),
            ..MethodRun::default()
        },
        samples: seconds
            .iter()
            .map(|&s| BenchSample {
                seconds: PhaseSeconds {
                    assemble: None,
                    setup: Some(0.5 * s),
                    solve: Some(0.5 * s),
                    total: Some(s),
                },
                converged: true,
                ..BenchSample::default()
            })
            .collect(),
        ..BenchRow::default()
    };
    let mut failed = row("mumps", "core", &[]);
    failed.run.converged = false;
    failed.run.message = Some("round 1: out of memory".into());
    let mut case = BenchCase {
        case: "square".into(),
        facts: ComparedScene {
            scene: "A square".into(),
            bodies: 4,
            subdomains: 16,
            dofs: 225,
            rtol: 1e-6,
            ..ComparedScene::default()
        },
        rounds: 3,
        methods: vec![
            row("fetifeti", "threads", &[0.25, 0.5, 1.0]),
            row("gamg", "core", &[2.0, 4.0, 1.5]),
            failed,
        ],
    };
    case.sum_up();
    BenchReport {
        schema: BenchReport::SCHEMA.into(),
        version: "0".into(),
        blas: Some("/lib/libblas.so".into()),
        cores: 2,
        rounds: 3,
        quick: false,
        cases: vec![case],
    }
}

#[test]
fn the_table_has_medians_ranges_and_the_last_word() {
    let text = text(&report());
    let line = text.lines().find(|l| l.starts_with("gamg")).unwrap();
    let words: Vec<&str> = line.split_whitespace().collect();
    assert_eq!(words[4..11].join(" "), "– 1.000 1.000 – 2.000 1.500 4.000");
    assert_eq!((words[1], words[11]), ("core", "4.00"));
    assert!(text.contains("\n  gamg (core): -pc_type gamg\n"), "{text}");
    assert!(text.contains("mumps: round 1: out of memory"), "{text}");
    assert!(text.contains("fastest other: 2.000 s (gamg), 4.00 times as long"));
    assert!(text.contains("/lib/libblas.so"));
}

#[test]
fn csv_and_picture_have_what_there_is() {
    let report = report();
    let csv = csv(&report).to_csv();
    let line = csv
        .lines()
        .find(|l| l.starts_with("square,mumps"))
        .expect("a row");
    assert!(
        line.ends_with("0,false,CONVERGED_RTOL,-pc_type mumps,,,round 1: out of memory"),
        "{line}"
    );
    let columns = csv.lines().next().expect("a header").split(',').count();
    assert!(
        csv.lines().all(|l| l.split(',').count() == columns),
        "{csv}"
    );
    let figure = figure(&report);
    // Two methods with an error, each with its marker and its bar.
    assert_eq!(figure.panels[0].series.len(), 4);
}
