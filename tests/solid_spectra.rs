//! Exact condition numbers in 3D and of elasticity.

mod solid;

use fetifeti::feti::{FetiFeti, PcType, Primal, Scaling, Settings};
use fetifeti::petsc::testing::with_session;
use fetifeti::petsc::Session;
use solid::{Physics, Rows, Solid};

const SCALAR: Physics = Physics::Scalar;

fn elastic(nu: f64) -> Physics {
    Physics::Elastic { nu }
}

fn kappa(session: &Session, solid: &Solid, settings: Settings) -> f64 {
    let clock = std::time::Instant::now();
    let solver = FetiFeti::new(session, solid.substructures(|_| true), settings).expect("set up");
    for (name, defect) in solver.check().expect("checks run") {
        assert!(defect < 1e-10, "{name}: {defect:.1e}");
    }
    let s = solver
        .spectrum()
        .expect("eigenvalues")
        .expect("multipliers");
    println!(
        "  {} {:.2}s {:?}",
        s.kappa(),
        clock.elapsed().as_secs_f64(),
        s
    );
    assert!(s.lambda_min > 1.0 - 1e-6, "{s:?}");
    s.kappa()
}

#[test]
#[ignore]
fn explore() {
    with_session(|session| {
        let cases = [
            (Solid::new(3, [2, 2, 4], SCALAR, Rows::Tied), 2.74, 0.0),
            (Solid::new(3, [2, 3, 3], SCALAR, Rows::Tied), 2.92, 5.39),
            (
                Solid::new(2, [2, 8, 4], elastic(0.3), Rows::Tied),
                24.0,
                0.0,
            ),
            (
                Solid::new(2, [2, 8, 4], elastic(0.49), Rows::Tied),
                25.3,
                278.0,
            ),
            (
                Solid::new(2, [2, 8, 4], elastic(0.3), Rows::Normals),
                14.5,
                67.3,
            ),
            (
                Solid::new(3, [2, 3, 2], elastic(0.3), Rows::Tied),
                4.68,
                6.78,
            ),
            (
                Solid::new(3, [2, 3, 2], elastic(0.3), Rows::Normals),
                2.47,
                5.26,
            ),
            (
                Solid::new(3, [2, 4, 2], elastic(0.3), Rows::Tied),
                5.79,
                9.64,
            ),
            (
                Solid::new(3, [2, 4, 2], elastic(0.3), Rows::Normals),
                3.11,
                7.86,
            ),
            (Solid::new(3, [2, 5, 3], SCALAR, Rows::Tied), 3.88, 11.4),
        ];
        let only: Option<usize> = std::env::var("CASE").ok().map(|c| c.parse().unwrap());
        for (i, (solid, corrected, dirichlet)) in cases.into_iter().enumerate() {
            if only.is_some_and(|o| i > o) {
                continue;
            }
            println!(
                "{:?} want M_C {corrected}, M_D {dirichlet}",
                [solid.dim, solid.bodies, solid.subdomains, solid.elements]
            );
            for pc in [PcType::CoarseCorrected, PcType::Dirichlet] {
                let settings = Settings {
                    pc_type: Some(pc),
                    ..Settings::default()
                };
                kappa(session, &solid, settings);
            }
        }
    });
}
