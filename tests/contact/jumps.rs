//! Grids of bodies in contact whose coefficients jump from body to body: the sets of the active-set method wander
//! there.

use crate::support::assembled::{Assembled, Reference};
use crate::support::contact_judge;
use crate::support::mpi;
use crate::support::rng::Rng;
use crate::support::sample::sample;
use crate::support::session::with_session;
use crate::support::wall::wall;
use fetifeti::settings::{ContactType, MethodSettings};
use fetifeti::{FetiFeti, Settings, Solution};
use lab::study::walls::{self, FAMILIES};
use petsc::Session;
use scene::Scene;

/// More steps than any scene here needs with some room; far fewer than the limit of the loop.
const STEPS: usize = 60;

/// `n` × `n` bodies with gaps between most of them, ρ = 1 and `jump` in a checkerboard.
fn scene(seed: u64, n: usize, jump: f64) -> Scene {
    let text = wall(&mut Rng::new(seed), n, jump);
    Scene::parse("jumps.toml", &text).expect("a good scene")
}

/// The energy and the number of steps; rtol 1e-8.
fn solve(session: &Session, scene: &Scene, kind: ContactType) -> (f64, usize) {
    let solution = solution(session, scene, kind, 1e-8);
    assert!(
        solution.kkt.error.is_some_and(|e| e < 1e-5),
        "{:?}",
        solution.kkt
    );
    (solution.energy, solution.steps.len())
}

fn solution(session: &Session, scene: &Scene, kind: ContactType, rtol: f64) -> Solution {
    let mine = fetifeti::share(session, scene.n_subdomains());
    let problem = scene
        .substructures(&|s| mine.contains(&s))
        .expect("a good scene");
    let mut settings = Settings::from(MethodSettings::default().rtol(rtol));
    settings.contact.kind = kind;
    let mut solver = FetiFeti::new(session, problem, settings).expect("the set-up works");
    let solution = solver.solve().expect("the scene has a solution");
    assert!(solution.converged(), "{}", solution.status);
    solution
}

const BOTH: [ContactType; 2] = [ContactType::ActiveSet, ContactType::AugmentedLagrangian];

/// In these walls displacements converge long before the multipliers between stiff bodies do. The set was judged by
/// multipliers of the wrong sign: an energy too high by 1e-5, a pull of 6e-4 of the largest multiplier.
#[test]
fn no_row_pulls_in_the_end() {
    with_session(|session| {
        let family = FAMILIES.iter().find(|f| f.name == "scalar-3x3x3");
        let family = family.expect("the family exists");
        let cases = [
            (7, &BOTH[..]),
            (10, &BOTH[1..]),
            (13, &BOTH[..1]),
            (20, &BOTH[1..]),
            (25, &BOTH[..1]),
        ];
        for (seed, kinds) in sample(3, cases) {
            let text = walls::scene(family, 1e6, seed);
            let scene = Scene::parse("wall.toml", &text).expect("a good scene");
            let exact = solution(session, &scene, ContactType::ActiveSet, 1e-10);
            for &kind in kinds {
                let rough = solution(session, &scene, kind, 1e-6);
                let off = (rough.energy - exact.energy).abs() / exact.energy.abs();
                assert!(off < 1e-6, "{kind:?}, {seed}: {off:e}");
                let pull = rough.kkt.min_multiplier;
                assert!(pull > -1e-5, "{kind:?}, {seed}: {pull:e}");
            }
        }
    });
}

#[test]
fn sets_that_wander_are_caught() {
    with_session(|session| {
        let mut wandered = 0;
        for (n, jump) in [(4, 1e2), (4, 1e4), (4, 1e6), (7, 1e2), (7, 1e4), (7, 1e6)] {
            for seed in 0..4 {
                let scene = scene(seed, n, jump);
                let what = format!("{n} x {n} bodies, jump {jump:e}, seed {seed}");
                let (energy, steps) = solve(session, &scene, ContactType::ActiveSet);
                assert!(steps <= STEPS, "{what}: {steps} steps");
                let (other, damped) = solve(session, &scene, ContactType::AugmentedLagrangian);
                assert!(damped <= STEPS, "{what}: {damped} damped steps");
                // The energy has an error of second order; that of stiff bodies is relative to larger terms.
                let off = (energy - other).abs() / energy.abs().max(1.0);
                assert!(off < 1e-7, "{what}: {energy} and {other}");
                wandered += usize::from(steps > 20);
            }
        }
        // Without a safeguard some of these take hundreds of steps, or do not end.
        assert!(wandered > 0);
    });
}

#[test]
fn displacements_agree_with_the_reference() {
    with_session(|session| {
        for seed in 0..4 {
            let scene = scene(seed, 4, 1e4);
            let problem = Assembled::of_scene(&scene);
            let reference: Reference = problem.solve();
            for kind in [ContactType::ActiveSet, ContactType::AugmentedLagrangian] {
                let what = (&scene, &problem, &reference);
                let agreement = contact_judge::judge(session, what, false, kind);
                agreement.unwrap_or_else(|why| panic!("seed {seed}, {kind:?}: {why}"));
            }
        }
    });
}

#[test]
fn any_number_of_ranks_finds_the_same() {
    let started = mpi::as_rank(|session, _| {
        for seed in 0..3 {
            let scene = scene(seed, 5, 1e4);
            let (energy, _) = solve(session, &scene, ContactType::ActiveSet);
            if session.rank() == 0 {
                println!("energy {seed} {energy:.7e}");
            }
        }
        Ok(())
    });
    let energies = [1, 2, 4].map(|ranks| {
        let out = started.run(ranks, "scenes");
        assert_eq!(out.code, 0, "{ranks} ranks: {}", out.all());
        let found = out.stdout.lines().filter(|l| l.contains("energy "));
        let found: Vec<f64> = found
            .map(|l| {
                l.rsplit(' ')
                    .next()
                    .expect("a word")
                    .parse()
                    .expect("a number")
            })
            .collect();
        assert_eq!(found.len(), 3, "{}", out.all());
        found
    });
    for other in &energies[1..] {
        for (a, b) in energies[0].iter().zip(other) {
            assert!((a - b).abs() < 1e-6 * a.abs(), "{a} and {b}");
        }
    }
}
