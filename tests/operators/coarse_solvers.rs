//! The solvers of the coarse problems may be exchanged by options.

use crate::direct::{floating_scenes, tight, with_options};
use crate::testing::with_session;

#[test]
fn coarse_solvers_may_be_exchanged() {
    with_session(|session| {
        for (name, direct) in floating_scenes() {
            let iterative = [
                ("coarse_ksp_type", "cg"),
                ("coarse_pc_type", "jacobi"),
                ("coarse_ksp_rtol", "1e-14"),
                ("coarse_ksp_max_it", "1000"),
            ];
            let natural = [
                ("gtg_ksp_type", "cg"),
                ("gtg_pc_type", "jacobi"),
                ("gtg_ksp_rtol", "1e-15"),
            ];
            for options in [&iterative[..], &natural[..]] {
                let (kind, (solution, distance)) = with_options(session, options, || {
                    let mut solver = direct.solver(session, &tight());
                    let dual = solver.dual();
                    let gtg = dual.natural.gtg.as_ref();
                    let gtg = gtg
                        .and_then(|g| g.solver.ksp())
                        .map(|k| k.type_name().unwrap());
                    drop(dual);
                    let solution = solver.solve().expect("solved");
                    let distance = direct.distance(&solution.u);
                    (gtg, (solution, distance))
                });
                println!(
                    "{name} {options:?}: {distance:.1e}, {} iterations",
                    solution.iterations
                );
                let expected = if options[0].0 == "gtg_ksp_type" {
                    "cg"
                } else {
                    "preonly"
                };
                assert_eq!(kind.as_deref(), Some(expected));
                assert!(solution.converged());
                assert!(distance < 1e-8, "{name} {options:?}: {distance:.1e}");
            }
        }
    });
}
