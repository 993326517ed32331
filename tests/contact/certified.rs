//! The guaranteed bounds of the error in the energy norm: never below the error, and close, on every example.

use std::path::PathBuf;

use crate::support::sample::{all_cases, sample};
use crate::support::session::with_session;
use fetifeti::settings::MethodSettings;
use fetifeti::{FetiFeti, Solution};
use petsc::Session;
use scene::Scene;

/// Scenes that take seconds.
const LARGE: [&str; 5] = [
    "speed_1024",
    "contact_grid_100",
    "bolted_flange",
    "hip_stem",
    "roller_bearing",
];

/// The examples that have a solution.
fn examples(large: bool) -> Vec<(String, Scene)> {
    let mut paths: Vec<PathBuf> = Vec::new();
    for folder in ["../../examples/scenes", "../../examples/gallery"] {
        let entries = std::fs::read_dir(folder).expect("a folder");
        paths.extend(entries.map(|entry| entry.expect("an entry").path()));
    }
    paths.sort();
    let toml = paths
        .into_iter()
        .filter(|p| p.extension().is_some_and(|e| e == "toml"));
    let named = toml.map(|p| {
        (
            p.file_stem()
                .expect("a name")
                .to_string_lossy()
                .into_owned(),
            p,
        )
    });
    let taken = named.filter(|(name, _)| name != "arch_falls" && LARGE.contains(&&**name) == large);
    taken
        .map(|(name, path)| (name, Scene::load(path).expect("a scene")))
        .collect()
}

fn solved(session: &Session, scene: &Scene, rtol: f64, certify: bool) -> (FetiFeti, Solution) {
    let problem = scene.substructures(&|_| true).expect("substructures");
    let settings = MethodSettings::default().rtol(rtol).certify(certify);
    let mut solver = FetiFeti::new(session, problem, settings).expect("set up");
    let solution = solver.solve().expect("an end");
    (solver, solution)
}

/// ‖u − v‖_K.
fn distance(solver: &FetiFeti, u: &[Vec<f64>], v: &[Vec<f64>]) -> f64 {
    let mut square = 0.0;
    for ((sub, u), v) in solver.problem().local.iter().zip(u).zip(v) {
        let apart: Vec<f64> = u.iter().zip(v).map(|(u, v)| u - v).collect();
        let mut force = vec![0.0; apart.len()];
        sub.k.mul(&apart, &mut force);
        square += force.iter().zip(&apart).map(|(f, u)| f * u).sum::<f64>();
    }
    square.max(0.0).sqrt()
}

/// The sample is every other example that takes no seconds.
#[test]
fn bounds_of_every_example_contain_the_error() {
    compare(sample(3, examples(false)).collect());
    if all_cases() {
        compare(examples(true));
    }
}

fn compare(scenes: Vec<(String, Scene)>) {
    with_session(move |session| {
        for (name, scene) in scenes {
            let (_, exact) = solved(session, &scene, 1e-13, true);
            let exact_error = exact.certified.expect("asked for").expect("a bound").most;
            for rtol in [1e-2, 1e-5] {
                let (solver, solution) = solved(session, &scene, rtol, true);
                let bound = solution.certified.expect("asked for");
                let error = distance(&solver, &solution.u, &exact.u);
                let bound = bound.unwrap_or_else(|why| panic!("{name} {rtol:e}: {}", why.text()));
                let (least, most) = (bound.least, bound.most);
                let what = format!(
                    "{name} at {rtol:e}: least {least:.2e}, error {error:.2e}, most {most:.2e}, {:.2} times",
                    most / error
                );
                println!("{what}");
                assert!(error - exact_error <= most, "{what}");
                assert!(least <= error + exact_error, "{what}");
                // Loose contact loops may end with a set of rows that is not quite the right one. An error below the
                // hundredfold of the exact solution's own is not known.
                let smooth = rtol < 1e-3 || solver.facts().inequalities == 0;
                if smooth && exact_error < 1e-2 * error {
                    assert!(most <= 3.0 * error, "{what}");
                }
            }
        }
    });
}
