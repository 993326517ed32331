//! `fetifeti compare` on scenes with inequalities: a loop on the multipliers and a loop on the assembled problem must
//! find the same set and the same solution.

use crate::support::{compared, program};
use compared::{solved, SceneFile};
use program::fetifeti;
use report::json::{CompareContact, CompareReport, CompareRow};

fn contact(row: &CompareRow) -> CompareContact {
    row.run.contact.expect("what became of the inequalities")
}

/// Properties of every row, for any scene.
fn check(report: &CompareReport, rtol: f64) {
    let reference = report.facts.contact.expect("inequalities");
    assert!(report.facts.reference_residual.expect("a direct solution") < 1e-11);
    assert!(reference.feasibility.expect("a direct solution") < 1e-13);
    assert!(reference.min_multiplier.expect("a direct solution") > -1e-13);
    for r in report.rows.iter().filter(|r| solved(r)) {
        let what = format!("{} on {} ranks: {r:?}", r.run.method, r.run.ranks);
        let c = contact(r);
        assert!(r.run.residual.expect("a residual") <= rtol, "{what}");
        assert!(r.run.error.expect("an error") < 10.0 * rtol, "{what}");
        assert_eq!(c.differ, Some(0), "{what}");
        assert!(c.feasibility.expect("a violation") < 10.0 * rtol, "{what}");
        assert!(c.min_multiplier.expect("signs") > -100.0 * rtol, "{what}");
        let last_set = ["bddc", "fetidp"].contains(&r.run.method.as_str());
        assert_eq!(c.outer.is_none(), last_set, "{what}");
    }
}

/// Lee's model problem, with subdomains and elements of each body.
fn model(subdomains: &str, elements: &str) -> String {
    let text =
        std::fs::read_to_string("../../examples/scenes/model_contact.toml").expect("the scene");
    let fine = "subdomains = [4, 4]";
    assert!(text.contains(fine) && text.contains("elements = 32"));
    text.replace(fine, &format!("subdomains = {subdomains}"))
        .replace("elements = 32", &format!("elements = {elements}"))
}

#[test]
fn all_methods_agree_on_the_model_problem() {
    let scene = SceneFile::new("model", &model("[2, 1]", "16"));
    let report = scene.compare(&["-fetifeti_ksp_rtol", "1e-8"]);
    check(&report, 1e-8);
    let methods = report.rows.iter().map(|r| r.run.method.as_str());
    let methods: Vec<&str> = methods.filter(|method| *method != "hpddm").collect();
    assert_eq!(
        methods,
        ["fetifeti", "fetifeti", "bddc", "bddc", "fetidp", "fetidp", "gamg", "hypre", "mumps"]
    );
    let reference = report.facts.contact.expect("inequalities");
    assert_eq!((reference.rows, reference.load_steps), (17, 1));
    // The upper part stays in contact, because the left body is pushed down there; in the lower part the right body
    // would have to pull.
    let active = reference.active.expect("a direct solution");
    assert!((1..17).contains(&active), "{active}");
    let [one, two] = [&report.rows[0], &report.rows[1]];
    assert_eq!(one.run.iterations, two.run.iterations);
    assert_eq!(contact(one), contact(two));
    for row in report.rows.iter().filter(|r| solved(r)) {
        assert_eq!(contact(row).active, active, "{}", row.run.method);
        let outer = contact(row).outer;
        assert!(outer.is_none_or(|n| (2..12).contains(&n)), "{row:?}");
        // `iterations` are inner iterations of all steps; they are fewer than those of as many full solves.
        let direct = row.run.method == "mumps";
        assert_eq!(row.run.iterations.is_none(), direct, "{row:?}");
    }
    // The loop with the direct solver needs one solve per set.
    let mumps = report.rows.last().expect("a row");
    if solved(mumps) {
        assert!(mumps.run.error.is_some_and(|e| e < 1e-12), "{mumps:?}");
        assert_eq!(contact(mumps).outer, reference.outer);
    }
}

/// Two rows of two bodies on an uneven ground; only the lower left one is held. Where all four meet, rows are linearly
/// dependent, and their gaps are compatible only by chance.
const PILE: &str = r#"
title = "a pile"
[options]
fetifeti_ksp_rtol = 1e-9
[grid]
bodies = [2, 2]
size = [2, 2]
elements = 6
subdomains = [1, 2]
load = [[-1, -2], [-3, -4]]
[interface]
default = "contact"
[[contact]]
bodies = ["b0_0", "b1_0"]
gap = 0.01
[[contact]]
bodies = ["b1_1", "b1_0"]
gap = "0.02*x"
[[obstacle]]
body = "b0_0"
side = "bottom"
below = -0.2
[[obstacle]]
body = "b1_0"
side = "bottom"
below = "-0.1 + 0.1*sin(4*x)"
[[obstacle]]
body = "b0_1"
side = "left"
below = "-0.3 - 0.1*y"
[[obstacle]]
body = "b1_1"
side = "right"
below = -0.5
"#;

#[test]
fn floating_bodies_gaps_and_obstacles_come_out_the_same() {
    let scene = SceneFile::new("pile", PILE);
    let report = scene.compare(&[]);
    check(&report, 1e-9);
    let reference = report.facts.contact.expect("inequalities");
    let active = reference.active.expect("a direct solution");
    assert!(0 < active && active < reference.rows, "{reference:?}");
}

/// A body under a load that depends on the load step; it touches the obstacle with all its nodes or with none.
const STEPS: &str = r#"
title = "steps"
[steps]
count = 4
load = "1 - 2*t"
[[body]]
name = "plate"
size = [1, 1]
elements = 8
subdomains = [2, 1]
dirichlet = ["left"]
load = 1
[[obstacle]]
body = "plate"
side = "right"
above = 0.1
below = -0.05
"#;

#[test]
fn the_last_load_step_is_solved_and_that_is_said() {
    let scene = SceneFile::new("steps", STEPS);
    let report = scene.compare(&["--with", "hypre,mumps,bddc"]);
    check(&report, 1e-6);
    let reference = report.facts.contact.expect("inequalities");
    // The load has changed its sign: all nine nodes lie on the lower bound.
    assert_eq!((reference.rows, reference.active), (18, Some(9)));
    assert_eq!(reference.load_steps, 4);
    let out = scene.scratch.path("out");
    let text = scene.run(&["--with", "bddc", "--out", &out]).stdout;
    assert!(
        text.contains("Of 4 load steps the last one is solved, alone."),
        "{text}"
    );
    assert!(
        text.contains("outer") && text.contains("last set"),
        "{text}"
    );
    let csv = std::fs::read_to_string(format!("{out}/compare.csv")).expect("a table");
    let header = csv.lines().next().expect("a header");
    for column in ["outer_steps", "iterations", "active_rows", "active_differ"] {
        assert!(header.split(',').any(|c| c == column), "{header}");
    }
}

#[test]
fn more_ranks_than_allowed_are_not_started() {
    let scene = SceneFile::new("ranks", &model("[2, 1]", "16"));
    let report = scene.compare(&["--with", "bddc", "-compare_max_ranks", "2"]);
    let text: Vec<_> = report
        .rows
        .iter()
        .filter_map(|r| r.run.message.clone())
        .collect();
    assert!(
        text.iter()
            .any(|m| m.starts_with("needs ") && m.contains("2 are allowed")),
        "{text:?}"
    );
    let output = fetifeti(&["compare", scene.path(), "-compare_cores", "1000"]);
    assert_eq!(output.code, 2);
    let err = &output.stderr;
    assert!(
        err.contains("-compare_cores is 1000, expected at most 256"),
        "{err}"
    );
}

#[test]
fn the_tolerance_of_the_inner_solves_is_an_option() {
    let scene = SceneFile::new("inner", &model("[2, 1]", "16"));
    let iterations = |inner: &str| {
        let options = ["--with", "gamg", "-compare_inner_rtol", inner];
        let report = scene.compare(&options);
        check(&report, 1e-10);
        let gamg = report.rows.last().expect("gamg");
        solved(gamg).then_some(gamg.run.iterations).flatten()
    };
    let both = iterations("1e-6").zip(iterations("0.3"));
    assert!(both.is_none_or(|(tight, loose)| tight > loose), "{both:?}");
    let output = fetifeti(&["compare", scene.path(), "-compare_inner_rtol", "1"]);
    assert_eq!(output.code, 2);
    let err = &output.stderr;
    assert!(err.contains("-compare_inner_rtol is 1"), "{err}");
}
