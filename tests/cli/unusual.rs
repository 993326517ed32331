//! Unusual, but valid scenes: balanced loads, single subdomains, bodies without free nodes, no load at all.

use super::input::{two, GRID};
use crate::support::checks::identities;
use crate::support::session::with_session;
use crate::support::{direct, mpi, program};
use direct::{tight, Direct};
use mpi::Scratch;
use program::fetifeti;
use scene::Scene;

#[test]
fn a_balanced_load_on_loose_bodies_is_solved() {
    for subdomains in [1, 2] {
        let text = format!(
            "[grid]\nbodies = [2, 1]\nelements = [4, 8]\nsubdomains = {subdomains}\nload = \"if(x < 0.5, 1, -1)\"\n"
        );
        let scratch = Scratch::new("balanced");
        let scene = scratch.file("s.toml", &text);
        let out = fetifeti(&[
            "solve",
            &scene,
            "--json",
            "-",
            "-fetifeti_ksp_rtol",
            "1e-10",
        ]);
        assert_eq!(out.code, 0, "{}", out.all());
        let report: serde_json::Value = serde_json::from_str(&out.stdout).expect("JSON");
        assert_eq!(report["floating_bodies"], 2);
        // u depends on x alone, linear elements are nodally exact in one dimension: −½ ∫ u'², u' = min(x, 1 − x) up to
        // sign, and the energy lost to interpolation, h²/24 of ∫ f².
        let (h, energy) = (1.0f64 / 8.0, report["energy"].as_f64().expect("a number"));
        let exact = -0.5 * (1.0 / 12.0) + h * h / 24.0;
        assert!((energy - exact).abs() < 1e-10, "{energy} {exact}");
    }
}

/// The solution of the scene agrees with the direct solution.
fn solves(name: &'static str, text: impl Into<String>, multipliers: usize) {
    let text = text.into();
    with_session(move |session| {
        let direct = Direct::new(Scene::parse("s.toml", &text).expect(name));
        let mut solver = direct.solver(session, &tight());
        let facts = solver.facts();
        assert_eq!(
            facts.multipliers_local + facts.multipliers_active,
            multipliers,
            "{name}"
        );
        identities(&solver, 1e-10, name);
        let spectrum = solver.spectrum().expect("eigenvalues");
        assert_eq!(spectrum.is_some(), multipliers > 0, "{name}");
        assert!(
            spectrum.is_none_or(|s| s.lambda_min > 1.0 - 1e-8),
            "{name}: {spectrum:?}"
        );
        let solution = solver.solve().expect(name);
        assert!(solution.converged(), "{name}: {}", solution.status);
        let distance = direct.distance(&solution.u);
        println!("{name}: {} iterations, {distance:.1e}", solution.iterations);
        assert!(distance < 1e-10, "{name}: {distance:.1e}");
    });
}

#[test]
fn a_single_subdomain_needs_no_iteration() {
    solves(
        "plain",
        "[[body]]\nsize = 1\nelements = 8\nload = \"1 + x\"\ndirichlet = [\"left\"]\n",
        0,
    );
    // Two of them, apart.
    solves("two apart", two("3", 1, "dirichlet = [\"right\"]\n"), 0);
}

#[test]
fn a_body_without_free_nodes() {
    // 3 × 3 bodies of one element, the outer ones held: the middle one has four free corners, the corner bodies one.
    let ring = "[grid]\nbodies = 3\nelements = 1\nload = 1\ndirichlet = \"all\"\n";
    solves("3x3", ring, 4 * 6);
    // All nodes of `stamp` are prescribed, and so are the nodes of its right neighbour that are tied to it.
    let text = "[[body]]\nname = \"stamp\"\nsize = 1\nelements = 1\ndirichlet = { left = \"y\", right = 2 }\n\
                [[body]]\nname = \"right\"\norigin = [1, 0]\nsize = 1\nelements = [2, 1]\nload = 1\n\
                [[body]]\nname = \"lid\"\norigin = [0, 1]\nsize = [2, 1]\n\
                elements = [4, 2]\nsubdomains = 2\nload = -1\n\
                [[tie]]\nbodies = [\"stamp\", \"lid\"]\nwhere = \"none\"\n";
    let scene = Scene::parse("s.toml", text).expect("valid");
    assert_eq!(scene.subdomain(0).expect("assembled").k.n(), 0);
    with_session(move |session| {
        let direct = Direct::new(scene);
        let (solution, distance) = direct.run(session, &tight());
        assert!(solution.converged() && distance < 1e-10, "{distance:.1e}");
    });
}

#[test]
fn subdomains_of_one_element() {
    // Every node is a vertex: there are no multipliers inside bodies.
    let text = "[grid]\nbodies = 2\nelements = 2\nsubdomains = 2\nload = 1\ndirichlet = \"all\"\n";
    solves("2,2,1", text, 6 + 4);
    let text =
        "[grid]\nbodies = 3\nelements = 3\nsubdomains = 3\nload = \"x\"\ndirichlet = \"all\"\n";
    solves("3,3,1", text, 4 * 6 + 4 * 6);
}

#[test]
fn bodies_in_a_row() {
    // One end is held: all other bodies float, and the multipliers form a chain.
    let text = "[grid]\nbodies = [6, 1]\nsize = [6, 1]\nelements = 4\n\
                subdomains = 2\nload = 1\ndirichlet = [\"left\"]\n";
    // Inside each body, each half of two lines has one dual node; there are 5 faces of 5 nodes between bodies.
    let multipliers = 6 * 4 + 5 * 5;
    solves("row", text, multipliers);
    solves(
        "column",
        text.replace("[6, 1]", "[1, 6]").replace("left", "bottom"),
        multipliers,
    );
}

/// Loads on nodes that ties hold: u = 0, and rounding of it is no jump.
#[test]
fn a_load_that_moves_nothing() {
    let scratch = Scratch::new("held");
    let text =
        "[[body]]\nname = \"a\"\nsize = [0.7, 0.5]\nelements = [2, 1]\nsubdomains = [2, 1]\n\
                load = -1\ndirichlet = [\"bottom\"]\n\
                [[body]]\nname = \"b\"\norigin = [0, 0.5]\nsize = [0.7, 1]\nelements = [3, 1]\n\
                load = 1\ndirichlet = \"all\"\n[[tie]]\nbodies = [\"a\", \"b\"]\n";
    let out = fetifeti(&["solve", &scratch.file("s.toml", text), "--json", "-"]);
    assert_eq!(out.code, 0, "{}", out.all());
    let report: serde_json::Value = serde_json::from_str(&out.stdout).expect("JSON");
    let energy = report["energy"].as_f64().expect("a number");
    assert!(energy.abs() < 1e-20, "{energy}");
}

#[test]
fn no_load_at_all() {
    for dirichlet in ["\"all\"", "[\"left\"]"] {
        let scratch = Scratch::new("zero");
        let text = GRID.replace("load = 1\n", "").replace("\"all\"", dirichlet);
        let scene = scratch.file("s.toml", &text);
        let out = fetifeti(&[
            "solve",
            &scene,
            "--json",
            "-",
            "--out",
            &scratch.path("out"),
            "-fetifeti_spectrum",
        ]);
        assert_eq!(out.code, 0, "{}", out.all());
        let report: serde_json::Value = serde_json::from_str(&out.stdout).expect("JSON");
        assert_eq!(report["iterations"]["total"], 0);
        assert_eq!(report["energy"], 0.0);
        assert_eq!(report["kkt"]["stationarity"], 0.0);
        assert!(
            report["condition"]["exact"]["kappa"]
                .as_f64()
                .expect("a number")
                > 1.0
        );
        assert_eq!(scratch.files().len(), 4, "{:?}", scratch.files());
    }
}
