//! Unit tests of `src/substructures/law.rs`.

use super::*;

const ALL: [Law; 3] = [Law::Tie, Law::Unilateral, Law::Friction];
const VALUES: [f64; 7] = [-3.0, -1e-30, -0.0, 0.0, 1e-30, 0.5, 4.0];

#[test]
fn kinds_are_different_and_lead_back() {
    for (n, law) in (0..).zip(ALL) {
        assert_eq!((law.kind(), Law::of_kind(n)), (n, Some(law)));
        assert_eq!(law.sent().law(), law);
    }
    assert_eq!(Law::of_kind(ALL.len() as u64), None);
}

#[test]
fn the_projection_is_the_nearest_admissible_multiplier() {
    for law in ALL {
        for x in VALUES {
            let p = law.project(x);
            // Admissible, itself its projection, and as far away as the pull says.
            assert!(p >= law.least() && law.project(p) == p && law.pull(p) == 0.0);
            assert_eq!((p - x).abs(), law.pull(x), "{law} {x}");
            // No admissible multiplier is nearer: (x − p)(y − p) ≤ 0 for all of them.
            for y in VALUES.map(|y| law.project(y)) {
                assert!((x - p) * (y - p) <= 0.0, "{law} {x} {y}");
            }
        }
    }
}

#[test]
fn multipliers_and_gaps_are_dual() {
    // A multiplier and a gap that violate nothing do no work where the law says so.
    for law in ALL {
        for (lambda, gap) in VALUES.iter().flat_map(|l| VALUES.map(|g| (*l, g))) {
            let right = law.pull(lambda) == 0.0 && law.violation(gap, true) == 0.0;
            if right && law.complementarity(lambda, gap) == 0.0 {
                assert_eq!(lambda * gap, 0.0, "{law} {lambda} {gap}");
            }
        }
        // A released row has an admissible multiplier, and nothing violates an equation that does not hold.
        for given in VALUES {
            let released = law.released(given);
            assert_eq!(law.pull(released), 0.0);
            assert!(released == 0.0 || law.is_friction() && released == given);
        }
        assert_eq!(law.is_inequality(), law.violation(1.0, false) > 0.0);
    }
}

#[test]
fn a_tie_bears_all_and_a_contact_pushes() {
    for x in VALUES {
        assert!(Law::Tie.bears(x));
        assert_eq!(Law::Tie.resistance(x), x.abs());
        assert_eq!(Law::Unilateral.bears(x), x > 0.0);
        assert_eq!(Law::Unilateral.resistance(x), x);
    }
    let states =
        ALL.map(|law| [(1.0, true), (1.0, false), (0.0, false)].map(|(l, on)| law.state(l, on)));
    let [tie, contact, open] = [RowState::Tied, RowState::Holds, RowState::Open];
    let friction = [RowState::Sticks, RowState::Slips, open];
    assert_eq!(states, [[tie, open, open], [contact, open, open], friction]);
    let decided = ALL.map(Law::is_decided);
    assert_eq!(decided, [false, true, true]);
}
