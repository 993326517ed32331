//! Exact condition numbers against an independent dense computation (tests/data/grid2d_spectra.json).

use crate::support::checks::{identities, number};
use crate::support::common;
use crate::support::session::with_session;
use common::Grid;
use fetifeti::settings::{MethodSettings, PcType};
use fetifeti::FetiFeti;
use serde_json::Value;

#[test]
fn kappa_multipliers_and_iterations_equal_the_oracle() {
    let text = include_str!("../data/grid2d_spectra.json");
    let oracle: Vec<Value> = serde_json::from_str(text).expect("the oracle is JSON");
    for row in oracle {
        let of = |key: &str| row[key].as_u64().expect("a count") as usize;
        let (nb, ns, ne) = (of("bodies"), of("subdomains"), of("elements"));
        for (side, third) in [("whole_interface", false), ("middle_third", true)] {
            let expected = row[side].clone();
            with_session(move |session| {
                let grid = Grid::lee(nb, ns, ne, third);
                for (pc, key) in [
                    (PcType::Dirichlet, "dirichlet"),
                    (PcType::CoarseCorrected, "coarse_corrected"),
                ] {
                    let settings = MethodSettings::default().pc_type(pc);
                    let mut solver = FetiFeti::new(session, grid.substructures(|_| true), settings)
                        .expect("set up");
                    let facts = solver.facts();
                    let m = facts.multipliers_local + facts.multipliers_active;
                    assert_eq!(m as u64, expected["multipliers"].as_u64().expect("count"));
                    assert_eq!(
                        facts.multipliers_local as u64,
                        expected["local_multipliers"].as_u64().expect("count")
                    );
                    assert_eq!(
                        facts.floating_bodies as u64,
                        expected["floating_bodies"].as_u64().expect("count")
                    );
                    identities(&solver, 1e-10, &format!("{nb} {ns} {ne}"));
                    let s = solver
                        .spectrum()
                        .expect("eigenvalues")
                        .expect("multipliers");
                    let want = &expected[key];
                    let relative = (s.kappa() / number(&want["kappa"]) - 1.0).abs();
                    let solution = solver.solve().expect("solved");
                    println!(
                        "{nb} {ns} {ne} {side} {key}: {:.6} {:.6} want {} {}; {} iterations, kkt {:?}",
                        s.lambda_min,
                        s.lambda_max,
                        want["kappa"],
                        want["iterations"],
                        solution.iterations,
                        solution.kkt
                    );
                    assert!(
                        relative < 1e-4,
                        "{nb} {ns} {ne} {side} {key}: {s:?} for {want}"
                    );
                    assert!(s.lambda_min > 1.0 - 1e-8);
                    assert!(solution.converged());
                }
            });
        }
    }
}
