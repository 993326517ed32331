//! `fetifeti solve deck.inp`: displacements as CalculiX prints them.

use crate::support::mpi::Scratch;
use crate::support::program::run_fetifeti;
use fetifeti::mesh::deck::{read_dat, Quantity, Table};
use serde_json::Value;

const DECK: &str = "tests/inside/mesh/deck/block.inp";
const REFERENCE: &str = "tests/inside/mesh/deck/block.dat";

/// The tables of displacements in a file.
fn displacements(path: &str) -> Vec<Table> {
    let text = std::fs::read_to_string(path).expect(path);
    let tables = read_dat(&text).into_iter();
    tables
        .filter(|t| t.quantity == Quantity::Displacement)
        .collect()
}

/// Steps, local axes, amplitudes and reduced integration: what `ccx block` has printed, up to its last digit.
#[test]
fn a_deck_has_the_displacements_of_calculix() {
    let scratch = Scratch::new("deck");
    let (out, json) = (scratch.path("out"), scratch.path("report.json"));
    for ranks in [1, 2] {
        let run = run_fetifeti(ranks, &["solve", DECK, "--out", &out, "--json", &json]);
        assert_eq!(run.code, 0, "{}", run.all());
        let ours = displacements(&format!("{out}/block.dat"));
        let theirs = displacements(REFERENCE);
        assert_eq!(ours.len(), theirs.len());
        for (a, b) in ours.iter().zip(&theirs) {
            assert_eq!(
                (&a.set, a.time, a.rows.len()),
                (&b.set, b.time, b.rows.len())
            );
            let size = b
                .rows
                .iter()
                .flat_map(|r| r.vector)
                .fold(0.0_f64, |m, x| m.max(x.abs()));
            for (p, q) in a.rows.iter().zip(&b.rows) {
                assert_eq!((p.id, p.local), (q.id, q.local));
                for (x, y) in p.vector.iter().zip(q.vector) {
                    assert!((x - y).abs() <= 2e-6 * size, "node {}: {x}, not {y}", p.id);
                }
            }
        }
        let report: Value = serde_json::from_str(&std::fs::read_to_string(&json).unwrap()).unwrap();
        let printed = report["node_print"].as_array().expect("tables");
        assert_eq!(printed.len(), theirs.len());
        assert_eq!(printed[0]["set"], theirs[0].set.as_str());
        assert_eq!(
            printed[0]["nodes"].as_array().unwrap().len(),
            theirs[0].rows.len()
        );
    }
}

#[test]
fn a_deck_that_is_not_solved_is_refused_with_its_line() {
    let scratch = Scratch::new("deck_refused");
    let text = std::fs::read_to_string(DECK).unwrap();
    let deck = scratch.file("plastic.inp", &text.replace("*STATIC", "*FREQUENCY"));
    let run = run_fetifeti(1, &["solve", &deck]);
    assert_eq!(run.code, 2, "{}", run.all());
    assert!(
        run.stderr.contains("*FREQUENCY") && run.stderr.contains("line"),
        "{}",
        run.stderr
    );
}
