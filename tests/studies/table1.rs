//! `study table1`: the rows that `fetifeti table1` has, and the error message for a wrong row.

use crate::support::keys::{self, Keys};
use crate::support::{mpi, program};
use lab::study::table1::Table1Report;
use mpi::Scratch;
use program::fetifeti;
use serde_json::Value;

/// Required keys of the report.
const KEYS: Keys = &[
    ("", "study rows"),
    (
        "rows[]",
        "bodies subdomains elements whole_interface middle_third",
    ),
    (
        "rows[].whole_interface",
        "multipliers floating_bodies iterations exact estimate paper coarse_corrected",
    ),
];

#[test]
fn the_rows_are_those_of_the_command() {
    let dir = Scratch::new("study-table1");
    let (command, study) = (dir.path("command"), dir.path("study"));
    let rows = ["2,2,2", "4,2,2", "6,2,2"].map(|row| ["--rows", row]);
    let args = ["table1", "--quiet", "--out", &command];
    let run = fetifeti(&[&args, rows.as_flattened()].concat());
    assert_eq!(run.code, 0, "{}", run.all());
    let run = fetifeti(&["study", "table1", "--quick", "--quiet", "--out", &study]);
    assert_eq!(run.code, 0, "{}", run.all());
    let read = |name: &str, dir: &str| {
        std::fs::read(format!("{dir}/{name}")).unwrap_or_else(|e| panic!("{name}: {e}"))
    };
    let text = String::from_utf8(read("table1.json", &study)).expect("text");
    let report: Table1Report = keys::read(&text, KEYS);
    assert_eq!((report.study.as_str(), report.rows.len()), ("table1", 3));
    let json = |text: &[u8]| serde_json::from_slice::<Value>(text).expect("JSON");
    assert_eq!(
        json(text.as_bytes())["rows"],
        json(&read("table1.json", &command))
    );
    for name in ["table1.csv", "figure3.png", "figure3.svg"] {
        assert!(read(name, &study) == read(name, &command), "{name}");
    }
}

#[test]
fn a_row_is_a_case() {
    let run = fetifeti(&["study", "table1", "2,2,4", "--json", "-"]);
    assert_eq!((run.code, run.stderr.as_str()), (0, ""), "{}", run.all());
    let report: Table1Report = keys::read(&run.stdout, KEYS);
    let sizes = report.rows.iter();
    let sizes: Vec<_> = sizes
        .map(|r| [r.bodies, r.subdomains, r.elements])
        .collect();
    assert_eq!(sizes, [[2, 2, 4]]);
}

#[test]
fn a_row_that_cannot_be_is_refused() {
    for (row, part) in [
        ("2,4", "expected three counts of at least 1"),
        ("1,2,2", "expected three counts of at least 1"),
        (
            "100000,1,3",
            "study table1 100000,1,3: 100000 × 100000 bodies",
        ),
    ] {
        let run = fetifeti(&["study", "table1", row]);
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{}", run.all());
        assert!(run.stderr.contains(row) && run.stderr.contains(part));
        assert_eq!(run.stderr.trim_end().lines().count(), 1, "{}", run.all());
    }
}

#[test]
fn a_solve_that_stops_early_is_said_after_the_results() {
    let limit = ["-fetifeti_ksp_max_it", "2"];
    let commands = [
        &["table1", "--rows", "2,2,2"][..],
        &["study", "table1", "2,2,2"],
    ];
    let [command, study] = commands.map(|args| fetifeti(&[args, &limit].concat()));
    assert_eq!((command.code, study.code), (1, 1), "{}", study.all());
    assert_eq!(command.stderr, study.stderr);
    assert_eq!(command.stdout, study.stdout);
    assert!(study.stderr.contains("did not converge"), "{}", study.all());
}
