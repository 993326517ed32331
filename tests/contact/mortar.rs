//! Contact where nodes do not match: the same answer by all methods, and rows that depend on each other.

use crate::support::session::with_session;
use base::Result;
use fetifeti::settings::{ContactType, MethodSettings};
use fetifeti::{FetiFeti, Settings, Solution};
use lab::study::hard_cases::trackers;
use scene::Scene;

/// Solves by one method, or says why not.
fn solve(text: &str, kind: ContactType) -> Result<(Scene, Solution)> {
    let scene = Scene::parse("s.toml", text)?;
    let problem = scene.substructures(&|_| true)?;
    let solution = with_session(move |session| {
        let mut settings = Settings::from(MethodSettings::default().rtol(1e-10));
        settings.contact.kind = kind;
        FetiFeti::new(session, problem, settings)?.solve()
    })?;
    Ok((scene, solution))
}

#[test]
fn all_methods_find_the_same_answer() {
    let mut seen = 0;
    for case in trackers() {
        if !case.text.contains("ontact") || case.name.starts_with("4c") {
            continue;
        }
        let kinds = [
            ContactType::ActiveSet,
            ContactType::AugmentedLagrangian,
            ContactType::Smalbe,
        ];
        let found = kinds.map(|kind| {
            let what = format!("{}, {kind:?}", case.name);
            let (_, solution) = solve(&case.text, kind).unwrap_or_else(|e| panic!("{what}: {e}"));
            assert!(solution.converged(), "{what}: {}", solution.status);
            let kkt = &solution.kkt;
            println!("{what}: {} iterations, {kkt:?}", solution.iterations);
            let defects = [kkt.stationarity, kkt.feasibility, kkt.complementarity];
            assert!(defects.iter().all(|d| *d < 1e-6), "{what}: {kkt:?}");
            assert!(
                solution.rows().iter().all(|r| r.multiplier >= 0.0),
                "{what}"
            );
            solution
        });
        let [first, others @ ..] = &found;
        let largest = |u: &[Vec<f64>]| u.iter().flatten().fold(0.0f64, |a, u| a.max(u.abs()));
        for other in others {
            let away: Vec<Vec<f64>> = (first.u.iter().zip(&other.u))
                .map(|(a, b)| a.iter().zip(b).map(|(a, b)| a - b).collect())
                .collect();
            let away = largest(&away) / largest(&first.u);
            assert!(away < 1e-6, "{}: {away:e}", case.name);
            let set = |s: &Solution| s.rows().iter().map(|r| r.holds()).collect::<Vec<_>>();
            assert_eq!(set(first), set(other), "{}", case.name);
        }
        seen += 1;
    }
    assert!(seen >= 5, "{seen}");
}

/// A body on another one, with 3m and 2m elements along the common side, where obstacles bound both: the lower one from
/// below, the upper one from above by 0.05 + 0.01 x. Every row of contact depends on those of the obstacles.
fn between_obstacles(m: usize, joint: &str, below: &str) -> String {
    format!(
        "[[body]]\nname = \"low\"\nsize = [4, 1]\nelements = [{}, 4]\nsubdomains = [2, 1]\n\
         dirichlet = [\"bottom\"]\nload = 1\n\
         [[body]]\nname = \"up\"\norigin = [0, 1]\nsize = [4, 1]\nelements = [{}, 4]\nsubdomains = [2, 1]\n\
         dirichlet = {{ top = \"0.3*sin(2*x)\" }}\nload = \"-2*cos(x)\"\n\
         [[{joint}]]\nbodies = [\"low\", \"up\"]\n\
         [[obstacle]]\nbody = \"low\"\nside = \"top\"\nbelow = \"{below} + 0.01*x\"\n\
         [[obstacle]]\nbody = \"up\"\nside = \"bottom\"\nabove = \"0.05 + 0.01*x\"\n",
        3 * m,
        2 * m
    )
}

/// Obstacles that leave no room: the common side is where they are.
#[test]
fn many_rows_may_depend_on_each_other() {
    for joint in ["contact", "tie"] {
        for m in [10, 40] {
            let text = between_obstacles(m, joint, "0.05");
            let (scene, solution) = solve(&text, ContactType::ActiveSet).expect("a solution");
            assert!(solution.converged(), "{joint}, {m}: {}", solution.status);
            let rows = solution.rows().len();
            assert_eq!(rows, 8 * m + 3);
            let problem = scene.substructures(&|_| true).expect("substructures");
            for (sub, u) in problem.local.iter().zip(&solution.u) {
                let x = sub.coordinates.as_ref().expect("coordinates");
                for (x, u) in x.iter().zip(u).filter(|(x, _)| x[1] == 1.0) {
                    let wanted = 0.05 + 0.01 * x[0];
                    assert!((u - wanted).abs() < 1e-7, "{joint}, {m}: {u} at {x:?}");
                }
            }
        }
    }
}

/// Obstacles that contradict each other everywhere or in one place, by way of the rows between the bodies.
#[test]
fn contradictions_are_found_among_many_rows() {
    for joint in ["contact", "tie"] {
        for m in [10, 40, 100] {
            for (below, from, to) in [
                ("0.06", 0.0, 4.0),
                ("if(x > 1.9 && x < 2.1, 0.0501, 0.04)", 1.6, 2.4),
            ] {
                let text = between_obstacles(m, joint, below);
                let Err(e) = solve(&text, ContactType::ActiveSet) else {
                    panic!("{joint}, {m}, {below}: solved")
                };
                let told = e.to_string();
                let what = format!("{joint}, {m}, {below}: {told}");
                assert!(told.contains("contradict each other"), "{what}");
                assert!(told.contains("\"low\", \"up\""), "{what}");
                // Among many rows the place is named.
                let place = told.split("at (").nth(1).expect("a place");
                let x: f64 = place
                    .split(',')
                    .next()
                    .and_then(|x| x.parse().ok())
                    .expect("x");
                assert!(m == 10 || (from..=to).contains(&x), "{what}");
            }
        }
    }
}
