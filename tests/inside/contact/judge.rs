//! Unit tests of `src/contact/judge.rs`.

use super::*;
use crate::testing::with_session;

/// Inequalities without a block, of which those in `active` hold.
fn jump(active: &[bool]) -> Jump {
    let n = active.len();
    let mut jump = Jump::default();
    (jump.n_owned, jump.n_global) = (n, n);
    jump.active = active.to_vec();
    jump.law = vec![crate::substructures::Law::Unilateral; n];
    (jump.gap, jump.held) = (vec![0.0; n], vec![0.0; n]);
    jump
}

/// The next set, and the number of wrong rows, for these gaps and multipliers; the largest displacement is 1.
fn next<const N: usize>(
    active: [bool; N],
    gaps: [f64; N],
    lambda: [f64; N],
    load: f64,
) -> (Vec<bool>, usize) {
    with_session(move |session| {
        let sizes = (1.0, JudgeSizes { load, give: 0.0 });
        let comm = session.comm();
        let judged = JudgedRows::new(
            comm,
            &jump(&active),
            (&gaps, &lambda),
            sizes,
            Tuning::DEFAULT.rounding,
            &Tuning::DEFAULT,
        );
        assert!(!judged.contradictory);
        (judged.active.clone(), judged.wrong(comm))
    })
}

#[test]
fn gaps_count_beyond_the_noise_of_rows_that_hold() {
    let active = [true, false, false, false];
    // The row that holds is off by 1e-3: less than three times that may be the sum of such jumps.
    let found = next(
        active,
        [1e-3, 2.9e-3, 3.1e-3, -1.0],
        [1.0, 0.0, 0.0, 0.0],
        0.0,
    );
    assert_eq!(found, (vec![true, false, true, false], 1));
    // Rows that hold exactly leave rounding of the displacements.
    let found = next(active, [0.0, 5e-15, 2e-14, -1.0], [1.0, 0.0, 0.0, 0.0], 0.0);
    assert_eq!(found, (vec![true, false, true, false], 1));
}

#[test]
fn rows_that_pull_leave_unless_it_is_rounding() {
    let active = [true; 3];
    let found = next(active, [0.0; 3], [1.0, -5e-15, -2e-14], 0.0);
    assert_eq!(found, (vec![true, true, false], 1));
    // Beside a load of 4 more is rounding.
    let found = next(active, [0.0; 3], [1.0, -3e-14, -5e-14], 4.0);
    assert_eq!(found, (vec![true, true, false], 1));
}
