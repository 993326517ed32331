//! Random elastic contact scenes, plane and solid, flat and curved, by both contact loops and on several ranks, against
//! the assembled reference.

use crate::support::sample::of;
use crate::support::session::with_session;
use crate::support::{contact_judge, elastic_scene, mpi};
use base::Error;
use elastic_scene::{case, Case, Fate};
use fetifeti::settings::ContactType;
use petsc::Session;

const KINDS: [ContactType; 3] = [
    ContactType::ActiveSet,
    ContactType::AugmentedLagrangian,
    ContactType::Smalbe,
];

/// Solves the scenes of `seeds` with both methods. Where there is a solution, both agree with the reference; the other
/// scenes are refused.
fn all_agree(
    session: &Session,
    seeds: std::ops::Range<u64>,
) -> std::result::Result<[usize; 3], String> {
    let mut wrong = Vec::new();
    let mut fates = [0; 3];
    // Prescribed values beyond an obstacle are refused before the solve.
    for case in seeds.filter_map(|seed| case(seed).ok()) {
        let index = match case.fate {
            Fate::Solvable(_) => 0,
            Fate::Unbounded => 1,
            Fate::Infeasible => 2,
        };
        fates[index] += 1;
        for kind in KINDS {
            if let Err(why) = judge(session, &case, kind) {
                wrong.push(format!("seed {}, {kind:?}: {why}", case.seed));
            }
        }
    }
    if wrong.is_empty() {
        Ok(fates)
    } else {
        Err(format!("{} answers:\n{}", wrong.len(), wrong.join("\n")))
    }
}

fn judge(session: &Session, case: &Case, kind: ContactType) -> std::result::Result<(), String> {
    let Case { scene, problem, .. } = case;
    if let Fate::Solvable(reference) = &case.fate {
        let cards = case.seed % 2 == 1;
        let what = (scene, problem, &**reference);
        return contact_judge::judge(session, what, cards, kind).map(|_| ());
    }
    match contact_judge::answer(session, scene, problem, false, kind) {
        Err(error) if error.is_input() => Ok(()),
        Err(why) => Err(why.to_string()),
        Ok(_) => Err("solved, but has no solution".into()),
    }
}

#[test]
fn random_scenes_agree_with_the_reference() {
    mpi::alone(|| {
        with_session(|session| {
            let last = of(120, 400);
            let fates = all_agree(session, 0..last as u64).unwrap_or_else(|why| panic!("{why}"));
            println!("solvable, unbounded, infeasible: {fates:?}");
            assert!(fates[0] > last / 2, "{fates:?}");
        });
    });
}

#[test]
fn random_scenes_on_two_and_four_ranks() {
    let started = mpi::as_rank(|session, _| {
        all_agree(session, 1000..1000 + of(8, 15) as u64)
            .map_err(Error::input)
            .map(|_| ())
    });
    for ranks in [2, 4] {
        let out = started.run(ranks, "scenes");
        assert_eq!(out.code, 0, "{ranks} ranks: {}", out.all());
    }
}
