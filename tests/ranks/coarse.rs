//! The natural coarse problem of many bodies: whoever solves it, on whatever number of ranks, the answer is the same.

use crate::support::sample::all_cases;
use crate::support::{mpi, program};
use fetifeti::settings::MethodSettings;
use fetifeti::FetiFeti;
use mpi::{as_rank, Scratch};
use program::{ended, run_fetifeti};
use scene::Scene;
use serde_json::Value;
use std::process::Command;

/// A wall of 74 bodies, and squares of different stiffness that are tied. The wall of 192 among the examples would take
/// multigrid on four ranks half a minute of two cores.
fn scenes(scratch: &Scratch) -> Vec<(&'static str, String)> {
    let tied = "[grid]\nbodies = [14, 13]\nsize = [14, 13]\nsubdomains = 1\nelements_per_subdomain = 3\n\
                rho = { checkerboard = [1, 1e4], by = \"body\" }\ndirichlet = [\"right\"]\nload = \"1 + x\"\n\
                [options]\nfetifeti_projector = \"preconditioner\"\n";
    let path = scratch.path("tied.toml");
    std::fs::write(&path, tied).expect("the scene can be written");
    let of_bodies = ["../../scripts/many_bodies.py", "wall", "9", "8"];
    let mut script = Command::new("python3");
    let made = ended(script.args(of_bodies).arg(&scratch.0));
    assert_eq!(made.code, 0, "{}", made.all());
    vec![("wall", scratch.path("wall.toml")), ("tied", path)]
}

fn report(ranks: usize, scene: &str, scratch: &Scratch, options: &str) -> Value {
    let json = scratch.path("report.json");
    let mut args = vec![
        "solve",
        scene,
        "--quiet",
        "--json",
        &json,
        "-fetifeti_ksp_rtol",
        "1e-9",
    ];
    args.extend(options.split_whitespace());
    let run = run_fetifeti(ranks, &args);
    assert_eq!(
        run.code,
        0,
        "{ranks} ranks, {scene} {options}: {}",
        run.all()
    );
    let text = std::fs::read_to_string(&json).expect("there is a report");
    serde_json::from_str(&text).expect("the report is JSON")
}

/// Energy and κ are those of our own factor, to the tolerance and to three more digits than anybody reads. Solvers that
/// are no factorisation are iterated upon, and the report says so.
#[test]
fn whoever_solves_the_coarse_problem_the_answer_is_the_same() {
    let scratch = Scratch::new("coarse");
    let telescope =
        "-fetifeti_gtg_pc_type telescope -fetifeti_gtg_pc_telescope_reduction_factor 2 \
                     -fetifeti_gtg_telescope_pc_type lu";
    for (i, (name, scene)) in scenes(&scratch).into_iter().enumerate() {
        let own = report(1, &scene, &scratch, "");
        assert_eq!(own["natural_coarse"], Value::Null);
        let expected = |r: &Value| (r["energy"].as_f64().unwrap(), kappa(r));
        let (energy, own_kappa) = expected(&own);
        for (r, ranks) in [1, 2, 4].into_iter().enumerate() {
            let solvers = [
                ("", None),
                ("-fetifeti_gtg_pc_type lu", Some(false)),
                (
                    "-fetifeti_gtg_ksp_type cg -fetifeti_gtg_pc_type gamg",
                    Some(true),
                ),
                (telescope, None),
            ];
            for (k, (options, iterated)) in solvers.into_iter().enumerate() {
                // The sample has each solver for each scene, on some numbers of ranks.
                if (i + r + k) % 2 == 0 && !all_cases() {
                    continue;
                }
                if ranks == 1 && (options == telescope || options.is_empty()) {
                    continue;
                }
                let r = report(ranks, &scene, &scratch, options);
                let what = format!("{name}, {ranks} ranks, {options}");
                let (e, k) = expected(&r);
                assert!(
                    (e / energy - 1.0).abs() < 1e-9,
                    "{what}: energy {e}, not {energy}"
                );
                assert!(
                    (k / own_kappa - 1.0).abs() < 1e-5,
                    "{what}: κ {k}, not {own_kappa}"
                );
                let said = &r["natural_coarse"]["iterated"];
                if let Some(iterated) = iterated {
                    assert_eq!(said.as_bool(), Some(iterated), "{what}");
                }
            }
        }
    }
}

fn kappa(report: &Value) -> f64 {
    report["condition"]["estimate"]["kappa"]
        .as_f64()
        .expect("CG estimates κ")
}

/// With our own factor only the columns that separate the parts of the ranks are summed over all ranks: four times in
/// an iteration, together less than a single vector of all columns.
#[test]
fn vectors_of_all_columns_are_not_summed() {
    let scratch = Scratch::new("coarse-sums");
    let scene = "../../examples/scenes/wall.toml";
    for ranks in [2, 4] {
        let r = report(ranks, scene, &scratch, "");
        let columns = 3.0 * r["floating_bodies"].as_f64().unwrap();
        assert!(columns > 150.0, "few columns are another case");
        let communication = &r["communication"];
        let summed = communication["reduced_bytes_per_iteration"]
            .as_f64()
            .unwrap();
        assert!(
            summed < 8.0 * columns,
            "{ranks} ranks: {summed} bytes of {columns} columns"
        );
        assert!(communication["reductions_per_iteration"].as_f64().unwrap() < 8.0);
    }
}

/// A long pile of elastic blocks in contact, stiff and soft ones in turn if they are not `alike`.
fn pile(alike: bool, joined: &str) -> String {
    let young = if alike {
        "1000"
    } else {
        "1000*(1 + 999*mod(bi + bj + bk, 2))"
    };
    format!(
        "dimension = 3\nphysics = \"elasticity\"\n[grid]\nbodies = [3, 3, 24]\nsize = [3, 3, 24]\n\
         subdomains = [1, 1, 1]\nelements_per_subdomain = 1\nyoung = \"{young}\"\n\
         load = [\"0.5*sin(1 + 1.7*bi + 2.3*bj + 3.1*bk)\", -0.05, \"0.5*cos(1 + 2.7*bi + 1.3*bj)\"]\n\
         dirichlet = {{ bottom = 0, left = {{ x = 0 }}, right = {{ x = 0 }}, front = {{ z = 0 }}, \
         back = {{ z = 0 }} }}\n[interface]\ndefault = \"contact\"\n{joined}"
    )
}

/// With bodies on many ranks a rank has numbers for a part of the rigid motions, the same on all only where one rank is
/// all there are.
#[test]
fn a_rank_knows_the_motions_around_its_own_bodies() {
    let ranks = as_rank(|session, _| {
        let scene = Scene::parse("pile.toml", &pile(true, ""))?;
        let (size, rank) = (session.size(), session.rank());
        let share = |s: &usize| s * size / scene.n_subdomains() == rank;
        let problem = scene.substructures(&|s| share(&s))?;
        let mut solver = FetiFeti::new(session, problem, MethodSettings::default())?;
        let facts = solver.facts();
        let (all, here) = (facts.kernel_dimension, facts.kernel_dimension_here);
        assert!(all > 300, "few motions are another case: {all}");
        match size {
            1 => assert_eq!(here, all),
            // A quarter of the pile, and what is beside it and between the parts.
            4 => assert!(4 * here < 3 * all, "rank {rank}: {here} of {all}"),
            _ => assert!(here < all, "rank {rank}: {here} of {all}"),
        }
        let solution = solver.solve()?;
        assert!(solution.converged());
        Ok(())
    });
    for n in [1, 2, 4] {
        let out = ranks.run(n, "pile");
        assert_eq!(out.code, 0, "{n} ranks: {}", out.all());
    }
}

/// Where bodies differ in stiffness and rows switch between many of them, `auto` takes the diagonal for Q: the same
/// answer as with M⁻¹, on any number of ranks, in not many more iterations. Where some are tied it takes M⁻¹.
#[test]
fn many_bodies_that_slide_have_the_diagonal_for_q() {
    let scratch = Scratch::new("coarse-slide");
    let write = |name: &str, text: String| {
        let path = scratch.path(name);
        std::fs::write(&path, text).expect("the scene can be written");
        path
    };
    let slides = write("slides.toml", pile(false, ""));
    let tie = "[[tie]]\nbodies = [\"b1_1_4\", \"b1_1_5\"]\n";
    let tied = write("tied.toml", pile(false, tie));
    let of = |r: &Value| {
        let numbers = [&r["energy"], &r["iterations"]["total"]];
        let [energy, iterations] = numbers.map(|n| n.as_f64().expect("a number"));
        (energy, iterations)
    };
    let exact = report(1, &slides, &scratch, "-fetifeti_projector preconditioner");
    let (energy, iterations) = of(&exact);
    for ranks in [1, 2, 4] {
        let r = report(ranks, &slides, &scratch, "");
        assert_eq!(r["projector"], "diagonal", "{ranks} ranks");
        let (e, n) = of(&r);
        assert!(
            (e / energy - 1.0).abs() < 1e-9,
            "{ranks} ranks: {e}, not {energy}"
        );
        assert!(n < 2.0 * iterations, "{ranks} ranks: {n} and {iterations}");
    }
    let r = report(2, &tied, &scratch, "");
    assert_eq!(r["projector"], "preconditioner");
}
