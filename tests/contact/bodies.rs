//! Many bodies, most of them floating, with tied, unilateral and gap interfaces: both methods against the assembled
//! reference, on one and several ranks.

use crate::support::session::with_session;
use crate::support::{assembled, contact_judge, mpi};
use assembled::{Assembled, Reference};
use base::Error;
use fetifeti::settings::ContactType;
use petsc::Session;
use scene::Scene;

const SCENES: [&str; 5] = [
    "contact_row_16",
    "contact_grid_100",
    "contact_gap_table",
    "obstacle",
    "press_ramp",
];

const KINDS: [ContactType; 3] = [
    ContactType::ActiveSet,
    ContactType::AugmentedLagrangian,
    ContactType::Smalbe,
];

/// The reference is certified to 1e-10 independently. Energies agree to 1e-8, KKT residuals are below 1e-8, and rows
/// with a force are closed in both solutions.
fn agree(session: &Session, name: &str, kinds: &[ContactType]) -> Result<(), String> {
    let path = format!("{}/examples/scenes/{name}.toml", env!("FETIFETI_ROOT"));
    let scene = Scene::load(path).map_err(|e| e.to_string())?;
    let problem = Assembled::of_scene(&scene);
    let reference: Reference = problem.solve();
    for &kind in kinds {
        let what = (&scene, &problem, &reference);
        let agreement = contact_judge::judge(session, what, false, kind)
            .map_err(|why| format!("{name}, {}: {why}", kind.name()))?;
        if session.rank() == 0 {
            println!("{name}, {}: {agreement:?}", kind.name());
        }
    }
    Ok(())
}

#[test]
fn on_one_rank() {
    mpi::alone(|| {
        with_session(|session| {
            for name in SCENES {
                agree(session, name, &KINDS).unwrap();
            }
        });
    });
}

/// Each kind of loop is on 2 ranks and on 4, with scenes by turns.
#[test]
fn on_two_and_four_ranks() {
    let started = mpi::as_rank(|session, _| {
        for (k, name) in SCENES.iter().enumerate() {
            let kinds = (0..KINDS.len()).filter(|i| (k + i) % 2 == session.size() / 4);
            let kinds: Vec<_> = kinds.map(|i| KINDS[i]).collect();
            agree(session, name, &kinds).map_err(Error::input)?;
        }
        Ok(())
    });
    for ranks in [2, 4] {
        let out = started.run(ranks, "scenes");
        assert_eq!(out.code, 0, "{ranks} ranks: {}", out.all());
    }
}
