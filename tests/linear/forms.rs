//! The storage of operators does not change the answer: dense or sparse, shared between equal subdomains, kept from
//! load to load.

use crate::support::checks::identities;
use crate::support::direct::{tight, Direct};
use crate::support::session::with_session;
use crate::support::{mpi, program};
use fetifeti::settings::{Adaptive, MethodSettings, Operators, PcType};
use fetifeti::{FetiFeti, Solution};
use mpi::Scratch;
use petsc::Session;
use program::run_fetifeti;
use scene::Scene;
use serde_json::Value;

/// Two blocks of eight subdomains each, one on the other, under an oblique load.
const SOLID: &str =
    "dimension = 3\nphysics = \"elasticity\"\n[grid]\nbodies = [1, 2, 1]\nsubdomains = [2, 2, 2]\n\
                     elements_per_subdomain = 4\nyoung = [[[1], [5]]]\npoisson = 0.3\n\
                     load = [\"0.3*y\", -1, 0.1]\ndirichlet = [\"bottom\"]\n";

fn solver(session: &Session, text: &str, settings: MethodSettings) -> FetiFeti {
    let scene = Scene::parse("scene.toml", text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let problem = scene.substructures(&|_| true).expect("substructures");
    let settings = settings.rtol(1e-10);
    FetiFeti::new(session, problem, settings).expect("set up")
}

/// The largest difference relative to the largest displacement.
fn far(a: &Solution, b: &Solution) -> f64 {
    let pairs = a.u.iter().flatten().zip(b.u.iter().flatten());
    let size = a.u.iter().flatten().fold(0.0f64, |s, u| s.max(u.abs()));
    pairs.fold(0.0f64, |d, (a, b)| d.max((a - b).abs())) / size
}

#[test]
fn sparse_solves_give_what_dense_operators_give() {
    with_session(|session| {
        for pc in [PcType::Dirichlet, PcType::CoarseCorrected] {
            let make = |operators| {
                let settings = MethodSettings::default().operators(operators).pc_type(pc);
                solver(session, SOLID, settings)
            };
            let (mut dense, mut sparse) = (make(Operators::Explicit), make(Operators::Implicit));
            assert_eq!(dense.facts().implicit_kinds, 0);
            assert_eq!(sparse.facts().implicit_kinds, sparse.facts().kinds);
            identities(&sparse, 1e-10, &format!("{pc:?}"));
            let (a, b) = (
                dense.solve().expect("solved"),
                sparse.solve().expect("solved"),
            );
            assert!(a.converged() && b.converged());
            assert!(a.iterations.abs_diff(b.iterations) <= 1);
            assert!(far(&a, &b) < 1e-8, "{pc:?}: {:.1e}", far(&a, &b));
        }
    });
}

#[test]
fn memory_bounds_dense_operators() {
    with_session(|session| {
        let bounded = |memory| {
            let settings = MethodSettings::default()
                .memory(memory)
                .pc_type(PcType::Dirichlet);
            solver(session, SOLID, settings)
        };
        let (mut all, mut few) = (bounded(1000), bounded(1));
        assert!(few.facts().implicit_kinds > all.facts().implicit_kinds);
        assert!(few.facts().dense_bytes < all.facts().dense_bytes);
        let (a, b) = (all.solve().expect("solved"), few.solve().expect("solved"));
        assert!(far(&a, &b) < 1e-8);
    });
}

#[test]
fn subdomains_that_are_multiples_of_each_other_share_their_factors() {
    with_session(|session| {
        let text = |rho: &str| {
            format!(
                "[grid]\nbodies = 3\nsubdomains = 3\nelements_per_subdomain = 5\n\
                     load = \"1 + x\"\ndirichlet = \"all\"\n{rho}"
            )
        };
        let plain = solver(session, &text(""), MethodSettings::default());
        // Checkerboards of 1/3 by body.
        let rho = "rho = [[1, 0.3333333333333333, 1], [1e4, 7, 1e4], [1, 0.3333333333333333, 1]]\n";
        let mut jumps = solver(session, &text(rho), MethodSettings::default());
        assert_eq!(plain.facts().kinds, jumps.facts().kinds);
        // The certificate uses the matrices themselves.
        let solution = jumps.solve().expect("solved");
        assert!(solution.converged());
        assert!(solution.kkt.stationarity < 1e-8, "{:?}", solution.kkt);
    });
}

#[test]
fn adaptive_constraints_fit_subdomains_that_share_a_matrix_up_to_a_factor() {
    with_session(|session| {
        let threes = "[grid]\nbodies = 2\nsubdomains = 3\nelements_per_subdomain = 4\n\
                      load = \"1 + x\"\ndirichlet = [\"left\", \"top\"]\n\
                      rho = { checkerboard = [1, 3], by = \"subdomain\" }\n";
        let threes = Direct::new(Scene::parse("threes.toml", threes).expect("a scene"));
        let cases = [
            ("rho of 1 and 3", threes, 1e-9),
            ("unequal bodies", Direct::example("unequal_bodies"), 1e-9),
            ("jumps of 1e4", Direct::example("jump_checkerboard"), 1e-8),
            ("random", Direct::example("coefficients_random"), 1e-8),
            ("jumps of 1e6", Direct::example("jump_1e6"), 1e-8),
        ];
        for (what, direct, far) in cases {
            for operators in [Operators::Explicit, Operators::Implicit] {
                let settings = tight().operators(operators).adaptive(Adaptive::Below(2.0));
                let mut solver = direct.solver(session, &settings);
                let added: usize = solver.facts().adaptive_constraints.iter().sum();
                assert!(added > 0, "{what}: no constraint was added");
                let solution = solver.solve().expect("solved");
                let distance = direct.distance(&solution.u);
                println!("{what}, {operators:?}: {distance:.1e}, {added} constraints");
                assert!(solution.converged(), "{what}: {}", solution.status);
                assert!(distance < far, "{what}, {operators:?}: {distance:.1e}");
            }
        }
    });
}

#[test]
fn directions_are_kept_from_load_to_load() {
    with_session(|session| {
        let text = "[grid]\nbodies = 3\nsubdomains = 3\nelements_per_subdomain = 6\n\
                    load = \"1 + x\"\ndirichlet = [\"left\"]\n";
        let make = |recycle| {
            let settings = MethodSettings::default().recycle(recycle);
            solver(session, text, settings)
        };
        let (mut kept, mut fresh) = (make(60), make(0));
        let first = kept.solve().expect("solved");
        let plain = fresh.solve().expect("solved");
        // The few further iterations for the last digits start from the residual of the first ones.
        assert!(first.iterations.abs_diff(plain.iterations) <= 2);
        let loads = |factor: &dyn Fn(usize) -> f64| -> Vec<Vec<f64>> {
            let local = fresh.problem().local.iter();
            let of = |s: &fetifeti::Subdomain| {
                let terms = s.f.iter().zip(&s.dofs);
                terms.map(|(f, &dof)| f * factor(dof as usize)).collect()
            };
            local.map(of).collect()
        };
        let (twice, other) = (loads(&|_| 2.0), loads(&|dof| 1.0 + 0.1 * (dof % 7) as f64));
        kept.set_loads(twice, &vec![0.0; kept.problem().rows.len()]);
        let second = kept.solve().expect("solved");
        assert!(second.iterations <= 3, "{} iterations", second.iterations);
        kept.set_loads(other.clone(), &vec![0.0; kept.problem().rows.len()]);
        fresh.set_loads(other, &vec![0.0; fresh.problem().rows.len()]);
        let (a, b) = (
            kept.solve().expect("solved"),
            fresh.solve().expect("solved"),
        );
        assert!(
            a.converged() && a.iterations <= b.iterations,
            "{} {}",
            a.iterations,
            b.iterations
        );
        assert!(far(&a, &b) < 1e-8, "{:.1e}", far(&a, &b));
    });
}

/// A loose solve is part of another iteration, for which it has to be the same map again and again: once there are
/// enough directions, a load has the same answer whatever has been solved in between.
#[test]
fn loose_solves_do_not_depend_on_the_loads_before() {
    with_session(|session| {
        let text = "[grid]\nbodies = 3\nsubdomains = 3\nelements_per_subdomain = 6\n\
                    load = \"1 + x\"\ndirichlet = [\"left\"]\n";
        let again = |rtol: f64| {
            let mut solver = solver(session, text, MethodSettings::default().recycle(3));
            let ksp = solver.ksp();
            ksp.set_tolerances(Some(rtol), None, None, None)
                .expect("set");
            let rows = vec![0.0; solver.problem().rows.len()];
            let load = |step: usize| {
                let local = solver.problem().local.iter();
                let of = |s: &fetifeti::Subdomain| -> Vec<f64> {
                    let factor = |&dof: &u64| ((dof as usize * (step + 3)) % 7) as f64 - 2.5;
                    s.f.iter()
                        .zip(&s.dofs)
                        .map(|(f, d)| f * factor(d))
                        .collect()
                };
                (local.map(of).collect::<Vec<_>>(), rows.clone())
            };
            let loads = [load(0), load(1), load(2), load(1)];
            let found = loads.map(|(f, gaps)| {
                solver.set_loads(f, &gaps);
                solver.solve().expect("solved")
            });
            assert!(found.iter().all(|s| s.converged() && s.iterations > 0));
            assert!(found[0].iterations >= 3, "{}", found[0].iterations);
            far(&found[1], &found[3])
        };
        assert_eq!(again(1e-3), 0.0);
        // Where the next load is another one of the same kind, recent directions serve it better.
        assert!(again(1e-8) > 0.0);
    });
}

#[test]
fn sparse_solves_on_ranks() {
    let scratch = Scratch::new("operators_forms");
    let scene = scratch.file("solid.toml", SOLID);
    let solve = |ranks: usize, more: &[&str]| -> Value {
        let args = [
            "solve",
            &scene,
            "--json",
            "-",
            "-fetifeti_ksp_rtol",
            "1e-10",
        ];
        let out = run_fetifeti(ranks, &[&args[..], more].concat());
        assert_eq!(out.code, 0, "{ranks} ranks: {}", out.all());
        serde_json::from_str(&out.stdout).unwrap_or_else(|e| panic!("{e}: {}", out.all()))
    };
    let number = |v: &Value| v.as_f64().expect("a number");
    let dense = solve(1, &["-fetifeti_operators", "explicit"]);
    assert_eq!(dense["operators"]["sparse"], 0);
    for ranks in [1, 2, 4] {
        let sparse = solve(ranks, &["-fetifeti_operators", "implicit"]);
        assert_eq!(sparse["operators"]["sparse"], sparse["operators"]["kinds"]);
        let (a, b) = (number(&dense["energy"]), number(&sparse["energy"]));
        assert!((a - b).abs() < 1e-9 * a.abs(), "{ranks} ranks: {a} {b}");
    }
    let mixed = solve(
        2,
        &[
            "-fetifeti_operators",
            "explicit",
            "-fetifeti_precision",
            "mixed",
        ],
    );
    assert_eq!(mixed["operators"]["single"], 16);
    let (a, b) = (number(&dense["energy"]), number(&mixed["energy"]));
    assert!((a - b).abs() < 1e-9 * a.abs(), "mixed: {a} {b}");
    // Other local solvers and copies of the factor of GᵀQG are not there any more; the names of our solver still are.
    for (option, value, code) in [
        ("-fetifeti_local_solver", "faer", 2),
        ("-fetifeti_local_ordering", "scotch", 2),
        ("-fetifeti_local_ordering", "nd", 0),
        ("-fetifeti_gtg_redundancy", "2", 2),
    ] {
        let out = run_fetifeti(1, &["solve", &scene, option, value]);
        assert_eq!(out.code, code, "{}", out.all());
        let said = out.all();
        assert!(
            code == 0 || said.contains(option) && said.contains("not there any more"),
            "{said}"
        );
    }
}
