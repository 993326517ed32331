//! `fetifeti compare` on decks with equations between displacements: the assembled problem has an unknown less for
//! each, and our multipliers must find the same solution.

use crate::support::compared;
use crate::support::plates::{joined_plates, on_top};
use compared::{solved, SceneFile};

/// Cells along a side of each plate.
const N: usize = 12;

const TIGHT: [&str; 2] = ["-fetifeti_ksp_rtol", "1e-9"];

#[test]
fn all_methods_agree_where_equations_join_displacements() {
    let report = SceneFile::deck("equations", &joined_plates(N, &[])).compare(&TIGHT);
    assert!(report.facts.reference_residual.expect("a direct solution") < 1e-11);
    let reference = report.facts.contact.expect("inequalities");
    let active = reference.active.expect("a direct solution");
    assert!(0 < active && active < reference.rows, "{reference:?}");
    let methods: Vec<&str> = report.rows.iter().map(|r| r.run.method.as_str()).collect();
    for method in ["fetifeti", "bddc", "fetidp", "gamg", "hypre", "mumps"] {
        assert!(methods.contains(&method), "{methods:?}");
    }
    for r in report.rows.iter().filter(|r| solved(r)) {
        let what = format!("{} on {} ranks: {r:?}", r.run.method, r.run.ranks);
        assert!(r.run.residual.expect("a residual") <= 1e-9, "{what}");
        assert!(r.run.error.expect("an error") < 1e-8, "{what}");
        let contact = r.run.contact.expect("what became of the inequalities");
        assert_eq!(contact.differ, Some(0), "{what}");
    }
    let mumps = report.rows.last().expect("a row");
    assert!(
        !solved(mumps) || mumps.run.error.is_some_and(|e| e < 1e-12),
        "{mumps:?}"
    );
}

/// Bounds are on the displacements that the equation joins: nothing is left that it could determine.
#[test]
fn an_equation_between_bounded_displacements_is_not_compared() {
    let bounded = [(on_top(N, 3), 2, 1.0), (on_top(N, 4), 2, -1.0)];
    let scene = SceneFile::deck("bounded", &joined_plates(N, &[&bounded]));
    let report = scene.compare(&[&["--with", "mumps,bddc"][..], &TIGHT].concat());
    for r in &report.rows {
        assert_eq!((r.run.error, r.run.residual), (None, None), "{r:?}");
        if solved(r) {
            assert_eq!(r.run.method, "fetifeti");
            continue;
        }
        let message = r.run.message.as_deref().expect("a reason");
        let why =
            "an equation between displacements at (0.25, 1, 0) joins only displacements that \
                   inequalities bound";
        assert!(message.contains(why), "{message}");
    }
}
