//! Loads of nothing, and of nearly nothing: u = 0 is a solution, and residuals have no size of their own.

use crate::support::mpi::Scratch;
use crate::support::program::fetifeti;
use crate::support::session::with_session;
use fetifeti::settings::{ContactType, MethodSettings};
use fetifeti::{FetiFeti, Settings, Solution};
use petsc::Session;
use scene::Scene;

const KINDS: [ContactType; 3] = [
    ContactType::ActiveSet,
    ContactType::AugmentedLagrangian,
    ContactType::Smalbe,
];

fn solve(session: &Session, text: &str, kind: ContactType) -> Solution {
    let scene = Scene::parse("zero.toml", text).expect("a good scene");
    let problem = scene.substructures(&|_| true).expect("a good scene");
    let mut settings = Settings::from(MethodSettings::default());
    settings.contact.kind = kind;
    let mut solver = FetiFeti::new(session, problem, settings).expect("the set-up works");
    solver.solve().expect("there is a solution")
}

fn largest(solution: &Solution) -> f64 {
    let u = solution.u.iter().flatten();
    u.fold(0.0f64, |a, u| a.max(u.abs()))
}

/// Two boxes with a gap; the second one floats unless it is held.
fn boxes(load: f64, gap: f64, held: bool) -> String {
    let held = if held {
        "dirichlet = [\"right\"]\n"
    } else {
        ""
    };
    format!(
        "title = \"zero\"\n\
         [[body]]\nname = \"a\"\nsize = [1, 1]\nelements = 8\nsubdomains = [2, 2]\ndirichlet = [\"left\"]\n\
         load = {load:e}\n\
         [[body]]\nname = \"b\"\norigin = [1, 0]\nsize = [1, 1]\nelements = 8\nsubdomains = [2, 2]\n\
         load = {load:e}\n{held}\
         [[contact]]\nbodies = [\"a\", \"b\"]\ngap = {gap}\n"
    )
}

#[test]
fn bodies_without_load_stay() {
    with_session(|session| {
        for kind in KINDS {
            for load in [0.0, 1e-16, 1e-13] {
                for gap in [0.0, 0.1, 3.0] {
                    let what = format!("{kind:?}, load {load:e}, gap {gap}");
                    let solution = solve(session, &boxes(load, gap, true), kind);
                    assert!(solution.converged(), "{what}: {}", solution.status);
                    // A unit load moves them by less than one; rounding is relative to the gap.
                    let u = largest(&solution);
                    assert!(u <= load + 1e-12 * gap, "{what}: {u:e}");
                }
            }
        }
    });
}

#[test]
fn a_floating_body_without_load_may_stay_anywhere() {
    with_session(|session| {
        for kind in KINDS {
            for gap in [0.0, 0.1] {
                let solution = solve(session, &boxes(0.0, gap, false), kind);
                let what = format!("{kind:?}, gap {gap}");
                assert!(solution.converged(), "{what}: {}", solution.status);
                assert!(solution.energy.abs() < 1e-14, "{what}: {}", solution.energy);
                for row in solution.rows() {
                    assert!(row.gap <= 1e-9, "{what}: a row is violated by {}", row.gap);
                }
            }
        }
    });
}

#[test]
fn a_box_lies_loose_in_a_box() {
    let mut text = String::from(
        "title = \"loose\"\nphysics = \"elasticity\"\n\
         [[body]]\nname = \"a\"\nsize = [1, 1]\nelements = 8\nsubdomains = [2, 2]\n",
    );
    for (side, point, normal) in [
        ("bottom", "[0, -0.05]", "[0, 1]"),
        ("left", "[-0.05, 0]", "[1, 0]"),
        ("top", "[0, 1.05]", "[0, -1]"),
        ("right", "[1.05, 0]", "[-1, 0]"),
    ] {
        text += &format!(
            "[[obstacle]]\nbody = \"a\"\nside = \"{side}\"\n\
             plane = {{ point = {point}, normal = {normal} }}\n"
        );
    }
    with_session(move |session| {
        for kind in KINDS {
            let solution = solve(session, &text, kind);
            assert!(solution.converged(), "{kind:?}: {}", solution.status);
            assert!(
                solution.energy.abs() < 1e-14,
                "{kind:?}: {}",
                solution.energy
            );
        }
    });
}

#[test]
fn loads_may_return_to_zero() {
    let scratch = Scratch::new("zero-steps");
    for gap in [0.0, 0.01] {
        let text = boxes(1.0, gap, true) + "[steps]\ncount = 4\nload = \"sin(pi*t)\"\n";
        let scene = scratch.file("returns.toml", &text);
        for kind in KINDS {
            let method = kind.name();
            let out = fetifeti(&["solve", &scene, "--quiet", "-fetifeti_contact_type", method]);
            assert_eq!(out.code, 0, "gap {gap}, {method}: {}", out.all());
        }
    }
}
