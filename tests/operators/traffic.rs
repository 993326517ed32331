//! Messages, bytes and all-reduces of a solve, compared with PETSc's own counters.

use crate::mpi;
use base::Result;
use fetifeti::{FetiFeti, Settings};
use parallel::traffic;
use petsc::{counters, Session};
use scene::Scene;

/// 3 × 3 bodies of 2 × 2 subdomains: one body floats, so that S_Π, A and Gᵀ G all exist.
const TIED: &str = "[grid]\nbodies = 3\nsubdomains = 2\nelements_per_subdomain = 4\n\
                    load = \"1 + x + y^2\"\ndirichlet = \"all\"\n";

/// Two bodies of 2 × 2 subdomains of 3 × 3 elements, in contact; the right one floats.
const CONTACT: &str = "[[body]]\nname = \"left\"\nsize = [1, 1]\nsubdomains = 2\n\
    elements_per_subdomain = 3\ndirichlet = [\"left\"]\nload = -1\n\
    [[body]]\nname = \"right\"\norigin = [1, 0]\nsize = [1, 1]\nsubdomains = 2\n\
    elements_per_subdomain = 3\nload = -1\n\
    [[contact]]\nbodies = [\"left\", \"right\"]\ngap = 0\n";

fn against_petsc(session: &Session, text: &str) -> Result<()> {
    let scene = Scene::parse("test.toml", text)?;
    let mine = fetifeti::share(session, scene.n_subdomains());
    let problem = scene.substructures(&|s| mine.contains(&s))?;
    let mut solver = FetiFeti::new(session, problem, Settings::default())?;
    // PETSc completes the set-up of a scatter in its first use, with messages of its own.
    solver.solve()?;
    let read = |solver: &FetiFeti| {
        (
            traffic::sent(),
            counters(),
            solver.method().system().tally(),
        )
    };
    let (ours, theirs, tally) = read(&solver);
    let solution = solver.solve()?;
    let (ours_after, theirs_after, tally_after) = read(&solver);
    let ours = ours_after - ours;
    assert!(solution.converged() && solution.iterations > 3);
    assert!(ours.messages > 0 && ours.bytes > 8 * ours.messages && ours.reductions > 0);
    if let (Some(before), Some(after)) = (theirs, theirs_after) {
        assert_eq!(ours.messages as f64, after.messages - before.messages);
        assert_eq!(ours.bytes as f64, after.bytes - before.bytes);
    }
    let iterations = tally_after.iterations - tally.iterations;
    assert_eq!(iterations, solution.iterations);
    let sent = tally_after.sent - tally.sent;
    assert!(sent.messages <= ours.messages && tally_after.seconds > tally.seconds);
    // F, M and the coarse problems inside them go through six halo operations, all of them with the same neighbours
    // each time.
    assert_eq!(sent.messages % iterations as u64, 0);
    Ok(())
}

#[test]
fn petsc_counts_the_same_on_2_and_4_ranks() {
    let started = mpi::as_rank(|session, case| match case {
        "tied" => against_petsc(session, TIED),
        "contact" => against_petsc(session, CONTACT),
        other => panic!("unknown case {other}"),
    });
    for case in ["tied", "contact"] {
        for ranks in [2, 4] {
            let out = started.run(ranks, case);
            assert_eq!(out.code, 0, "{case}, {ranks} ranks: {}", out.all());
        }
    }
}
