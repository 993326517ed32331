//! Adaptive primal constraints: exact condition numbers of bodies with coefficients that jump from element to element.

use crate::support::checks::identities;
use crate::support::sample::sample;
use crate::support::session::with_session;
use crate::support::{mpi, solid};
use fetifeti::settings::{Adaptive, MethodSettings, Scaling};
use fetifeti::{FetiFeti, Problem};
use petsc::Session;
use solid::{assembled, Physics, Rows, Solid};

const SCALAR: Physics = Physics::Scalar;
const ELASTIC: Physics = Physics::Elastic { nu: 0.3 };
const SCALINGS: [Scaling; 3] = [Scaling::Rho, Scaling::Stiffness, Scaling::Deluxe];

/// The result for a problem.
#[derive(Debug)]
struct Outcome {
    kappa: f64,
    /// Adaptive constraints of all bodies.
    added: usize,
    iterations: usize,
}

fn solver(session: &Session, problem: Problem, scaling: Scaling, adaptive: Adaptive) -> FetiFeti {
    let settings = MethodSettings::default()
        .scaling(scaling)
        .adaptive(adaptive)
        .rtol(1e-10);
    FetiFeti::new(session, problem, settings).expect("set up")
}

/// Runs a problem, and checks the identities and the lower end of the spectrum.
fn run(session: &Session, solid: &Solid, scaling: Scaling, adaptive: Adaptive) -> Outcome {
    run_to(session, solid, scaling, adaptive, 1e-9)
}

/// As `run`, with identities that hold to `rounding`.
fn run_to(
    session: &Session,
    solid: &Solid,
    scaling: Scaling,
    adaptive: Adaptive,
    rounding: f64,
) -> Outcome {
    let mut solver = solver(session, solid.substructures(|_| true), scaling, adaptive);
    let facts = solver.facts().clone();
    let spectrum = solver.spectrum().expect("eigenvalues");
    let spectrum = spectrum.expect("multipliers");
    let solution = solver.solve().expect("solved");
    let added = facts.adaptive_constraints.iter().sum();
    let out = Outcome {
        kappa: spectrum.kappa(),
        added,
        iterations: solution.iterations,
    };
    println!(
        "{}D {:?} {scaling:?} {adaptive:?}: {out:?}, {} primal, lambda_min - 1 = {:.1e}, {:.3} of {:.3} s",
        solid.dim,
        [solid.bodies, solid.subdomains, solid.elements],
        facts.primal,
        spectrum.lambda_min - 1.0,
        facts.adaptive_seconds,
        facts.setup_seconds,
    );
    identities(&solver, rounding, "adaptive");
    assert!(spectrum.lambda_min > 1.0 - 1e-6, "{spectrum:?}");
    assert!(solution.converged());
    out
}

/// Numbers without a pattern in [0, 1), as a function of the place.
fn noise(x: [usize; 3]) -> f64 {
    let mut z = (x[0] as u64) << 40 ^ (x[1] as u64) << 20 ^ x[2] as u64 ^ 0x5bd1_e995_0000_0001;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// 10^[−3, 3] in every element.
fn random(x: [usize; 3]) -> f64 {
    10f64.powf(6.0 * noise(x) - 3.0)
}

/// 10^[−6, 6] in every element.
fn wild(x: [usize; 3]) -> f64 {
    random(x).powi(2)
}

/// Two channels through every subdomain of 8 elements.
fn channels(x: [usize; 3]) -> f64 {
    if [1, 2, 5].contains(&(x[1] % 8)) {
        1e6
    } else {
        1.0
    }
}

/// Channels that are softer by a factor of a hundred million.
fn gaps(x: [usize; 3]) -> f64 {
    if [1, 2, 5].contains(&(x[1] % 8)) {
        1e-8
    } else {
        1.0
    }
}

/// Two beams in x and two in z through every subdomain of 5 elements.
fn beams(x: [usize; 3]) -> f64 {
    let inside = |d: usize| x[d] % 5 == 1 || x[d] % 5 == 3;
    if (inside(1) && inside(2)) || (inside(0) && inside(1)) {
        1e6
    } else {
        1.0
    }
}

/// One body held all round.
fn body(
    dim: usize,
    [subdomains, elements]: [usize; 2],
    physics: Physics,
    by: Coefficient,
) -> Solid {
    Solid {
        by_element: Some(by),
        ..Solid::new(dim, [1, subdomains, elements], physics, Rows::Tied)
    }
}

type Coefficient = fn([usize; 3]) -> f64;

/// κ stays below 1.5 τ with every scaling, and is far above 100 without constraints where the coefficient is scaled by
/// ρ.
fn bounded(session: &Session, solid: &Solid, far: f64) {
    let off = run(session, solid, Scaling::Rho, Adaptive::Off);
    assert_eq!(off.added, 0);
    assert!(off.kappa > far, "{off:?}");
    for scaling in SCALINGS {
        let on = run(session, solid, scaling, Adaptive::Auto);
        assert!(on.added > 0 && on.kappa < 15.0, "{on:?}");
    }
}

#[test]
fn channels_across_edges_cost_a_constraint_each() {
    with_session(|session| {
        bounded(session, &body(2, [4, 8], SCALAR, channels), 1e5);
        bounded(session, &body(2, [4, 8], ELASTIC, channels), 1e5);
    });
}

#[test]
fn random_coefficients_in_the_plane() {
    with_session(|session| {
        bounded(session, &body(2, [4, 8], SCALAR, random), 500.0);
        bounded(session, &body(2, [4, 8], ELASTIC, random), 500.0);
    });
}

#[test]
fn random_coefficients_and_beams_in_space() {
    with_session(|session| {
        bounded(session, &body(3, [3, 4], SCALAR, random), 30.0);
        bounded(session, &body(3, [3, 5], SCALAR, beams), 5e4);
        bounded(session, &body(3, [2, 3], ELASTIC, random), 12.0);
    });
}

#[test]
fn kappa_follows_the_threshold() {
    with_session(|session| {
        let solid = body(2, [4, 8], ELASTIC, random);
        let mut last = usize::MAX;
        for tau in [2.0, 5.0, 10.0, 50.0] {
            let on = run(session, &solid, Scaling::Rho, Adaptive::Below(tau));
            assert!(on.kappa < 1.5 * tau && on.added < last, "{on:?}");
            last = on.added;
        }
    });
}

#[test]
fn jumps_of_many_decades() {
    with_session(|session| {
        for by in [wild as Coefficient, gaps] {
            for physics in [SCALAR, ELASTIC] {
                for scaling in SCALINGS {
                    let solid = body(2, [4, 8], physics, by);
                    let on = run_to(session, &solid, scaling, Adaptive::Auto, 1e-7);
                    assert!(on.kappa < 15.0, "{on:?}");
                }
            }
        }
    });
}

#[test]
fn smooth_coefficients_take_nothing() {
    with_session(|session| {
        let cases = [
            Solid::new(2, [1, 4, 8], SCALAR, Rows::Tied),
            Solid::new(2, [1, 4, 8], ELASTIC, Rows::Tied),
            Solid::new(3, [1, 3, 4], SCALAR, Rows::Tied),
            Solid::new(3, [1, 2, 4], ELASTIC, Rows::Tied),
        ];
        for solid in cases {
            let off = run(session, &solid, Scaling::Rho, Adaptive::Off);
            for adaptive in [Adaptive::Auto, Adaptive::Below(20.0)] {
                let on = run(session, &solid, Scaling::Rho, adaptive);
                assert_eq!(on.added, 0);
                assert_eq!(on.iterations, off.iterations);
            }
        }
    });
}

/// Several bodies: λ_min does not change, and the solution is that of the assembled problem.
#[test]
fn several_bodies() {
    with_session(|session| {
        for (dim, sizes, physics) in [(2, [2, 2, 6], ELASTIC), (3, [2, 2, 3], SCALAR)] {
            let solid = Solid {
                by_element: Some(random),
                ..Solid::new(dim, sizes, physics, Rows::Tied)
            };
            let off = run(session, &solid, Scaling::Stiffness, Adaptive::Off);
            let on = run(session, &solid, Scaling::Stiffness, Adaptive::Auto);
            assert!(
                on.added > 0 && on.kappa < 1.01 * off.kappa,
                "{on:?} {off:?}"
            );

            let problem = solid.substructures(|_| true);
            let exact = assembled::solve(&problem);
            let mut solver = solver(session, problem, Scaling::Deluxe, Adaptive::Auto);
            let solution = solver.solve().expect("solved");
            let size = exact.iter().flatten().fold(0.0f64, |a, u| a.max(u.abs()));
            let pairs = solution.u.iter().flatten().zip(exact.iter().flatten());
            let error = pairs.fold(0.0f64, |a, (u, e)| a.max((u - e).abs()));
            assert!(error < 1e-7 * size, "{error:.1e} of {size:.1e}");
        }
    });
}

/// One rank's share of a body; subdomains are dealt out in turn. Prints the values that must not depend on the number
/// of ranks.
fn on_a_rank(session: &Session, solid: &Solid) {
    let (size, rank) = (session.size(), session.rank());
    let problem = solid.substructures(|s| s % size == rank);
    let mut solver = solver(session, problem, Scaling::Deluxe, Adaptive::Auto);
    identities(&solver, 1e-10, "on ranks");
    let spectrum = solver.spectrum().expect("eigenvalues");
    let kappa = spectrum.expect("multipliers").kappa();
    if rank == 0 {
        let added = &solver.facts().adaptive_constraints;
        println!("RESULT {} {kappa:.12e}", added[0]);
    }
}

#[test]
fn one_two_and_four_ranks_agree() {
    let started = mpi::as_rank(|session, case| {
        let solid = match case {
            "plane" => body(2, [4, 6], ELASTIC, random),
            _ => body(3, [3, 4], SCALAR, random),
        };
        on_a_rank(session, &solid);
        Ok(())
    });
    for case in sample(2, ["space", "plane"]) {
        let results = [1, 2, 4].map(|ranks| started.numbers(ranks, case));
        for other in &results[1..] {
            assert_eq!(results[0][0], other[0], "{case}");
            let relative = (results[0][1] / other[1] - 1.0).abs();
            assert!(relative < 1e-5, "{case}: {results:?}");
        }
        assert!(results[0][0] > 0.0);
    }
}
