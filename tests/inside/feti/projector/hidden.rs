//! Unit tests of `src/feti/projector/hidden.rs`.

use super::*;
use crate::feti::projector::gram_pattern::{FactorSharing, GramPattern};
use crate::feti::projector::pattern::meeting;
use crate::feti::projector::rows::KernelRows;
use crate::testing::with_session;

/// Bodies with two motions each, more than dense algebra is for: a chain, and a last one that meets them all, so that
/// its columns are eliminated last.
const BODIES: u32 = 100;

/// Entry `c` of the motion that the rows do not hold; the last body moves by the part `slow`.
fn free(slow: f64, c: u32) -> f64 {
    if c / 2 == BODIES - 1 {
        slow * (1.0 + f64::from(c % 2))
    } else {
        1.0 + 0.3 * f64::from(c % 3)
    }
}

/// Three rows between bodies that meet, which do no work on that motion.
fn rows(slow: f64) -> KernelRows {
    let mut entries = Vec::new();
    let mut row = 0;
    for a in 0..BODIES - 1 {
        let others = [a + 1, BODIES - 1];
        for b in others.into_iter().take(if a + 2 < BODIES { 2 } else { 1 }) {
            for k in 0..3 {
                let angle = 0.3 + f64::from(k) + 0.01 * f64::from(a);
                let values = [1.0, 1.7, 2.3, 2.9].map(|by: f64| (by * angle).cos());
                let columns = [2 * a, 2 * a + 1, 2 * b, 2 * b + 1];
                let motion = columns.map(|c| free(slow, c));
                let square: f64 = motion.iter().map(|m| m * m).sum();
                let work: f64 = motion.iter().zip(values).map(|(m, v)| m * v).sum();
                for (i, &c) in columns.iter().enumerate() {
                    entries.push((row, c, values[i] - work / square * motion[i]));
                }
                row += 1;
            }
        }
    }
    KernelRows::from_triplets(row as usize, entries)
}

/// A column of the chain is left out in the beginning: the motion is found all the same, and nothing else is.
/// (Motions that no pivot shows are those of tests/scenes/hidden_motions.rs.)
#[test]
fn the_motion_of_a_column_that_is_left_out_is_found() {
    with_session(|session| {
        let comm = session.comm();
        let start: Vec<usize> = (0..=BODIES as usize).map(|b| 2 * b).collect();
        for slow in [1e-1, 1e-2, 1e-3, 1e-4] {
            let g = rows(slow);
            let shape = GramPattern::new(
                comm,
                &meeting(comm, &g, &g, &start),
                &start,
                &FactorSharing::any(),
            );
            let product = shape.product(comm, &g, &g, |_| true);
            let gram = Gram::without(&shape, product, (&[0], &[]));
            assert_eq!(gram.dropped, [0]);
            let [motion] = &gram.unheld[..] else {
                panic!("{} motions", gram.unheld.len());
            };
            let scale = motion.largest() / 1.6;
            for &(c, v) in &motion.0 {
                let off = (v.abs() / scale - free(slow, c)).abs();
                assert!(off < 1e-7, "{slow}, column {c}: off by {off}");
            }
            assert!(gram.weakest().is_none(), "{slow}");
        }
    });
}

/// A motion that a single weak row holds is none.
#[test]
fn what_a_row_holds_is_no_motion() {
    with_session(|session| {
        let comm = session.comm();
        let g = rows(1e-1);
        let n = g.n() as u32;
        let mut entries: Vec<(u32, u32, f64)> = Vec::new();
        for i in 0..g.n() {
            entries.extend(g.row(i).map(|(c, v)| (i as u32, c as u32, v)));
        }
        entries.push((n, 0, 1e-3));
        let g = KernelRows::from_triplets(g.n() + 1, entries);
        let start: Vec<usize> = (0..=BODIES as usize).map(|b| 2 * b).collect();
        let shape = GramPattern::new(
            comm,
            &meeting(comm, &g, &g, &start),
            &start,
            &FactorSharing::any(),
        );
        let gram = Gram::new(&shape, shape.product(comm, &g, &g, |_| true));
        assert!(gram.unheld.is_empty() && gram.weakest().is_none());
    });
}
