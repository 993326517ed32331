//! The model problem (3.1)-(3.3) against values of an independent computation (tests/data/model_contact.json).

use crate::support::checks::number;
use crate::support::sample::all_cases;
use crate::support::session::with_session;
use crate::support::{mpi, program};
use fetifeti::settings::{ContactSettings, ContactType, MethodSettings};
use fetifeti::solution::RowState;
use fetifeti::{FetiFeti, Settings, Solution};
use mpi::Scratch;
use petsc::Session;
use program::run_fetifeti;
use scene::Scene;
use serde_json::Value;

fn oracle() -> Vec<Value> {
    serde_json::from_str(include_str!("../data/model_contact.json")).expect("the oracle is JSON")
}

/// Two bodies of `elements`² elements and `subdomains`² subdomains.
fn model(elements: u64, subdomains: usize) -> String {
    let body = |name: &str, x: usize, y: &str, value: i32| {
        format!(
            "[[body]]\nname = \"{name}\"\norigin = [{x}, 0]\nsize = 1\n\
             elements = {elements}\nsubdomains = {subdomains}\n\
             load = [{{ y = {y}, value = {value} }}]\n"
        )
    };
    format!(
        "{}dirichlet = [\"left\"]\n{}[[contact]]\nbodies = [\"left\", \"right\"]\n",
        body("left", 0, "[0.75, 1]", -3),
        body("right", 1, "[0, 0.25]", -1)
    )
}

const METHODS: [&str; 3] = ["active_set", "augmented_lagrangian", "smalbe"];

/// The subdomain grids that fit the mesh.
fn grids(elements: u64) -> Vec<usize> {
    let fits = |s: &usize| elements % (*s as u64) == 0;
    [1, 2, 4, 8].into_iter().filter(fits).collect()
}

/// Every mesh, grid and method by the program, each of them on one number of ranks; every mesh and grid is on each
/// number, with another method. The sample is every other run.
#[test]
fn by_the_program_on_one_two_and_four_ranks() {
    let scratch = Scratch::new("oracle");
    let mut runs = 0;
    for row in oracle() {
        let n = row["elements_per_side"].as_u64().expect("a count");
        for s in grids(n) {
            let scene = scratch.file("model.toml", &model(n, s));
            for (k, method) in METHODS.into_iter().enumerate() {
                let ranks = [1, 2, 4][(k + runs / METHODS.len()) % 3];
                runs += 1;
                if runs % 2 == 0 && !all_cases() {
                    continue;
                }
                let what = format!("{n} elements, {s}x{s} subdomains, {ranks} ranks, {method}");
                let args = [
                    "solve",
                    &scene,
                    "--json",
                    "-",
                    "-fetifeti_contact_type",
                    method,
                    "-fetifeti_ksp_rtol",
                    "1e-10",
                ];
                let out = run_fetifeti(ranks, &args);
                assert_eq!(out.code, 0, "{what}: {}", out.all());
                let report: Value = serde_json::from_str(&out.stdout).expect("JSON");
                let (energy, wanted) = (number(&report["energy"]), number(&row["energy"]));
                assert!((energy - wanted).abs() < 1e-9, "{what}: {energy}");
                let contact = &report["contact"];
                assert_eq!(contact["active"], row["active_nodes"], "{what}");
                assert_eq!(
                    report["multipliers"]["active"], row["active_nodes"],
                    "{what}"
                );
                let force = number(&contact["interfaces"][0]["force"]);
                let wanted = number(&row["contact_force"]);
                assert!((force - wanted).abs() < 1e-9, "{what}: {force}");
                let kkt = &report["kkt"];
                for key in ["stationarity", "feasibility", "complementarity"] {
                    assert!(number(&kkt[key]) < 1e-8, "{what}: {kkt}");
                }
                assert!(number(&kkt["min_multiplier"]) > -1e-12, "{what}: {kkt}");
                for body in contact["bodies"].as_array().expect("a list") {
                    // Reactions are those of K u.
                    assert!(number(&body["imbalance"]) < 1e-10, "{what}: {body}");
                }
                assert_eq!(
                    contact["factorisations"], contact["distinct_subdomains"],
                    "{what}: nothing is factored twice"
                );
            }
        }
    }
    assert_eq!(runs, 36);
}

fn solve(session: &Session, scene: &Scene, kind: ContactType, rtol: f64) -> (FetiFeti, Solution) {
    let problem = scene.substructures(&|_| true).expect("a good scene");
    let settings = Settings::from(MethodSettings::default().rtol(rtol))
        .contact(ContactSettings::default().kind(kind));
    let mut solver = FetiFeti::new(session, problem, settings).expect("the set-up works");
    let solution = solver.solve().expect("the problem can be solved");
    (solver, solution)
}

/// Active nodes and displacements, also at the default tolerance.
#[test]
fn sets_and_displacements() {
    with_session(|session| {
        for row in oracle() {
            let n = row["elements_per_side"].as_u64().expect("a count");
            for (s, method, rtol) in [
                (2, ContactType::ActiveSet, 1e-6),
                (2, ContactType::Smalbe, 1e-6),
                (2, ContactType::AugmentedLagrangian, 1e-6),
                (4, ContactType::ActiveSet, 1e-11),
                (4, ContactType::AugmentedLagrangian, 1e-11),
                (4, ContactType::Smalbe, 1e-11),
            ] {
                let what = format!(
                    "{n} elements, {s}x{s} subdomains, {}, rtol {rtol}",
                    method.name()
                );
                let scene = Scene::parse("model.toml", &model(n, s)).expect("a good scene");
                let (solver, solution) = solve(session, &scene, method, rtol);
                assert!(solution.converged(), "{what}");
                let rows = solution.rows();
                let node = |t: f64| (t * n as f64).round() as u64;
                let mut touching: Vec<u64> = rows
                    .iter()
                    .filter(|r| r.state == RowState::Holds)
                    .map(|r| node(r.label.t[0]))
                    .collect();
                touching.sort_unstable();
                let last = row["last_active"].as_u64().expect("a count");
                let wanted: Vec<u64> = (0..=last).collect();
                assert_eq!(touching, wanted, "{what}");
                let energy = solution.energy - number(&row["energy"]);
                assert!(energy.abs() < 1e-9, "{what}: {energy}");

                // Every node once, including the prescribed ones.
                let mut nodal = std::collections::BTreeMap::new();
                for (sub, u) in solver.problem().local.iter().zip(&solution.u) {
                    for (&dof, &u) in sub.dofs.iter().zip(u) {
                        nodal.insert(dof, u);
                    }
                }
                let tolerance = if rtol < 1e-9 { 1e-9 } else { 1e-5 };
                let least = nodal.values().fold(0.0f64, |a, &u| a.min(u));
                let wanted = number(&row["min_u"]);
                assert!((least - wanted).abs() < tolerance, "{what}: {least}");
                let right = nodal.range(scene.bodies[1].first_dof..).map(|(_, u)| u);
                let count = (n + 1) * (n + 1);
                assert_eq!(right.clone().count() as u64, count);
                let mean = right.sum::<f64>() / count as f64;
                let wanted = number(&row["mean_nodal_u2"]);
                assert!((mean - wanted).abs() < tolerance, "{what}: {mean}");
            }
        }
    });
}
