//! The certificate: its estimate of the error in the energy norm beside the error against a direct solution, and runs
//! that it must refuse.

use crate::support::direct;
use crate::support::session::with_session;
use direct::{with_options, Direct};
use fetifeti::settings::{MethodSettings, PcType};
use scene::Scene;

/// An error may be this many times the tolerance: `CREDIBLE` of the certificate.
const CREDIBLE: f64 = 1e3;

fn grid(rho: &str) -> Direct {
    let text = format!(
        "[grid]\nbodies = 3\nsubdomains = 3\nelements_per_subdomain = 5\nload = \"1 + x\"\n\
         dirichlet = [\"left\", \"bottom\"]\nrho = {rho}\n"
    );
    Direct::new(Scene::parse("grid.toml", &text).expect("a scene"))
}

#[test]
fn the_estimate_is_an_upper_bound_and_a_close_one() {
    with_session(|session| {
        let scenes = [
            ("constant", grid("1")),
            (
                "1e4 by body",
                grid("{ checkerboard = [1, 1e4], by = \"body\" }"),
            ),
            (
                "1e4 by subdomain",
                grid("{ checkerboard = [1, 1e4], by = \"subdomain\" }"),
            ),
            ("model_tied", Direct::example("model_tied")),
            ("one_body", Direct::example("one_body")),
        ];
        for (what, direct) in scenes {
            for pc in [PcType::Lumped, PcType::Dirichlet, PcType::CoarseCorrected] {
                for rtol in [1e-2, 1e-5, 1e-8] {
                    let settings = MethodSettings::default().pc_type(pc).rtol(rtol);
                    let (solution, distance) = direct.run(session, &settings);
                    let what = format!("{what}, {pc:?}, {rtol:e}");
                    let estimate = solution.kkt.error.expect("an estimate");
                    println!("{what}: {estimate:.1e} for {distance:.1e}");
                    assert!(solution.converged(), "{what}: {}", solution.status);
                    // The distance is formed from two solutions of 1e-15 each, with jumps of 1e4.
                    assert!(
                        distance < 1.1 * estimate + 1e-12,
                        "{what}: {estimate:e} {distance:e}"
                    );
                    assert!(
                        estimate < 30.0 * distance + 1e-12,
                        "{what}: {estimate:e} {distance:e}"
                    );
                }
            }
        }
    });
}

#[test]
fn primal_problems_that_are_not_solved_do_not_pass() {
    with_session(|session| {
        let scenes = [
            ("jump_1e6", Direct::example("jump_1e6")),
            ("partly_tied", Direct::example("partly_tied")),
            (
                "1e3 by subdomain",
                grid("{ checkerboard = [1, 1e3], by = \"subdomain\" }"),
            ),
        ];
        let mut refused = 0;
        for (what, direct) in scenes {
            for pc in ["jacobi", "sor", "none"] {
                for rtol in [1e-4, 1e-6, 1e-9] {
                    let text = format!("{rtol:e}");
                    let options = [
                        ("coarse_pc_type", pc),
                        ("primal", "vertices"),
                        ("ksp_rtol", &text),
                    ];
                    let (solution, distance) = with_options(session, &options, || {
                        let mut solver = direct.solver(session, &MethodSettings::default());
                        let solution = solver.solve().expect("an end");
                        let distance = direct.distance(&solution.u);
                        (solution, distance)
                    });
                    let status = &solution.status;
                    println!("{what}, {pc}, {text}: {status}, {distance:.1e}");
                    refused += usize::from(!solution.converged());
                    let right = distance <= 2.0 * CREDIBLE * rtol;
                    assert!(right || !solution.converged(), "{what}, {pc}: {distance:e}");
                }
            }
        }
        // Some of them must be wrong: else nothing is tried here.
        assert!(refused > 5, "{refused}");
    });
}
