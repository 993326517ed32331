//! Adaptive primal constraints: exact condition numbers of one body with coefficients that jump from element to element.

mod mpi;
mod solid;

use fetifeti::feti::settings::Adaptive;
use fetifeti::feti::{FetiFeti, Scaling, Settings};
use fetifeti::petsc::testing::with_session;
use fetifeti::petsc::Session;
use solid::{Physics, Rows, Solid};

/// κ, the number of constraints.
fn run(
    session: &Session,
    name: &str,
    solid: &Solid,
    scaling: Scaling,
    adaptive: Adaptive,
) -> (f64, usize) {
    let settings = Settings {
        scaling,
        adaptive,
        ..Settings::default()
    };
    let solver = FetiFeti::new(session, solid.substructures(|_| true), settings).expect("set up");
    let facts = solver.facts();
    let n: usize = facts.adaptive_constraints.iter().sum();
    let worst = solver.check().expect("checks run");
    let worst = worst
        .into_iter()
        .fold(("", 0.0), |a, b| if b.1 > a.1 { b } else { a });
    let s = solver
        .spectrum()
        .expect("eigenvalues")
        .expect("multipliers");
    let solution = solver.solve().expect("solved");
    println!(
        "{name} {scaling:?} {adaptive:?}: kappa {:.4} lambda_min {:.9}, {n} of {} constraints, {:.3} of {:.3} s, check {worst:?}, {} iterations {} {:?}",
        s.kappa(), s.lambda_min, facts.primal, facts.adaptive_seconds, facts.setup_seconds, solution.iterations, solution.converged, solution.kkt
    );
    (s.kappa(), n)
}

/// Numbers without pattern in [0, 1), by place.
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

/// Two channels per subdomain of 8 elements in every direction.
fn channels(x: [usize; 3]) -> f64 {
    if [1, 2, 5].contains(&(x[1] % 8)) {
        1e6
    } else {
        1.0
    }
}

/// Channels on a grid of 4 elements.
fn beams(x: [usize; 3]) -> f64 {
    let inside = |d: usize| x[d] % 4 == 1 || x[d] % 4 == 2;
    if (inside(0) && inside(1)) || (inside(1) && inside(2)) {
        1e6
    } else {
        1.0
    }
}

fn body(
    dim: usize,
    [subdomains, elements]: [usize; 2],
    physics: Physics,
    by: fn([usize; 3]) -> f64,
) -> Solid {
    Solid {
        by_element: Some(by),
        ..Solid::new(dim, [1, subdomains, elements], physics, Rows::Tied)
    }
}

#[test]
fn explore() {
    with_session(|session| {
        let elastic = Physics::Elastic { nu: 0.3 };
        let cases = [
            ("2D channels", body(2, [4, 8], Physics::Scalar, channels)),
            ("2D random", body(2, [4, 8], Physics::Scalar, random)),
            ("2D elastic channels", body(2, [4, 8], elastic, channels)),
            ("2D elastic random", body(2, [4, 8], elastic, random)),
            ("3D beams", body(3, [3, 4], Physics::Scalar, beams)),
            ("3D random", body(3, [3, 4], Physics::Scalar, random)),
            ("3D elastic random", body(3, [2, 3], elastic, random)),
        ];
        for (name, solid) in &cases {
            for scaling in [Scaling::Rho, Scaling::Stiffness, Scaling::Deluxe] {
                for adaptive in [Adaptive::Off, Adaptive::Auto, Adaptive::Below(10.0)] {
                    run(session, name, solid, scaling, adaptive);
                }
            }
        }
    });
}
