//! Deflation of eigenvalues above τ, which arise from coefficients that jump inside bodies: exact spectra, solutions,
//! ranks.

use crate::support::session::with_session;
use crate::support::{direct, mpi, program, rng};
use direct::Direct;
use fetifeti::settings::{Adaptive, MethodSettings};
use fetifeti::FetiFeti;
use petsc::Session;
use rng::Rng;
use scene::Scene;

/// n × n bodies of n_s × n_s subdomains of 4 × 4 elements, held on the left, ρ of a subdomain at random between
/// 10^−decades and 10^decades.
fn by_subdomain(n: usize, ns: usize, decades: f64, seed: u64) -> String {
    let mut rng = Rng::new(seed);
    let mut text = String::new();
    for j in 0..n {
        for i in 0..n {
            let row = |rng: &mut Rng| {
                let value = |rng: &mut Rng| 10f64.powf(rng.uniform(-decades, decades));
                let row: Vec<String> = (0..ns).map(|_| format!("{:e}", value(rng))).collect();
                format!("[{}]", row.join(", "))
            };
            let rows: Vec<String> = (0..ns).map(|_| row(&mut rng)).collect();
            text += &format!(
                "[[body]]\nname = \"b{i}_{j}\"\norigin = [\"{i}/{n}\", \"{j}/{n}\"]\nsize = [\"1/{n}\", \"1/{n}\"]\n\
                 subdomains = {ns}\nelements_per_subdomain = 4\nload = 1\nrho = [{}]\n",
                rows.join(", ")
            );
            if i == 0 {
                text += "dirichlet = { left = 0 }\n";
            }
        }
    }
    text
}

/// A stiff cross in every body, and bars from body to body that do not follow subdomains.
fn channels(physics: &str) -> String {
    let what = match physics {
        "elasticity" => "young",
        _ => "rho",
    };
    let load = match physics {
        "elasticity" => "[0, -1]",
        _ => "1",
    };
    format!(
        "physics = \"{physics}\"\n[grid]\nbodies = [3, 2]\nsize = [3, 2]\n\
         subdomains = 3\nelements_per_subdomain = 4\nload = {load}\n\
         dirichlet = [\"left\"]\n[grid.{what}]\ndefault = 1\nregions = [\n\
         {{ x = [0.1, 2.9], y = [\"1/12\", \"2/12\"], value = 1e6 }},\n\
         {{ x = [0.4, 2.6], y = [\"7/12\", \"8/12\"], value = 1e6 }},\n\
         {{ x = [\"19/12\", \"20/12\"], y = [0.3, 1.9], value = 1e6 }}]\n"
    )
}

fn below(tau: f64) -> MethodSettings {
    MethodSettings::default()
        .adaptive(Adaptive::Below(tau))
        .rtol(1e-10)
}

fn scene(text: &str) -> Scene {
    Scene::parse("scene.toml", text).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn solver(session: &Session, scene: &Scene, settings: MethodSettings) -> FetiFeti {
    let problem = scene.substructures(&|_| true).expect("substructures");
    FetiFeti::new(session, problem, settings).expect("set up")
}

/// κ ≤ 1.5 τ and λ_min ≥ 1 for all thresholds; returns the numbers of vectors.
fn bounded(session: &Session, what: &str, scene: &Scene, taus: &[f64]) -> Vec<usize> {
    let each = taus.iter().map(|&tau| {
        let mut solver = solver(session, scene, below(tau));
        let s = solver
            .spectrum()
            .expect("eigenvalues")
            .expect("multipliers");
        let cost = solver.deflated().expect("a search");
        let n = cost.vectors.iter().sum::<usize>() + cost.shared;
        println!(
            "{what}, tau {tau}: {n} vectors, {s:?}, largest {:.2e}",
            cost.largest
        );
        assert!(s.kappa() <= 1.5 * tau, "{what}, tau {tau}: {s:?}");
        assert!(s.lambda_min >= 1.0 - 1e-6, "{what}, tau {tau}: {s:?}");
        assert!(cost.capped.is_empty(), "{what}, tau {tau}: {cost:?}");
        n
    });
    each.collect()
}

#[test]
fn jumps_between_subdomains() {
    with_session(|session| {
        for (n, decades, seed) in [(3, 3.0, 1), (3, 6.0, 2), (4, 6.0, 3)] {
            let scene = scene(&by_subdomain(n, 4, decades, seed));
            let what = format!("{n} x {n}, 10^{decades}");
            let counts = bounded(session, &what, &scene, &[5.0, 10.0, 50.0]);
            assert!(
                counts[0] >= counts[1] && counts[1] >= counts[2],
                "{counts:?}"
            );
            assert!(counts[1] > 0 && counts[1] <= 6 * n * n, "{counts:?}");
        }
    });
}

#[test]
fn the_answer_is_the_direct_one() {
    with_session(|session| {
        for decades in [3.0, 6.0] {
            let direct = Direct::new(scene(&by_subdomain(3, 4, decades, 7)));
            let (with, distance) = direct.run(session, &below(10.0));
            let off = below(10.0).adaptive(Adaptive::Off);
            let (without, other) = direct.run(session, &off);
            println!(
                "10^{decades}: {distance:.1e} in {} iterations, without {other:.1e} in {}",
                with.iterations, without.iterations
            );
            assert!(with.converged() && without.converged());
            assert!(distance < 1e-6, "{distance:.1e}");
        }
    });
}

#[test]
fn channels_across_subdomains_and_bodies() {
    with_session(|session| {
        for physics in ["scalar", "elasticity"] {
            let scene = scene(&channels(physics));
            bounded(session, physics, &scene, &[10.0, 50.0]);
        }
    });
}

#[test]
fn nothing_is_deflated_where_coefficients_are_constant() {
    with_session(|session| {
        let scene = Scene::load("../../examples/scenes/lee_column_1.toml").expect("a scene");
        let mut solver = solver(session, &scene, MethodSettings::default());
        assert!(solver.solve().expect("solved").converged());
        assert!(solver.deflated().is_none());
    });
}

#[test]
fn the_cap_is_kept_and_said() {
    with_session(|session| {
        let scene = scene(&by_subdomain(3, 4, 6.0, 2));
        let settings = below(2.0).adaptive_max(1);
        let mut solver = solver(session, &scene, settings);
        solver.deflate().expect("a search");
        let cost = solver.deflated().expect("a search");
        assert!(cost.vectors.iter().all(|n| *n <= 1), "{cost:?}");
        assert!(!cost.capped.is_empty(), "{cost:?}");
    });
}

#[test]
fn every_krylov_method_works_in_the_complement() {
    with_session(|session| {
        let direct = Direct::new(scene(&by_subdomain(3, 3, 3.0, 5)));
        for method in ["cg", "fcg", "pipecg", "gmres"] {
            let distance = direct::with_options(session, &[("ksp_type", method)], || {
                let mut solver = direct.solver(session, &below(3.0));
                solver.deflate().expect("a search");
                let solution = solver.solve().expect("solved");
                assert!(solution.converged(), "{method}: {}", solution.status);
                direct.distance(&solution.u)
            });
            println!("{method}: {distance:.1e}");
            assert!(distance < 1e-6, "{method}: {distance:.1e}");
        }
    });
}

/// Only CG provides Ritz values during the iteration. With the other methods the search comes first, so that they, too,
/// do not iterate with a κ of 10⁵.
#[test]
fn methods_without_ritz_values_search_at_once() {
    let scratch = mpi::Scratch::new("deflation-methods");
    let file = scratch.file("channels.toml", &channels("scalar"));
    let iterations = |method: &str| {
        let json = scratch.path(&format!("{method}.json"));
        let (out, name) = (scratch.path("out"), "-fetifeti_ksp_type");
        let run = program::fetifeti(&[
            "solve", &file, "--out", &out, "--json", &json, "--quiet", name, method,
        ]);
        assert_eq!(run.code, 0, "{}", run.all());
        let text = std::fs::read_to_string(&json).expect("a report");
        let report: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        let vectors = &report["adaptive"]["deflation"]["vectors"];
        assert!(vectors.as_u64().is_some_and(|n| n > 0), "{method}: {text}");
        report["iterations"]["total"].as_u64().expect("a number")
    };
    let cg = iterations("cg");
    for method in ["fcg", "pipecg", "gmres"] {
        let n = iterations(method);
        assert!(n <= cg + 5, "{method} takes {n} iterations, cg {cg}");
    }
}

#[test]
fn contact_keeps_its_vectors() {
    // Two columns of bodies, each held on its outer side: no body can be pushed away.
    let right = "dirichlet = { right = 0 }\norigin = [\"1/2\"";
    let text = by_subdomain(2, 5, 3.0, 11).replace("origin = [\"1/2\"", right)
        + "[interface]\ndefault = \"contact\"\n";
    with_session(move |session| {
        let scene = scene(&text);
        let energy = |adaptive| {
            let settings = MethodSettings::default().adaptive(adaptive).rtol(1e-10);
            let mut solver = solver(session, &scene, settings);
            if adaptive != Adaptive::Off {
                solver.deflate().expect("a search");
            }
            let solution = solver.solve().expect("solved");
            assert!(solution.converged(), "{}", solution.status);
            println!("{adaptive:?}: {} iterations", solution.iterations);
            (solution.energy, solution.iterations, solution.active)
        };
        let (with, fewer, set) = energy(Adaptive::Below(10.0));
        let (without, more, same) = energy(Adaptive::Off);
        assert!((with / without - 1.0).abs() < 1e-8, "{with} {without}");
        assert_eq!(set, same);
        assert!(fewer <= more, "{fewer} {more}");
    });
}

/// One rank's share; subdomains are dealt out in turn.
fn on_a_rank(session: &Session) -> base::Result<()> {
    let (size, rank) = (session.size(), session.rank());
    let scene = scene(&by_subdomain(3, 4, 6.0, 2));
    let problem = scene.substructures(&|s| s % size == rank)?;
    let mut solver = FetiFeti::new(session, problem, below(10.0))?;
    let kappa = solver.spectrum()?.map(|s| s.kappa());
    let solution = solver.solve()?;
    let cost = solver.deflated().expect("a search");
    if rank == 0 {
        println!(
            "RESULT {:.12e} {:.12e} {} {}",
            kappa.expect("multipliers"),
            solution.energy,
            solution.iterations,
            cost.vectors.iter().sum::<usize>()
        );
    }
    Ok(())
}

#[test]
fn one_two_and_four_ranks_agree() {
    let started = mpi::as_rank(|session, _| on_a_rank(session));
    let results = [1, 2, 4].map(|ranks| started.numbers(ranks, "random"));
    let one = &results[0];
    for other in &results[1..] {
        // The vectors come from iterations whose start depends on the number of ranks: those with eigenvalues near τ
        // may differ.
        assert!((one[0] / other[0] - 1.0).abs() < 0.05, "{results:?}");
        assert!((one[1] / other[1] - 1.0).abs() < 1e-9, "{results:?}");
        assert!((one[2] - other[2]).abs() <= 1.0, "{results:?}");
        assert_eq!(one[3], other[3], "{results:?}");
    }
}
