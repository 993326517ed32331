//! `fetifeti table1` against the paper. The sample has some of its rows; `make run` prints all of them.

use crate::support::checks::number;
use crate::support::sample::sample;
use crate::support::{mpi, program};
use mpi::{Output, Scratch};
use program::fetifeti;
use serde_json::Value;

fn table(rows: &[&str]) -> (Output, Vec<Value>) {
    let rows = rows.iter().flat_map(|r| ["--rows", *r]);
    let args: Vec<&str> = ["table1", "--json", "-"].into_iter().chain(rows).collect();
    let out = fetifeti(&args);
    assert_eq!(out.code, 0, "{}", out.all());
    assert_eq!(out.stderr, "", "{}", out.all());
    let table =
        serde_json::from_str(&out.stdout).expect("standard output is JSON and nothing else");
    (out, table)
}

/// Checks rows against the paper's numbers; docs/theory.md, section 14, says what can be checked at all.
fn against_the_paper(rows: &[&str]) {
    let (out, table) = table(rows);
    assert_eq!(table.len(), rows.len());
    for row in &table {
        let [bodies, subdomains, elements] =
            ["bodies", "subdomains", "elements"].map(|k| row[k].as_u64().expect("a count"));
        for side in ["whole_interface", "middle_third"] {
            let what = format!("({bodies},{subdomains},{elements}) {side}");
            let ours = &row[side];
            let (cond, iter) = (
                number(&ours["paper"]["cond"]),
                number(&ours["paper"]["iter"]),
            );
            let iterations = number(&ours["iterations"]);
            assert!(
                (iterations - iter).abs() <= 3.0,
                "{what}: {iterations} iterations for {iter}"
            );
            let (exact, estimate) = (number(&ours["exact"]), number(&ours["estimate"]));
            if side == "whole_interface" && (subdomains >= 4 || elements >= 4) {
                assert_eq!(format!("{exact:.4}"), format!("{cond:.4}"), "{what}");
            }
            // The other numbers of the paper are Lanczos estimates: lower bounds.
            assert!(cond < exact * 1.0002, "{what}: {exact} for {cond}");
            assert!(
                estimate < exact * (1.0 + 1e-6),
                "{what}: {estimate} above {exact}"
            );
            assert!(
                estimate > 0.75 * exact,
                "{what}: {estimate} far below {exact}"
            );
            let corrected = &ours["coarse_corrected"];
            assert!(
                number(&corrected["exact"]) < exact,
                "{what}: M_C is no worse than M_D"
            );
            assert!(
                number(&corrected["iterations"]) <= iterations + 1.0,
                "{what}"
            );
            for side in [ours, corrected] {
                let (low, high) = (number(&side["lambda_min"]), number(&side["lambda_max"]));
                assert!(low >= 1.0 - 1e-8, "{what}: {low}");
                assert!(
                    (high / low / number(&side["exact"]) - 1.0).abs() < 1e-12,
                    "{what}"
                );
            }
        }
    }
    println!("{} rows in {:.1} s", rows.len(), out.seconds);
}

#[test]
fn rows_with_more_bodies() {
    let rows = ["2,2,2", "4,2,2", "6,2,2", "8,2,2", "10,2,2", "12,2,2"];
    against_the_paper(&sample(4, rows).collect::<Vec<_>>());
}

#[test]
fn rows_with_more_subdomains() {
    let rows = [
        "2,4,2", "2,6,2", "2,8,2", "2,10,2", "2,12,2", "2,14,2", "2,16,2", "2,18,2",
    ];
    against_the_paper(&sample(4, rows).collect::<Vec<_>>());
}

#[test]
fn rows_with_more_elements() {
    let rows = ["2,2,4", "2,2,8", "2,2,16", "2,2,32"];
    against_the_paper(&sample(4, rows).collect::<Vec<_>>());
}

#[test]
fn rows_of_choice_have_the_keys_of_the_contract() {
    let (out, table) = table(&["2,4,2", "2,2,8"]);
    println!("{:.1} s", out.seconds);
    assert_eq!(table.len(), 2);
    for row in &table {
        for side in ["whole_interface", "middle_third"] {
            for key in ["multipliers", "floating_bodies", "iterations"] {
                assert!(row[side][key].is_u64(), "{key}");
            }
            for key in ["exact", "estimate"] {
                assert!(row[side][key].is_f64(), "{key}");
            }
            assert!(row[side]["paper"]["cond"].is_f64() && row[side]["paper"]["iter"].is_u64());
            let corrected = &row[side]["coarse_corrected"];
            assert!(corrected["exact"].is_f64() && corrected["iterations"].is_u64());
        }
    }
}

#[test]
fn a_row_that_the_paper_does_not_have() {
    let (_, table) = table(&["3,3,3"]);
    assert!(table[0]["whole_interface"]["paper"].is_null());
    assert!(table[0]["middle_third"]["exact"].is_f64());
    assert_eq!(table[0]["whole_interface"]["floating_bodies"], 1);
}

#[test]
fn files_of_the_table() {
    let scratch = Scratch::new("table");
    let dir = scratch.path("out");
    let out = fetifeti(&[
        "table1",
        "--rows",
        "2,2,2",
        "--rows",
        "2,4,2",
        "--out",
        &dir,
        "--json",
        &scratch.path("t.json"),
    ]);
    assert_eq!(out.code, 0, "{}", out.all());
    assert!(out.stdout.contains("7.1076"), "{}", out.all());
    for name in ["table1.json", "table1.csv", "figure3.png", "figure3.svg"] {
        let bytes =
            std::fs::read(format!("{dir}/{name}")).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(bytes.len() > 200, "{name}");
    }
    let csv = std::fs::read_to_string(format!("{dir}/table1.csv")).expect("CSV");
    assert_eq!(csv.lines().count(), 3, "{csv}");
    let read = |path: String| {
        serde_json::from_str::<Value>(&std::fs::read_to_string(path).expect("JSON")).expect("JSON")
    };
    assert_eq!(
        read(scratch.path("t.json")),
        read(format!("{dir}/table1.json"))
    );
}
