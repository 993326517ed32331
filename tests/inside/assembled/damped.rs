//! Unit tests of `src/assembled/damped.rs`.

use super::*;
use crate::assembled::layout::Layout;
use crate::assembled::reference::{Precision, Reference};
use crate::scene::Scene;
use crate::study::hard_cases::cases;
use crate::testing::with_session;
use crate::{FetiFeti, MethodSettings, Settings};

/// ψ'(t) by its definition: the part without springs, and all springs that push.
fn slope_of(line: &Line, t: f64) -> f64 {
    let springs = line.pull.iter().zip(&line.opening).zip(&line.springs);
    let pull = |((s, b), k): ((&f64, &f64), &f64)| (s + t * k * b).max(0.0) * b;
    let active = line.pull.iter().zip(&line.opening).zip(&line.springs);
    let active = active.filter(|((s, _), _)| **s > 0.0);
    let active: f64 = active.map(|((s, b), k)| (s + t * k * b) * b).sum();
    t * line.bend - line.fall - active + springs.map(pull).sum::<f64>()
}

#[test]
fn a_step_ends_where_the_energy_is_least() {
    // Row 0 opens on the way, row 1 closes, row 2 closes far behind, row 3 does not move.
    let line = Line {
        fall: 10.0,
        bend: 20.0,
        pull: vec![1.0, -2.0, -1e6, 3.0],
        opening: vec![-1.0, 2.0, 1.0, 0.0],
        springs: vec![8.0, 10.0, 5.0, 5.0],
    };
    let t = line.length().expect("it falls");
    assert!(slope_of(&line, t).abs() < 1e-12, "{t}");
    assert!((line.slope(0.3)[0] - slope_of(&line, 0.3)).abs() < 1e-12);
    // Without changes of the set the whole step is the minimum.
    let whole = Line {
        bend: 10.0,
        pull: vec![1.0],
        opening: vec![1.0],
        springs: vec![3.0],
        ..line
    };
    assert_eq!(whole.length(), Some(1.0));
    let up = Line {
        fall: -1.0,
        ..whole
    };
    assert_eq!(up.length(), None);
}

/// The active set alone does not solve these walls in 200 steps.
#[test]
fn walls_have_the_energy_of_the_method() {
    with_session(|session| {
        for name in ["wall", "wall-jumps-1e4", "wall-jumps-1e6"] {
            let case = cases(true).into_iter().find(|c| c.name == name);
            let case = case.expect("it is there");
            let scene = Scene::parse("wall.toml", &case.text).expect("a scene");
            let layout = Layout::new(&scene);
            let direct = Reference::certified(session, &scene, &layout).expect("a solution");
            let (system, u) = (&direct.problem.system, &direct.found.u);
            let half = 0.5 * system.energy_norm(u).expect("a norm").powi(2);
            let energy = half - system.b.dot(u).expect("a product");

            let settings = Settings::from(MethodSettings {
                rtol: 1e-9,
                ..MethodSettings::default()
            });
            let problem = scene.substructures(&|_| true).expect("subdomains");
            let solver = FetiFeti::new(session, problem, settings).expect("the set-up works");
            let solution = solver.solve().expect("it has a solution");
            assert!(solution.converged(), "{name}: {}", solution.status);
            let off = (solution.energy - energy).abs() / energy.abs();
            assert!(off < 1e-9, "{name}: {} and {energy}", solution.energy);

            // The set does not depend on the precision.
            let working = Reference::new(session, &scene, &layout, Precision::Working, None);
            let working = working.expect("it runs").found;
            assert_eq!(working.active, direct.found.active, "{name}");
        }
    });
}
