//! `fetifeti compare` in space and in elasticity: tied bodies, contact along axes and along other normals, bodies that
//! float.

use crate::support::compared;
use crate::support::sample::all_cases;
use compared::{solved, SceneFile};
use report::json::{CompareReport, CompareRow};

/// All methods on a scene, to 1e-9.
fn compare(name: &str, text: &str, more: &[&str]) -> CompareReport {
    let scene = SceneFile::new(name, text);
    scene.compare(&[&["-fetifeti_ksp_rtol", "1e-9"], more].concat())
}

/// All methods, or these in the sample.
fn compare_some(name: &str, text: &str, some: &str) -> CompareReport {
    if !all_cases() {
        return compare(name, text, &["--with", some]);
    }
    let report = compare(name, text, &[]);
    assert_eq!(methods(&report), ALL);
    report
}

/// Every method that claims a solution has found the same one; ours must claim one.
fn check(report: &CompareReport) {
    assert!(report.facts.reference_residual.expect("a direct solution") < 1e-10);
    for r in report.rows.iter().filter(|r| solved(r)) {
        let what = format!("{} on {} ranks: {r:?}", r.run.method, r.run.ranks);
        assert!(r.run.residual.expect("a residual") <= 1e-9, "{what}");
        assert!(r.run.error.expect("an error") < 1e-8, "{what}");
    }
    if let Some(reference) = report.facts.contact {
        assert!(reference.feasibility.expect("a direct solution") < 1e-12);
        assert!(reference.min_multiplier.expect("a direct solution") > -1e-12);
        let active = reference.active.expect("a direct solution");
        assert!(0 < active && active < reference.rows, "{reference:?}");
        for r in report.rows.iter().filter(|r| solved(r)) {
            let what = format!("{} on {} ranks: {r:?}", r.run.method, r.run.ranks);
            let c = r.run.contact.expect("what became of the inequalities");
            assert_eq!(c.differ, Some(0), "{what}");
            assert!(c.feasibility.expect("a violation") < 1e-7, "{what}");
            assert!(c.min_multiplier.expect("signs") > -1e-6, "{what}");
        }
    }
}

/// The methods; of PCHPDDM there are as many rows as there is of it in PETSc.
fn methods(report: &CompareReport) -> Vec<&str> {
    let all = report.rows.iter().map(|r| r.run.method.as_str());
    all.filter(|method| *method != "hpddm").collect()
}

fn best<'a>(report: &'a CompareReport, method: &str) -> &'a CompareRow {
    let row = report.rows.iter().find(|r| r.run.method == method);
    row.expect("a row of this method")
}

const ALL: [&str; 9] = [
    "fetifeti", "fetifeti", "bddc", "bddc", "fetidp", "fetidp", "gamg", "hypre", "mumps",
];

#[test]
fn all_methods_agree_on_scalars_in_space() {
    let scene = r#"
title = "two cubes"
dimension = 3
[grid]
bodies = [2, 1, 1]
size = [2, 1, 1]
elements = 6
subdomains = [1, 2, 1]
dirichlet = ["left"]
load = "1 + x*y"
"#;
    let report = compare_some("scalar", scene, "fetidp,hypre,mumps");
    check(&report);
    assert_eq!(report.facts.dofs, 12 * 7 * 7);
}

/// Single components are prescribed on different sides; the stiffness jumps; the bodies have four and two subdomains.
const PLANE: &str = r#"
title = "two plates"
physics = "elasticity"
[[body]]
name = "left"
size = [1, 1]
elements = [12, 12]
subdomains = [2, 2]
poisson = 0.3
dirichlet = { left = { x = 0.01 }, bottom = { y = 0 } }
load = [0, -1]
[[body]]
name = "right"
origin = [1, 0]
size = [1, 1]
elements = [12, 12]
subdomains = [2, 1]
young = 50
poisson = 0.3
traction = { right = [0.3, 0.1] }
"#;

#[test]
fn all_methods_agree_on_tied_plates() {
    let report = compare("plane", PLANE, &[]);
    check(&report);
    // The third row has the tied plates as one body.
    let listed = methods(&report);
    assert_eq!((listed[0], &listed[1..]), ("fetifeti", &ALL[..]));
    assert_eq!(
        (report.facts.dofs, report.supports),
        (2 * 25 * 13 - 13 - 13, 0)
    );
    // With the rigid motions smoothed aggregation needs few iterations; without them it needs several times as many.
    let gamg = best(&report, "gamg");
    assert!(
        !solved(gamg) || gamg.run.iterations.expect("iterations") < 100,
        "{gamg:?}"
    );
}

#[test]
fn all_methods_agree_on_tied_blocks_in_space() {
    let scene = r#"
title = "two elastic cubes"
dimension = 3
physics = "elasticity"
[grid]
bodies = [2, 1, 1]
size = [2, 1, 1]
elements = 4
subdomains = [1, 2, 1]
dirichlet = { left = { x = 0 }, bottom = { y = 0 }, back = { z = 0 } }
poisson = 0.3
load = [0.1, -1, 0.2]
"#;
    let report = compare_some("space", scene, "bddc,gamg,mumps");
    check(&report);
}

/// A block on another one, pressed on one side more than on the other, with a gap that opens. Nothing holds it along x.
const BLOCKS: &str = r#"
title = "two blocks"
physics = "elasticity"
[[body]]
name = "lower"
size = [1, 1]
elements = [12, 12]
subdomains = [2, 2]
poisson = 0.3
dirichlet = { bottom = 0 }
[[body]]
name = "upper"
origin = [0, 1]
size = [1, 1]
elements = [12, 12]
subdomains = [2, 1]
young = 3
poisson = 0.3
traction = { top = ["0", "-0.1*(1 - x)"] }
[[contact]]
bodies = ["lower", "upper"]
gap = "0.03*x*x"
"#;

#[test]
fn all_methods_agree_on_blocks_of_which_one_floats() {
    let report = compare("blocks", BLOCKS, &[]);
    check(&report);
    assert_eq!(methods(&report), ALL);
    assert_eq!(report.supports, 1);
    // The same in space: sliding along both axes and rotation about the vertical one are free.
    let space = BLOCKS
        .replace("size = [1, 1]", "size = [1, 1, 1]")
        .replace("elements = [12, 12]", "elements = 4")
        .replace("subdomains = [2, 2]", "subdomains = [2, 1, 1]")
        .replace("subdomains = [2, 1]", "subdomains = [1, 1, 2]")
        .replace("origin = [0, 1]", "origin = [0, 1, 0]")
        .replace("-0.1*(1 - x)\"]", "-0.1*(1 - x)*z\", \"0\"]")
        .replace("physics", "dimension = 3\nphysics");
    let report = compare("blocks3", &space, &["--with", "bddc,gamg,hypre,mumps"]);
    check(&report);
    assert_eq!(report.supports, 3);
}

/// A block between an inclined plane and a disc that push into it: rows along many directions.
const OBSTACLES: &str = r#"
title = "a plane and a disc"
physics = "elasticity"
[[body]]
name = "block"
size = [1, 1]
elements = [12, 12]
subdomains = [2, 2]
poisson = 0.3
load = [0.05, -0.3]
dirichlet = { left = { x = 0 } }
[[obstacle]]
body = "block"
side = "bottom"
plane = { point = [0, 0], normal = [-0.1, 1] }
[[obstacle]]
body = "block"
side = "top"
cylinder = { centre = [0.5, 3], radius = 2.02 }
"#;

#[test]
fn all_methods_agree_on_normals_that_follow_no_axis() {
    let report = compare_some("obstacles", OBSTACLES, "bddc,gamg,mumps");
    check(&report);
    assert_eq!(report.supports, 0);
}

#[test]
fn a_round_body_that_may_slide_comes_out_the_same() {
    let scene = r#"
physics = "elasticity"
title = "half disc on a plane"
[[body]]
name = "disc"
shape = { half_disc = { radius = 1, centre = [0, 1], grading = 2 } }
elements = [16, 8]
subdomains = [2, 2]
traction = { top = [0, -0.005] }
[[obstacle]]
body = "disc"
side = "bottom"
plane = { point = [0, 0], normal = [0.28, 0.96] }
"#;
    // The load is along the normal: no force drives the disc down the slope.
    let scene = scene.replace("[0, -0.005]", "[-0.0014, -0.0048]");
    let report = compare("disc", &scene, &["--with", "bddc,gamg,hypre,mumps"]);
    check(&report);
    assert_eq!(report.supports, 1);
}

#[test]
fn rows_that_are_no_bounds_of_unknowns_are_left_to_ours_and_that_is_said() {
    // Two walls that meet in the corner of the block and differ by one degree.
    let scene = r#"
title = "wedge"
physics = "elasticity"
[[body]]
name = "block"
size = [1, 1]
elements = [8, 8]
subdomains = [2, 2]
dirichlet = { left = 0 }
load = [0.1, -0.1]
[[obstacle]]
body = "block"
side = "bottom"
plane = { point = [1.02, 0], normal = [-0.70, 0.714] }
[[obstacle]]
body = "block"
side = "right"
plane = { point = [1.02, 0], normal = [-0.714, 0.70] }
"#;
    let report = compare("wedge", scene, &["--with", "bddc,mumps"]);
    assert_eq!(report.facts.reference_residual, None);
    for r in &report.rows {
        if r.run.method == "fetifeti" {
            assert!(solved(r), "{r:?}");
            assert_eq!((r.run.residual, r.run.error), (None, None));
            continue;
        }
        let message = r.run.message.as_deref().expect("a message");
        assert!(message.contains("at (1, 0, 0)"), "{message}");
        assert_eq!(
            (r.run.error, r.run.iterations, r.run.converged),
            (None, None, false)
        );
    }
}
