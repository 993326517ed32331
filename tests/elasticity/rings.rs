//! Axisymmetric bodies against exact solutions: patches, Lamé's tube and sphere, a ring shrunk onto a shaft.

use super::patch::errors;
use crate::support::session::with_session;
use fetifeti::settings::MethodSettings;
use fetifeti::FetiFeti;
use petsc::Session;
use scene::Scene;
use std::f64::consts::PI;

const RING: &str = "physics = \"elasticity\"\nplane = \"axisymmetric\"\norder = 2\n";

/// A box of r and y in n × n cells and 2 × 2 subdomains.
fn body(name: &str, place: &str, n: usize, rest: &str) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\n{place}\nelements = {n}\nsubdomains = 2\nyoung = 50\npoisson = 0.3\n{rest}\n"
    )
}

/// The orders with which the norms L² and energy of the error fall from 4 × 4 cells to 8 × 8.
fn orders(session: &Session, scene: impl Fn(usize) -> String) -> [f64; 2] {
    let [coarse, fine] = [4, 8].map(|n| errors(session, &scene(n), 1e-12));
    [coarse.l2 / fine.l2, coarse.energy / fine.energy].map(f64::log2)
}

#[test]
fn linear_displacements_are_exact_across_ties() {
    // A body with the axis, and one around it; both are distorted.
    let exact = "[\"0.2*x\", \"0.1 - 0.3*y\"]";
    let held = format!("dirichlet = {{ bottom = {exact}, top = {exact} }}");
    let outer = format!("dirichlet = {{ right = {exact}, bottom = {exact}, top = {exact} }}");
    let shape = "size = 1\nshape = { x = \"x + 0.1*x*y\", y = \"y + 0.05*sin(3*x)\" }";
    let text = format!(
        "{RING}exact = {exact}\n{}{}",
        body("inner", shape, 4, &held),
        body("outer", &format!("origin = [1, 0]\n{shape}"), 4, &outer)
    );
    with_session(move |session| {
        let found = errors(session, &text, 1e-12);
        assert!(found.l2 < 1e-10 && found.energy < 1e-9, "{found:?}");
    });
}

#[test]
fn a_floating_ring_under_pressure_is_exact_across_contact() {
    // E = 50 and pressure 5: ε_y = −0.1, ε_r = 0.03. Nothing but the contact holds the upper ring.
    for origin in ["0", "0.7"] {
        let exact = "exact = [\"0.03*x\", \"-0.1*y\"]";
        let at = |y: f64| format!("origin = [{origin}, {y}]\nsize = 1");
        let text = format!(
            "{RING}{exact}\n{}{}[[contact]]\nbodies = \"all\"\n",
            body("lower", &at(0.0), 4, "dirichlet = { bottom = { y = 0 } }"),
            body("upper", &at(1.0), 4, "pressure = { top = 5 }")
        );
        with_session(move |session| {
            let found = errors(session, &text, 1e-12);
            assert!(found.l2 < 1e-9 && found.energy < 1e-8, "{found:?}");
        });
    }
}

/// Lamé's tube, 1 ≤ r ≤ 2, pressure 3 from inside, no strain along the axis.
fn tube(n: usize) -> String {
    let (a, b) = (1.3 * 0.4 / 50.0, 1.3 * 4.0 / 50.0);
    let held = "pressure = { left = 3 }\ndirichlet = { bottom = { y = 0 }, top = { y = 0 } }";
    format!(
        "{RING}exact = [\"{a}*x + {b}/x\", \"0\"]\n{}",
        body("tube", "origin = [1, 0]\nsize = 1", n, held)
    )
}

/// Lamé's sphere, 1 ≤ R ≤ 2, pressure 7 from inside; with `cut` it is two shells in contact at R = 1.5.
fn sphere(n: usize, cut: bool) -> String {
    let (a, b) = (0.4 / 50.0, 8.0 * 1.3 / 100.0);
    let factor = format!("({a} + {b}/(x^2 + y^2)^1.5)");
    let exact = format!("exact = [\"{factor}*x\", \"{factor}*y\"]");
    let shape = "shape = { x = \"x*cos(y)\", y = \"x*sin(y)\" }";
    let at =
        |from: f64, size: f64| format!("origin = [{from}, 0]\nsize = [{size}, \"pi/2\"]\n{shape}");
    let half = "dirichlet = { bottom = { y = 0 } }";
    let pressed = format!("pressure = {{ left = 7 }}\n{half}");
    if cut {
        format!(
            "{RING}{exact}\n{}{}[[contact]]\nbodies = \"all\"\n",
            body("inner", &at(1.0, 0.5), n, &pressed),
            body("outer", &at(1.5, 0.5), n, half)
        )
    } else {
        format!(
            "{RING}{exact}\n{}",
            body("sphere", &at(1.0, 1.0), n, &pressed)
        )
    }
}

#[test]
fn tubes_and_spheres_under_pressure_converge_with_order_three() {
    with_session(|session| {
        let whole = |n| sphere(n, false);
        let shells = |n| sphere(n, true);
        let all: [(&str, [f64; 2]); 3] = [
            ("tube", orders(session, tube)),
            ("sphere", orders(session, whole)),
            ("shells", orders(session, shells)),
        ];
        for (what, [l2, energy]) in all {
            println!("{what}: {l2:.2}, {energy:.2}");
            assert!((2.7..4.5).contains(&l2), "{what}: {l2:.2}");
            assert!((1.8..3.5).contains(&energy), "{what}: {energy:.2}");
        }
    });
}

#[test]
fn a_ring_shrunk_onto_a_shaft_has_the_pressure_of_lame() {
    let text = |n: usize| {
        let free = "dirichlet = { bottom = { y = 0 } }";
        format!(
            "{RING}{}{}[[contact]]\nbodies = \"all\"\ngap = -0.01\n",
            body("shaft", "size = 1", n, free),
            body("ring", "origin = [1, 0]\nsize = 1", n, free)
        )
    };
    // p (5/3 + ν + 1 − ν)/E = δ at radius 1, with plane stress in both.
    let pressure = 0.01 * 50.0 / (8.0 / 3.0);
    with_session(move |session| {
        let far = [4, 8].map(|n| {
            let scene = Scene::parse("fit.toml", &text(n)).expect("a scene");
            let problem = scene.substructures(&|_| true).expect("substructures");
            let settings = MethodSettings::default().rtol(1e-10);
            let mut solver = FetiFeti::new(session, problem, settings).expect("set up");
            let solution = solver.solve().expect("solved");
            let rows = solution.rows();
            assert_eq!(rows.len(), 2 * n + 1);
            let area: f64 = rows.iter().map(|r| r.label.area).sum();
            assert!((area / (2.0 * PI) - 1.0).abs() < 1e-12, "{area}");
            let force: f64 = rows.iter().map(|r| r.multiplier).sum();
            let found = rows.iter().map(|r| r.pressure().expect("a pressure"));
            let largest = found.fold(0.0, |m: f64, p| m.max((p / pressure - 1.0).abs()));
            println!("{n}: {:.2e} {largest:.2e}", force / area / pressure - 1.0);
            largest.max((force / area / pressure - 1.0).abs())
        });
        assert!(far[0] < 1e-2 && far[1] < 0.3 * far[0], "{far:?}");
    });
}

#[test]
fn what_is_no_ring_is_refused() {
    let refuses = |text: String, part: &str| {
        let error = Scene::parse("scene.toml", &text)
            .expect_err(part)
            .to_string();
        assert!(error.contains(part), "{error}");
    };
    let left = body("b", "origin = [-0.5, 0]\nsize = 1", 4, "");
    refuses(format!("{RING}{left}"), "left of the axis x = 0");
    let first = RING.replace("order = 2\n", "");
    let right = body("b", "size = 1", 4, "");
    refuses(format!("{first}{right}"), "a box of first order");
    let torn = body("b", "size = 1", 4, "dirichlet = { left = { x = 0.1 } }");
    refuses(format!("{RING}{torn}"), "equal values were expected");
    refuses(
        format!("dimension = 3\n{RING}{right}"),
        "`plane` outside plane elasticity",
    );
}
