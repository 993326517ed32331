//! `study walls --quick`: every wall is solved, in few steps, on one rank and on two.

use crate::support::keys::{self, Keys};
use crate::support::sample::{all_cases, sample};
use crate::support::{mpi, program};
use lab::study::walls::{Walls, WallsReport, FAMILIES, JUMPS};
use mpi::Scratch;
use program::run_fetifeti;

/// Required keys of the report.
const KEYS: Keys = &[
    ("", "study rows"),
    ("rows[]", "family jump walls seconds"),
    (
        "rows[].walls[]",
        "seed steps damped iterations energy reason converged",
    ),
];

/// No wall of the study takes more steps.
const STEPS: usize = 50;

fn report(ranks: usize, dir: &Scratch, case: &[&str]) -> WallsReport {
    let file = dir.path(&format!("walls-{ranks}.json"));
    let out = dir.path(&format!("walls-{ranks}"));
    let args = [
        "study", "walls", "--quick", "--quiet", "--json", &file, "--out", &out,
    ];
    let run = run_fetifeti(ranks, &[&args[..2], case, &args[2..]].concat());
    assert_eq!(run.code, 0, "{}", run.all());
    keys::read(&std::fs::read_to_string(&file).expect("a report"), KEYS)
}

#[test]
fn all_are_solved_in_few_steps() {
    let dir = Scratch::new("study-walls");
    // The sample is every other family, the whole study otherwise.
    let families = sample(2, FAMILIES);
    let n = families.len();
    let rows: Vec<Walls> = if all_cases() {
        report(1, &dir, &[]).rows
    } else {
        families
            .flat_map(|f| report(1, &dir, &[f.name]).rows)
            .collect()
    };
    assert_eq!(rows.len(), n * JUMPS.len());
    for row in &rows {
        assert_eq!(row.unsolved().count(), 0, "{} {:e}", row.family, row.jump);
        for wall in &row.walls {
            println!("{} {:e}: {wall:?}", row.family, row.jump);
            assert!(wall.steps <= STEPS && wall.damped < wall.steps);
        }
    }
    // The study is about walls in which the sets of the active set wander.
    assert!(rows.iter().any(|r| r.damped() > 0));
    // The slowest wall of each row is there to be solved again.
    let row = &rows[0];
    let slowest = row.walls.iter().max_by_key(|w| (w.steps, w.iterations));
    let slowest = slowest.expect("there are walls");
    let name = format!(
        "walls-1/{}-{:e}-{}.toml",
        row.family, row.jump, slowest.seed
    );
    let (scene, json) = (dir.path(&name), dir.path("again.json"));
    let run = run_fetifeti(1, &["solve", &scene, "--quiet", "--json", &json]);
    assert_eq!(run.code, 0, "{}", run.all());
    let again = std::fs::read_to_string(&json).expect("a report");
    let again: serde_json::Value = serde_json::from_str(&again).expect("JSON");
    let steps = again["contact"]["steps"].as_array().map(Vec::len);
    assert_eq!(steps, Some(slowest.steps));
}

#[test]
fn two_ranks_solve_them_too() {
    let dir = Scratch::new("study-walls-2");
    let report = report(2, &dir, &["scalar-7x7-open"]);
    assert_eq!(report.rows.len(), JUMPS.len());
    for wall in report.rows.iter().flat_map(|r| &r.walls) {
        assert!(wall.converged && wall.steps <= STEPS, "{wall:?}");
    }
}
