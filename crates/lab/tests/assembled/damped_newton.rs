//! Unit tests of `crates/lab/src/assembled/damped_newton.rs`.

use super::*;
use crate::assembled::layout::UnknownLayout;
use crate::assembled::near::{Near, NearKernel};
use crate::assembled::reference::{mumps, Reference, ResidualPrecision};
use crate::assembled::unknowns::Unknowns;
use crate::study::hard_cases::cases;
use crate::testing::with_session;
use fetifeti::settings::MethodSettings;
use fetifeti::{FetiFeti, Settings};
use scene::Scene;

/// ψ'(t) by its definition: the part without springs, and all springs that push.
fn slope_of(line: &LineSearch, t: f64) -> f64 {
    let springs = line.pull.iter().zip(&line.opening).zip(&line.springs);
    let pull = |((s, b), k): ((&f64, &f64), &f64)| (s + t * k * b).max(0.0) * b;
    let active = line.pull.iter().zip(&line.opening).zip(&line.springs);
    let active = active.filter(|((s, _), _)| **s > 0.0);
    let active: f64 = active.map(|((s, b), k)| (s + t * k * b) * b).sum();
    t * line.bend - line.fall - active + springs.map(pull).sum::<f64>()
}

/// ψ(t) − ψ(0) by its derivative, with the midpoint rule on small pieces.
fn change_of(line: &LineSearch, t: f64) -> f64 {
    let n = 100_000;
    let piece = t / f64::from(n);
    let slopes = (0..n).map(|k| slope_of(line, (f64::from(k) + 0.5) * piece));
    slopes.sum::<f64>() * piece
}

/// Row 0 opens on the way, row 1 closes, row 2 closes far behind, row 3 does not move.
fn line() -> LineSearch {
    LineSearch {
        fall: 10.0,
        bend: 20.0,
        pull: vec![1.0, -2.0, -1e6, 3.0],
        opening: vec![-1.0, 2.0, 1.0, 0.0],
        springs: vec![8.0, 10.0, 5.0, 5.0],
    }
}

#[test]
fn a_step_takes_the_energy_down() {
    let line = line();
    let best = line.minimum().expect("it falls");
    // The length is exact to 1e-12, and ψ'' is some tens.
    assert!(slope_of(&line, best).abs() < 1e-10, "{best}");
    assert!((line.slope(0.3)[0] - slope_of(&line, 0.3)).abs() < 1e-12);
    for t in [0.05, best, 0.5, 1.0] {
        let (change, expected) = (line.change(t), change_of(&line, t));
        assert!((change - expected).abs() < 1e-6, "{change} {expected}");
    }
    // The first of 1, ½, ¼, … that is good enough, and not shorter than the best.
    let t = line.length().expect("it falls");
    let enough = ENOUGH * line.change(best);
    assert!(t < 1.0 && t >= best && line.change(t) <= enough, "{t}");
    assert!(2.0 * t > 1.0 || line.change(2.0 * t) > enough, "{t}");
    // Without changes of the set the whole step is the minimum.
    let whole = LineSearch {
        bend: 10.0,
        pull: vec![1.0],
        opening: vec![1.0],
        springs: vec![3.0],
        ..line
    };
    assert_eq!((whole.minimum(), whole.length()), (Some(1.0), Some(1.0)));
    let up = LineSearch {
        fall: -1.0,
        ..whole
    };
    assert_eq!(up.length(), None);
}

#[test]
fn a_row_without_springs_does_not_count() {
    let with = LineSearch {
        pull: [line().pull, vec![0.0]].concat(),
        opening: [line().opening, vec![0.0]].concat(),
        springs: [line().springs, vec![0.0]].concat(),
        ..line()
    };
    assert_eq!(with.length(), line().length());
    assert_eq!(with.change(0.7), line().change(0.7));
}

/// Without trials: displacements and forces of the rounds converge to those of the refined solution, from zero.
#[test]
fn the_rounds_converge() {
    with_session(|session| {
        let case = cases(true).into_iter().find(|c| c.name == "wall-jumps-1e6");
        let case = case.expect("it is there");
        let scene = Scene::parse("wall.toml", &case.text).expect("a scene");
        let layout = UnknownLayout::new(&scene);
        let direct = Reference::certified(session, &scene, &layout).expect("a solution");
        let problem = &direct.problem;
        let (comm, rows, right) = (session.comm(), &problem.rows, &direct.found.u);
        let rest = right.duplicate().expect("a vector");
        problem.system.residual(right, &rest).expect("a residual");
        let forces = problem.trace.get(comm, &rest).expect("forces");

        let unknowns = Unknowns::all(&layout);
        let kernel = NearKernel::new(&scene, &unknowns, &problem.system.b, Near::None);
        let reduced = Reduced::new(session, &problem.system, rows, kernel.expect("a kernel"));
        let reduced = reduced.expect("a matrix");
        let ksp = mumps(session).expect("a solver");
        let mut solvers = || Ok(ksp.clone());
        let mut search = DampedNewton::new(session, rows, &reduced).expect("a search");
        let mut steps = 0;
        while !search.is_exhausted() {
            let round = search.round(&mut solvers).expect("a round");
            assert!(round.steps < STEPS);
            assert!(search.multiplier.iter().all(|mu| *mu >= 0.0));
            steps += round.steps;
        }
        println!("{steps} steps in {ROUNDS} rounds");
        let most = |list: &[f64]| list.iter().fold(0.0f64, |a, v| a.max(v.abs()));
        let apart = search.u.duplicate().expect("a vector");
        apart.copy_from(&search.u).expect("a copy");
        apart.axpy(-1.0, right).expect("a difference");
        let off = apart.norm_inf().expect("a norm") / right.norm_inf().expect("a norm");
        assert!(off < 1e-6, "{off}");
        let mut left = forces.clone();
        for (row, mu) in rows.rows.iter().zip(&search.multiplier) {
            for (end, sign) in [(row.plus, 1.0), (row.minus, -1.0)] {
                if let Some(force) = left.get_mut(end) {
                    *force -= sign * mu;
                }
            }
        }
        let off = most(&left) / most(&forces);
        assert!(off < 1e-6, "{off}");
    });
}

#[test]
fn walls_have_the_energy_of_the_method() {
    with_session(|session| {
        for name in ["wall", "wall-jumps-1e4", "wall-jumps-1e6"] {
            let case = cases(true).into_iter().find(|c| c.name == name);
            let case = case.expect("it is there");
            let scene = Scene::parse("wall.toml", &case.text).expect("a scene");
            let layout = UnknownLayout::new(&scene);
            let direct = Reference::certified(session, &scene, &layout).expect("a solution");
            let (system, u) = (&direct.problem.system, &direct.found.u);
            let half = 0.5 * system.energy_norm(u).expect("a norm").powi(2);
            let energy = half - system.b.dot(u).expect("a product");

            let settings = Settings::from(MethodSettings::default().rtol(1e-10));
            let problem = scene.substructures(&|_| true).expect("subdomains");
            let mut solver = FetiFeti::new(session, problem, settings).expect("the set-up works");
            let solution = solver.solve().expect("it has a solution");
            assert!(solution.converged(), "{name}: {}", solution.status);
            let off = (solution.energy - energy).abs() / energy.abs();
            // Jumps of 10⁶ leave 5e-10 even at a tolerance of 1e-11.
            assert!(off < 5e-9, "{name}: {} and {energy}", solution.energy);

            // Neither the set nor the solution depends on the precision.
            let working =
                Reference::new(session, &scene, &layout, ResidualPrecision::Working, None);
            let working = working.expect("it runs").found;
            println!("{name}: {} and {} steps", direct.found.steps, working.steps);
            assert!(working.residual < 1e-7, "{name}: {}", working.residual);
            assert_eq!(working.active, direct.found.active, "{name}");
            working.u.axpy(-1.0, u).expect("a difference");
            let off = working.u.norm_inf().expect("a norm") / u.norm_inf().expect("a norm");
            assert!(off < 1e-7, "{name}: {off}");
        }
    });
}
