//! Random contact scenes by the method, with both contact loops and on several ranks, against the assembled reference.

use crate::support::sample::of;
use crate::support::session::with_session;
use crate::support::{assembled, contact_judge, mpi, random_scene};
use assembled::compare::Agreement;
use base::Error;
use contact_judge::How;
use fetifeti::settings::ContactType;
use petsc::Session;
use random_scene::{Case, Collection, Fate};

const KINDS: [ContactType; 3] = [
    ContactType::ActiveSet,
    ContactType::AugmentedLagrangian,
    ContactType::Smalbe,
];

fn judge(session: &Session, case: &Case, how: How) -> std::result::Result<Agreement, String> {
    let Fate::Solvable(reference) = &case.fate else {
        panic!("seed {} has no solution", case.seed)
    };
    let cards = case.seed % 2 == 1;
    contact_judge::judge(session, (&case.scene, &case.problem, reference), cards, how)
}

/// Solves all cases; prints the failures, and the largest deviations that were accepted.
fn all_agree(session: &Session, cases: &[Case], how: How) -> std::result::Result<(), String> {
    let mut wrong = Vec::new();
    let (mut energy, mut u, mut kkt, mut degenerate) = (0.0f64, 0.0f64, 0.0f64, 0);
    for case in cases {
        match judge(session, case, how) {
            Ok(a) => {
                energy = energy.max(a.energy);
                u = u.max(a.u);
                kkt = kkt.max(a.kkt.largest());
                degenerate += usize::from(a.degenerate > 0);
            }
            Err(why) => wrong.push(format!("seed {}: {why}", case.seed)),
        }
    }
    if session.rank() == 0 {
        println!(
            "{how:?}: {} of {} agree; energy within {energy:.1e}, \
             u {u:.1e}, KKT {kkt:.1e}; {degenerate} with degenerate rows",
            cases.len() - wrong.len(),
            cases.len()
        );
    }
    if wrong.is_empty() {
        Ok(())
    } else {
        Err(format!("{} scenes:\n{}", wrong.len(), wrong.join("\n")))
    }
}

/// In one process: to make the scenes takes a third of the time.
#[test]
fn random_scenes_by_every_method() {
    mpi::alone(|| {
        with_session(|session| {
            let cases = Collection::new(0, of(120, 500)).solvable;
            for kind in KINDS {
                if let Err(why) = all_agree(session, &cases, kind.into()) {
                    panic!("{why}");
                }
            }
        });
    });
}

/// As if all rows at a point were a large block, cross points with rows that depend on each other included.
#[test]
fn random_scenes_with_coupled_blocks() {
    mpi::alone(|| {
        with_session(|session| {
            let cases = Collection::new(20_000, of(75, 150)).solvable;
            for kind in KINDS {
                let how = How {
                    coupled: 0,
                    ..How::from(kind)
                };
                if let Err(why) = all_agree(session, &cases, how) {
                    panic!("{why}");
                }
            }
        });
    });
}

#[test]
fn scenes_without_a_solution_are_refused() {
    with_session(|session| {
        let cases = Collection::new(0, of(180, 500));
        let mut wrong = Vec::new();
        for kind in KINDS {
            for case in cases.unbounded.iter().chain(&cases.infeasible) {
                // The message names a body: one that moves without bound, or one whose rows contradict each other.
                let moves = |b: usize| match &case.fate {
                    Fate::Unbounded(z) => {
                        let of_body = z.iter().zip(&case.problem.body);
                        of_body.into_iter().any(|(z, &body)| body == b && *z != 0.0)
                    }
                    _ => true,
                };
                let named = |why: &str| {
                    let bodies = case.scene.bodies.iter().enumerate();
                    let mut blamed = bodies.filter(|(b, _)| moves(*b));
                    blamed.any(|(_, body)| why.contains(&body.spec.name))
                };
                match contact_judge::answer(session, &case.scene, &case.problem, false, kind) {
                    Err(error) if error.is_input() && named(&error.to_string()) => {}
                    Err(why) => wrong.push(format!("seed {}, {kind:?}: {why}", case.seed)),
                    Ok(_) => wrong.push(format!("seed {}, {kind:?}: solved", case.seed)),
                }
            }
        }
        assert!(wrong.is_empty(), "{}:\n{}", wrong.len(), wrong.join("\n"));
    });
}

#[test]
fn random_scenes_on_two_and_four_ranks() {
    let started = mpi::as_rank(|session, _| {
        let cases = Collection::new(10_000, of(12, 24)).solvable;
        for kind in KINDS {
            all_agree(session, &cases, kind.into()).map_err(Error::input)?;
        }
        Ok(())
    });
    for ranks in [2, 4] {
        let out = started.run(ranks, "scenes");
        assert_eq!(out.code, 0, "{ranks} ranks: {}", out.all());
    }
}
