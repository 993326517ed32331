//! `study kernels --quick`: every solver with every ordering, with errors and times.

use crate::support::keys::{self, Keys};
use crate::support::{mpi, program};
use lab::study::kernels::{faster, summary, KernelsReport, CASES, WORTH_CHANGING};
use mpi::Scratch;
use program::run_fetifeti;

/// Required keys of the report.
const KEYS: Keys = &[
    ("", "study rows"),
    (
        "rows[]",
        "case solver ordering default elements interior interface rounds analyse factor solve schur bytes \
         error schur_error",
    ),
];

#[test]
fn every_combination_is_measured_and_solves() {
    let dir = Scratch::new("study-kernels");
    let (file, out) = (dir.path("kernels.json"), dir.path("out"));
    let run = run_fetifeti(
        1,
        &[
            "study", "kernels", "--quick", "--quiet", "--out", &out, "--json", &file,
        ],
    );
    assert_eq!(run.code, 0, "{}", run.all());
    let text = std::fs::read_to_string(&file).expect("a report");
    let report: KernelsReport = keys::read(&text, KEYS);
    assert_eq!(report.rows.len(), CASES.len() * 8);
    for row in &report.rows {
        for seconds in [row.analyse, row.factor, row.solve, row.schur] {
            assert!(seconds > 0.0 && seconds.is_finite(), "{row:?}");
        }
        assert!(row.error < 1e-12 && row.schur_error < 1e-12, "{row:?}");
        assert!(row.interior > 0 && row.interface > 0 && row.bytes > 8 * row.interior);
        let ours = (row.solver.as_str(), row.ordering.as_str()) == ("multifrontal", "nd");
        assert_eq!(row.default, ours);
    }
    // A plane square of 16 elements across; a solid of 6, three components.
    let first = &report.rows[0];
    assert_eq!((first.interior, first.interface), (15 * 15, 4 * 16));
    let last = report.rows.last().expect("rows");
    assert_eq!((last.interior, last.interface), (3 * 125, 3 * (343 - 125)));
    for name in ["kernels.csv", "kernels-summary.csv", "kernels.json"] {
        assert!(std::path::Path::new(&out).join(name).is_file(), "{name}");
    }
}

/// The statement about faster solvers follows from the rows alone.
#[test]
fn only_what_is_clearly_faster_is_named() {
    let row = |solver: &str, default, factor| lab::study::kernels::KernelRow {
        case: "a".into(),
        solver: solver.into(),
        ordering: "nd".into(),
        default,
        factor,
        solve: 1.0,
        schur: 1.0,
        ..Default::default()
    };
    let report = |other| KernelsReport {
        study: "kernels".into(),
        rows: vec![row("multifrontal", true, 2.0), row("faer", false, other)],
    };
    assert!(faster(&report(2.0 / WORTH_CHANGING)).is_empty());
    let found = faster(&report(1.0));
    assert_eq!(found.len(), 1);
    assert_eq!(
        (found[0].2, found[0].3.as_str(), found[0].5),
        ("factor", "faer", 2.0)
    );
    let table = summary(&report(1.0)).to_csv();
    assert!(
        table
            .lines()
            .nth(1)
            .expect("a row")
            .ends_with("faer nd,2.00"),
        "{table}"
    );
}

#[test]
fn several_ranks_are_refused() {
    let run = run_fetifeti(2, &["study", "kernels", "--quick"]);
    assert_eq!(run.code, 2, "{}", run.all());
    assert!(run.stderr.contains("2 ranks"));
}
