//! `-fetifeti_local_solver` and `-fetifeti_local_ordering`: the answer does not depend on them, the report names them,
//! and mistakes get one sentence.

use crate::support::program;
use crate::support::session::with_session;
use fetifeti::feti::{LocalSolver, Ordering, Solver};
use fetifeti::{FetiFeti, MethodSettings};
use program::fetifeti;
use scene::Scene;
use serde_json::Value;

/// Bodies that float, in contact and tied; subdomains that touch no side.
const SCENES: [(&str, &str); 2] = [
    (
        "plane contact",
        include_str!("../../examples/scenes/contact_row_16.toml"),
    ),
    (
        "elastic solid",
        "dimension = 3\nphysics = \"elasticity\"\n\
         [grid]\nbodies = [2, 1, 1]\nsubdomains = [2, 2, 2]\nelements_per_subdomain = 3\n\
         dirichlet = [\"left\"]\npoisson = 0.3\nload = [1.0, -2.0, 0.5]\n",
    ),
];

#[test]
fn displacements_are_the_same_for_every_solver_and_order() {
    with_session(|session| {
        for (name, text) in SCENES {
            let scene = Scene::parse(name, text).unwrap_or_else(|e| panic!("{name}: {e}"));
            let solve = |local: LocalSolver| {
                let problem = scene.substructures(&|_| true).expect("substructures");
                let settings = MethodSettings {
                    local,
                    rtol: 1e-11,
                    // More threads than cores: orderings are computed on all of them.
                    threads: Some(4),
                    ..MethodSettings::default()
                };
                let solver = FetiFeti::new(session, problem, settings)
                    .unwrap_or_else(|e| panic!("{name}, {local:?}: {e}"));
                assert_eq!(solver.settings().method.local, local);
                let solution = solver.solve().expect("a solution");
                assert!(
                    solution.converged(),
                    "{name}, {local:?}: {}",
                    solution.status
                );
                solution.u.concat()
            };
            let ours = solve(LocalSolver::default());
            let size = ours.iter().fold(0.0f64, |s, v| s.max(v.abs()));
            for kind in Solver::ALL {
                for ordering in Ordering::ALL {
                    let u = solve(LocalSolver { kind, ordering });
                    let far = u.iter().zip(&ours).map(|(a, b)| (a - b).abs());
                    let far = far.fold(0.0, f64::max) / size;
                    assert!(far < 1e-8, "{name}, {kind:?}, {ordering:?}: {far:.1e}");
                }
            }
        }
    });
}

#[test]
fn the_report_names_solver_and_order() {
    let run = |more: &[&str]| -> Value {
        let scene = [
            "solve",
            "../../examples/scenes/poisson_2x2.toml",
            "--json",
            "-",
        ];
        let out = fetifeti(&[&scene, more].concat());
        assert_eq!(out.code, 0, "{}", out.all());
        serde_json::from_str(&out.stdout).expect("a report")
    };
    let ours = run(&[]);
    assert_eq!(ours["local_solver"], "multifrontal");
    assert_eq!(ours["local_ordering"], "nd");
    let energy = |r: &Value| r["energy"].as_f64().expect("a number");
    for (solver, ordering) in [
        ("faer", "amd"),
        ("faer", "metis"),
        ("multifrontal", "scotch"),
    ] {
        let options = [
            "-fetifeti_local_solver",
            solver,
            "-fetifeti_local_ordering",
            ordering,
        ];
        let found = run(&options);
        assert_eq!(found["local_solver"], solver);
        assert_eq!(found["local_ordering"], ordering);
        assert_eq!(found["iterations"]["total"], ours["iterations"]["total"]);
        assert!((energy(&found) / energy(&ours) - 1.0).abs() < 1e-8);
    }
}

#[test]
fn a_name_that_there_is_not_gets_one_sentence() {
    for (option, name, there) in [
        ("-fetifeti_local_solver", "pardiso", "faer"),
        ("-fetifeti_local_solver", "mumps", "not there any more"),
        ("-fetifeti_local_ordering", "rcm", "scotch"),
    ] {
        let out = fetifeti(&[
            "solve",
            "../../examples/scenes/poisson_2x2.toml",
            option,
            name,
        ]);
        assert_eq!(out.code, 2, "{}", out.all());
        let said = out.stderr.trim();
        assert_eq!(said.lines().count(), 1, "{}", out.all());
        for part in [option, name, there] {
            assert!(said.contains(part), "{part}: {}", out.all());
        }
    }
}
