//! Calls that fail leave a solver that works as before.

use crate::support::checks::near;
use crate::support::session::with_session;
use base::Error;
use fetifeti::settings::{ContactType, MethodSettings};
use fetifeti::solution::Spectrum;
use fetifeti::{FetiFeti, Settings};
use petsc::Session;
use scene::Scene;

/// A block that floats, pressed onto another one in its middle.
const BLOCKS: &str = "title = \"blocks\"\nphysics = \"elasticity\"\n\
    [[body]]\nname = \"low\"\nsize = [2, 1]\nelements = [8, 4]\nsubdomains = [2, 1]\nyoung = 100\n\
    dirichlet = [\"bottom\"]\n\
    [[body]]\nname = \"up\"\norigin = [0, 1]\nsize = [2, 1]\nelements = [8, 4]\nsubdomains = [2, 1]\nyoung = 100\n\
    load = [0, \"-8*(abs(x - 1) < 0.3)\"]\n\
    [[contact]]\nbodies = [\"low\", \"up\"]\n";

fn solver(session: &Session, kind: ContactType) -> FetiFeti {
    let scene = Scene::parse("blocks.toml", BLOCKS).expect("a good scene");
    let problem = scene.substructures(&|_| true).expect("a good scene");
    let mut settings = Settings::from(MethodSettings::default().rtol(1e-10));
    settings.contact.kind = kind;
    FetiFeti::new(session, problem, settings).expect("the set-up works")
}

/// Rows that no set-up accepts, and rows that leave a body loose: the old ones are still there after either.
#[test]
fn a_solver_keeps_its_rows_where_others_are_refused() {
    with_session(|session| {
        let mut solver = solver(session, ContactType::ActiveSet);
        let before = solver.solve().expect("there is a solution");
        let rows = solver.problem().rows.clone();
        let mut bad = rows.clone();
        bad[0].terms[0].0 = u64::MAX;
        let refused = solver
            .set_rows(bad, Vec::new())
            .expect_err("no subdomain has this dof");
        assert!(
            refused.to_string().contains("no subdomain holds"),
            "{refused}"
        );
        let now = &solver.problem().rows;
        let terms = now.iter().map(|r| &r.terms);
        assert!(terms.eq(rows.iter().map(|r| &r.terms)), "{now:?}");
        assert_eq!(solver.problem().local.len(), 4);
        let after = solver.solve().expect("there is a solution");
        assert!(after.converged(), "{}", after.status);
        assert_eq!(before.u, after.u);
        solver
            .set_rows(rows, Vec::new())
            .expect("these rows are good");
        let again = solver.solve().expect("there is a solution");
        assert!(near(again.energy, before.energy, 1e-9), "{}", again.energy);
    });
}

/// A callback ends the loop in the middle of each method: with springs in the rows, in a face, and with few rows held.
#[test]
fn a_loop_that_is_ended_leaves_the_operators_as_they_were() {
    with_session(|session| {
        for kind in [
            ContactType::ActiveSet,
            ContactType::AugmentedLagrangian,
            ContactType::Smalbe,
        ] {
            let mut solver = solver(session, kind);
            let spectrum = |solver: &mut FetiFeti| -> Spectrum {
                let found = solver.spectrum().expect("SLEPc finds it");
                found.expect("there are multipliers")
            };
            let before = spectrum(&mut solver);
            for last in 1..=2 {
                let mut steps = 0;
                let ended = solver.solve_from(None, &mut |_, _| {
                    steps += 1;
                    if steps == last {
                        Err(Error::input("that is enough"))
                    } else {
                        Ok(())
                    }
                });
                let ended = ended.expect_err("the callback ends it");
                assert!(
                    ended.to_string().contains("that is enough"),
                    "{kind:?}: {ended}"
                );
                let after = spectrum(&mut solver);
                let what = format!("{kind:?}, step {last}: {before:?}, then {after:?}");
                assert!(near(after.lambda_max, before.lambda_max, 1e-6), "{what}");
                assert!(near(after.lambda_min, before.lambda_min, 1e-6), "{what}");
            }
        }
    });
}

/// The tolerance of `solve_early` begins loose: an estimate that fails must not leave it so.
#[test]
fn an_estimate_that_fails_leaves_the_tolerance() {
    with_session(|session| {
        let mut solver = solver(session, ContactType::ActiveSet);
        let fails = solver.solve_early(None, &mut |_, _| Ok(()), &mut |_| {
            Err(Error::input("no estimate"))
        });
        assert!(fails.is_err());
        let rtol = solver.ksp().tolerances().expect("PETSc has them").0;
        assert_eq!(rtol, 1e-10);
    });
}

/// An obstacle and a contact at the same 37 nodes, opposite 17: most of the 74 rows depend on others. Where they carry
/// forces of 130, multipliers of 1e6 that pull are no solution, and an answer that is called one has its energy.
/// Rounding decides which methods come to an end here, so none has to.
#[test]
fn rows_that_depend_on_each_other_do_not_pull() {
    const SCENE: &str = "title = \"sides\"\ndimension = 2\n[interface]\ndefault = \"free\"\n\
        [[body]]\nname = \"fine\"\norigin = [-0.859, 0.184]\nsize = [0.766, 1.219]\nelements = [1, 36]\n\
        subdomains = [1, 3]\nrho = 1000\nload = -1.662\ndirichlet = { left = 0 }\nspring = { left = 0.294 }\n\
        [[body]]\nname = \"coarse\"\norigin = [-0.093, 0.071]\nsize = [1.005, 1.347]\nelements = [2, 16]\n\
        subdomains = [2, 2]\nrho = { checkerboard = [10000, 1], by = \"subdomain\" }\nload = -1.641\n\
        dirichlet = { right = 0 }\n\
        [[contact]]\nbodies = [\"fine\", \"coarse\"]\ngap = 0.023\n\
        [[obstacle]]\nbody = \"fine\"\nside = \"right\"\nbelow = 0.044\n\
        [[obstacle]]\nbody = \"coarse\"\nside = \"left\"\nabove = 0.144\n";
    with_session(|session| {
        for kind in [ContactType::ActiveSet, ContactType::AugmentedLagrangian] {
            let scene = Scene::parse("sides.toml", SCENE).expect("a good scene");
            let problem = scene.substructures(&|_| true).expect("a good scene");
            let mut settings = Settings::from(MethodSettings::default().rtol(1e-6));
            settings.contact.kind = kind;
            let mut solver = FetiFeti::new(session, problem, settings).expect("the set-up works");
            let solution = solver.solve().expect("an end");
            if solution.converged() {
                let least = solution.rows().iter().map(|row| row.multiplier);
                let least = least.fold(0.0, f64::min);
                assert!(least > -1e-2, "{kind:?}: {least}");
                assert!(
                    near(solution.energy, 2.215300775, 1e-5),
                    "{kind:?}: {}",
                    solution.energy
                );
            }
        }
    });
}

/// A body on a flat side, with one subdomain that is nearly incompressible: R along the side has rounding of 1e-12,
/// which is no hold. Nor is a solve with a first residual of rounding, which this has, a solution whatever it comes to.
#[test]
fn a_body_is_free_along_a_flat_side() {
    with_session(|session| {
        let scene = Scene::load("../../tests/data/loose_face.toml").expect("a good scene");
        let problem = scene.substructures(&|_| true).expect("a good scene");
        let mut solver = FetiFeti::new(session, problem, Settings::from(MethodSettings::default()))
            .expect("the set-up works");
        let solution = solver.solve().expect("an end");
        assert!(solution.converged(), "{}", solution.status);
        assert!(solution.kkt.stationarity < 1e-9, "{:?}", solution.kkt);
        // All three methods have this energy, and the body has not gone far along its side.
        assert!(
            near(solution.energy, -0.2150363594394, 1e-9),
            "{}",
            solution.energy
        );
        let far = solution
            .u
            .iter()
            .flatten()
            .fold(0.0f64, |a, u| a.max(u.abs()));
        assert!(far < 10.0, "{far}");
    });
}
