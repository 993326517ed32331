//! `study speed-error --quick`: errors of meshes and solvers, and the files.

use crate::support::keys::{self, Keys};
use crate::support::sample::{all_cases, of};
use crate::support::{mpi, program};
use lab::study::speed_error::SpeedErrorReport;
use mpi::Scratch;
use program::{fetifeti, run_fetifeti};

/// Required keys of the report.
const KEYS: Keys = &[
    ("", "study cores cases"),
    ("cases[]", "case title meshes runs"),
    ("cases[].meshes[]", "elements dofs error"),
    (
        "cases[].runs[]",
        "method elements dofs rtol ranks threads iterations setup solve solver_error error converged",
    ),
];

#[test]
fn errors_fall_with_the_mesh() {
    let dir = Scratch::new("study-speed");
    let (file, out) = (dir.path("speed.json"), dir.path(""));
    // The sample is the case with contact.
    let only: &[&str] = if all_cases() { &[] } else { &["contact"] };
    let options = ["--quick", "--quiet", "--json", &file, "--out", &out];
    let run = fetifeti(&[&["study", "speed-error"], only, &options].concat());
    assert_eq!(run.code, 0, "{}", run.all());
    let text = std::fs::read_to_string(&file).expect("a report");
    let report: SpeedErrorReport = keys::read(&text, KEYS);
    assert_eq!(report.cases.len(), of(1, 3));
    for case in &report.cases {
        let [coarse, fine] = case.meshes[..] else {
            panic!("two meshes")
        };
        // Order 1 in the energy norm; a little less where contact ends inside an element, and on meshes this coarse.
        let ratio = fine.elements as f64 / coarse.elements as f64;
        let order = (coarse.error / fine.error).ln() / ratio.ln();
        println!(
            "{}: {} {} order {order}",
            case.case, coarse.error, fine.error
        );
        assert!(order > 0.8 && order < 1.3, "{}: order {order}", case.case);
        // A failed run of MUMPS has no result to be listed.
        let mut ours = case.methods();
        ours.retain(|m| m != "mumps");
        assert_eq!(ours, ["fetifeti", "fetifeti, mixed"]);
        for run in &case.runs {
            let mesh = case.meshes.iter().find(|m| m.elements == run.elements);
            let mesh = mesh.expect("a run has a mesh").error;
            assert!((run.error - mesh.hypot(run.solver_error)).abs() <= 1e-12 * run.error);
            // Ours must converge; MUMPS need not.
            assert!(run.converged || run.method == "mumps", "{run:?}");
            assert!(!run.converged || run.solver_error < 1e-3, "{run:?}");
            assert!(run.setup > 0.0 && run.solve > 0.0);
        }
        for method in ours {
            assert_eq!(case.fastest(&method).len(), 2);
        }
        for end in ["png", "svg"] {
            let file = dir.path(&format!("speed-error_{}.{end}", case.case));
            assert!(
                std::fs::metadata(&file).is_ok_and(|m| m.len() > 200),
                "{file}"
            );
        }
    }
    assert!(std::fs::metadata(dir.path("speed-error.csv")).is_ok());
}

#[test]
fn several_ranks_are_refused() {
    let run = run_fetifeti(2, &["study", "speed-error", "--quick"]);
    assert_eq!(run.code, 2, "{}", run.all());
    assert!(run.stderr.contains("2 ranks"), "{}", run.all());
}
