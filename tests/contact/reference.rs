//! The assembled reference for contact scenes, on the model problem and on larger scenes, and the comparison of answers
//! with it.

use crate::support::sample::all_cases;
use crate::support::{assembled, qp};
use assembled::compare::{compare, Candidate, Tolerances};
use assembled::{Assembled, Place, Reference};
use qp::{Outcome, CERTIFIED};
use scene::Scene;

/// (3.1)–(3.3) of [Lee] with `n` elements per side.
fn model(n: usize) -> Scene {
    let text = format!(
        "[grid]\nbodies = [2, 1]\norigin = [0, 0]\nsize = [2, 1]\nsubdomains = 1\nelements_per_subdomain = {n}\n\
         dirichlet = [\"left\"]\nload = [\
         \n  {{ x = [0, 1], y = [0.75, 1], value = -3 }},\
         \n  {{ x = [1, 2], y = [0, 0.25], value = -1 }},\n]\n\
         [[contact]]\nbodies = \"all\"\ngap = 0\n"
    );
    Scene::parse("model.toml", &text).unwrap()
}

#[test]
fn the_model_problem_agrees_with_the_oracle() {
    let text = include_str!("../data/model_contact.json");
    let oracle: serde_json::Value = serde_json::from_str(text).unwrap();
    for case in oracle.as_array().unwrap() {
        let n = case["elements_per_side"].as_u64().unwrap() as usize;
        let scene = model(n);
        let problem = Assembled::of_scene(&scene);
        let s = problem.solve();
        println!("{n}: {:e} {:?} {:?}", s.energy, s.closed, s.solved.kkt);
        let near = |value: f64, key: &str, limit: f64| {
            let expected = case[key].as_f64().unwrap();
            assert!((value - expected).abs() < limit, "{key} {value} {expected}");
        };
        near(s.energy, "energy", 1e-12);
        near(s.contact_force, "contact_force", 1e-12);
        assert!((s.contact_force - 0.25).abs() < 1e-13);
        let rows = scene.solver_rows(&|_| true);
        let nodes: Vec<f64> = s
            .closed
            .iter()
            .map(|&r| rows[r].label.point[1] * n as f64)
            .collect();
        let nodes: Vec<u64> = nodes.iter().map(|y| y.round() as u64).collect();
        assert_eq!(nodes.len() as u64, case["active_nodes"].as_u64().unwrap());
        let (first, last) = (case["first_active"].as_u64(), case["last_active"].as_u64());
        assert_eq!(nodes, (first.unwrap()..=last.unwrap()).collect::<Vec<_>>());
        near(s.u.iter().copied().fold(0.0, f64::min), "min_u", 1e-11);
        let second: Vec<f64> = (0..s.u.len())
            .filter(|&i| problem.body[i] == 1)
            .map(|i| s.u[i])
            .collect();
        near(
            second.iter().sum::<f64>() / second.len() as f64,
            "mean_nodal_u2",
            1e-11,
        );
    }
}

/// `n` × `m` bodies held on the left, alternately stiff and soft, pushed downwards; interfaces are in turn tied, in
/// contact, and with gaps.
fn wall(n: usize, m: usize, elements: usize) -> Scene {
    let mut text = format!(
        "[grid]\nname = \"b\"\nbodies = [{n}, {m}]\norigin = [0, 0]\n\
         size = [{n}, {m}]\nsubdomains = 1\nelements_per_subdomain = {elements}\n\
         dirichlet = [\"left\"]\nrho = {{ checkerboard = [1, 100], by = \"body\" }}\n\
         load = \"-0.2 - 20*sin(6.283185307179586*y)*(1 + 0.3*sin(5*x))\"\n"
    );
    let mut count = 0;
    for j in 0..m {
        for i in 0..n {
            for (a, b) in [(i + 1, j), (i, j + 1)] {
                if a >= n || b >= m {
                    continue;
                }
                count += 1;
                let pair = format!("bodies = [\"b{i}_{j}\", \"b{a}_{b}\"]");
                let gap = ["0", "0.1*y", "0.05", "-0.02*x"][count % 4];
                text += &match (count % 5, b - j) {
                    (0, 0) => format!("[[tie]]\n{pair}\n"),
                    _ => format!("[[contact]]\n{pair}\ngap = \"{gap}\"\n"),
                };
            }
        }
    }
    Scene::parse("wall.toml", &text).unwrap()
}

#[test]
fn a_hundred_bodies() {
    for (n, m, elements) in [(16, 1, 8), (10, 10, 8)] {
        let problem = Assembled::of_scene(&wall(n, m, elements));
        let s = problem.solve();
        println!(
            "{} unknowns, {} equations, {} inequalities, {} closed, {} kernels: {:?}",
            problem.dofs.len(),
            problem.qp.equal.len(),
            problem.qp.below.len(),
            s.closed.len(),
            problem.qp.kernel.len(),
            s.solved.kkt
        );
        assert!(s.solved.kkt.largest() <= CERTIFIED);
        assert!(!s.closed.is_empty() && s.closed.len() < problem.qp.below.len());
        assert_eq!(problem.qp.kernel.len(), (n - 1) * m);
    }
}

/// The sample is every third.
#[test]
fn the_example_scenes_with_contact() {
    let mut count = 0;
    let entries = std::fs::read_dir("../../examples/scenes").unwrap();
    let mut paths: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "toml"));
    paths.sort();
    for path in paths {
        let scene = Scene::load(&path).unwrap();
        // The arch that falls has no solution.
        if !scene.has_contact() || path.ends_with("arch_falls.toml") {
            continue;
        }
        count += 1;
        if count % 3 != 0 && !all_cases() {
            continue;
        }
        let problem = Assembled::of_scene(&scene);
        let s = problem.solve();
        println!(
            "{}: {} unknowns, {} of {} rows closed, force {:.6}, energy {:.9e}, {:?}",
            path.display(),
            problem.dofs.len(),
            s.closed.len(),
            problem.qp.below.len(),
            s.contact_force,
            s.energy,
            s.solved.kkt
        );
        assert!(s.solved.kkt.largest() <= CERTIFIED);
    }
    assert!(count >= 5, "{count}");
}

/// The judgement of the reference solution with modifications, taken as an answer.
fn judged(
    problem: &Assembled,
    s: &Reference,
    u: &[f64],
    lambda: &[f64],
) -> Result<assembled::compare::Agreement, String> {
    let energy = problem.qp.energy(u);
    compare(
        problem,
        s,
        &Candidate { u, lambda, energy },
        &Tolerances::default(),
    )
}

#[test]
fn the_comparison_sees_what_is_wrong() {
    let problem = Assembled::of_scene(&model(8));
    let s = problem.solve();
    let good = judged(&problem, &s, &s.u, &s.lambda).unwrap();
    assert_eq!((good.closed, good.open, good.free_motions), (7, 2, 0));
    // The reference has its energy from the work of forces.
    assert!(good.energy < 1e-13 && good.u == 0.0);

    let fails = |u: &[f64], lambda: &[f64], why: &str| {
        let message = judged(&problem, &s, u, lambda).unwrap_err();
        assert!(message.contains(why), "{message}");
    };
    let mut u = s.u.clone();
    u[5] += 1e-5;
    fails(&u, &s.lambda, "stationarity");
    // The floating body is moved up, away from the other, and down, into it.
    let moved = |by: f64| -> Vec<f64> {
        let step = |i: usize| if problem.body[i] == 1 { by } else { 0.0 };
        (0..s.u.len()).map(|i| s.u[i] + step(i)).collect()
    };
    fails(
        &moved(1e-3),
        &s.lambda,
        "rows closed in one and open in the other: 7",
    );
    fails(&moved(-1e-3), &s.lambda, "feasibility");
    let mut lambda = s.lambda.clone();
    lambda[s.closed[0]] *= -1.0;
    fails(&s.u, &lambda, "sign");
    let fake = Candidate {
        u: &s.u,
        lambda: &s.lambda,
        energy: s.energy * (1.0 + 1e-7),
    };
    let message = compare(&problem, &s, &fake, &Tolerances::default())
        .err()
        .unwrap();
    assert!(message.contains("energy"), "{message}");
    let nan = vec![f64::NAN; s.u.len()];
    assert!(judged(&problem, &s, &nan, &s.lambda).is_err());
}

#[test]
fn motions_that_nothing_stops_are_no_difference() {
    // Two floating bodies are pressed together by loads that balance, tied or in contact: they float as one body.
    let text = "[grid]\nbodies = [2, 1]\norigin = [0, 0]\nsize = [2, 1]\nsubdomains = 1\nelements_per_subdomain = 4\n\
                load = [{ x = [0, 1], y = [0, 1], value = 1 }, { x = [1, 2], y = [0, 1], value = -1 }]\n\
                [[contact]]\nbodies = \"all\"\n";
    let problem = Assembled::of_scene(&Scene::parse("floating.toml", text).unwrap());
    let s = problem.solve();
    assert!((s.contact_force - 1.0).abs() < 1e-12);
    let moved: Vec<f64> = s.u.iter().map(|u| u + 3.0).collect();
    let a = judged(&problem, &s, &moved, &s.lambda).unwrap();
    assert_eq!(a.free_motions, 1);
    assert!(a.u < 1e-12 && a.energy < 1e-12);
}

#[test]
fn four_bodies_at_a_point_may_share_forces_differently() {
    // All six rows of a tied cross point are present: any multipliers with the same Bᵀλ are correct.
    let text = "[grid]\nbodies = 2\nsubdomains = 1\nelements_per_subdomain = 3\ndirichlet = \"all\"\nload = 1\n";
    let problem = Assembled::of_scene(&Scene::parse("cross.toml", text).unwrap());
    let s = problem.solve();
    let mut lambda = s.lambda.clone();
    let find = |a: usize, b: usize| {
        let unknown = |d: u64| problem.body[problem.unknown(d)];
        let cross = |r: &usize| {
            let block = problem.rows[*r].block;
            problem.rows.iter().filter(|row| row.block == block).count() == 6
        };
        let ends = |r: &usize| {
            problem.rows[*r]
                .terms
                .iter()
                .map(|t| unknown(t.0))
                .collect::<Vec<_>>()
        };
        (0..lambda.len())
            .filter(cross)
            .find(|r| ends(r) == [a, b])
            .unwrap()
    };
    let (ab, bc, ac) = (find(0, 1), find(1, 2), find(0, 2));
    for (r, by) in [(ab, 1.0), (bc, 1.0), (ac, -1.0)] {
        lambda[r] += by;
    }
    judged(&problem, &s, &s.u, &lambda).unwrap();
    lambda[ac] += 1e-3;
    judged(&problem, &s, &s.u, &lambda).unwrap_err();
}

#[test]
fn scenes_without_a_solution() {
    // A body is pulled away from the held one; and a lower bound is above the upper bound of the other body.
    let pulled = "[grid]\nbodies = [2, 1]\norigin = [0, 0]\nsize = [2, 1]\nsubdomains = 1\nelements_per_subdomain = 3\n\
                  dirichlet = [\"left\"]\nload = 1\n[[contact]]\nbodies = \"all\"\n";
    let problem = Assembled::of_scene(&Scene::parse("pulled.toml", pulled).unwrap());
    let Outcome::Unbounded(z) = problem.outcome() else {
        panic!("no motion")
    };
    assert!((0..z.len()).all(|i| (z[i] - problem.body[i] as f64).abs() < 1e-9));
    let squeezed = pulled.to_string()
        + "[[obstacle]]\nbody = \"b0_0\"\nside = [\"right\"]\nbelow = 1\n\
           [[obstacle]]\nbody = \"b1_0\"\nside = [\"left\"]\nabove = 0.5\n";
    let problem = Assembled::of_scene(&Scene::parse("squeezed.toml", &squeezed).unwrap());
    assert!(matches!(problem.outcome(), Outcome::Infeasible(_)));
    assert!(problem.place.iter().all(|p| matches!(p, Place::Below(_))));
}
