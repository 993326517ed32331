//! Scenes of `make soak` that once were wrong (docs/reliability.md).

use crate::soak::{fate, Fate};
use crate::testing::with_session;

/// What the scene of each seed comes to.
fn fates(seeds: &'static [u64], right: fn(&Fate) -> bool) {
    with_session(move |session| {
        let dir = std::env::temp_dir().join(format!("fetifeti-soak-{}", std::process::id()));
        for &seed in seeds {
            let fate = fate(session, seed, &dir);
            assert!(right(&fate), "seed {seed}: {fate:?}");
        }
        let _ = std::fs::remove_dir_all(&dir);
    });
}

fn solved(fate: &Fate) -> bool {
    matches!(fate, Fate::Right(error) if *error < 1e-7)
}

/// A body stands where it likes: two solutions differ by a motion of any size without energy.
#[test]
fn errors_are_those_of_the_strains() {
    fates(
        &[1346, 3903, 10930, 15292, 27749, 32850, 41492, 42823],
        solved,
    );
}
