//! Rows across motions that count as free.

use super::super::kernel_motion::KernelMotion;
use super::*;

/// A row without its part along motions, and what it was.
fn across(row: &[f64], motions: &[KernelMotion], rounding: f64) -> Vec<f64> {
    let entries = (0..).zip(row).map(|(c, v)| (0, c, *v));
    let rows = KernelRows::from_triplets(1, entries.collect());
    let known = ColumnMap::all(row.len());
    let largest: Vec<f64> = motions.iter().map(KernelMotion::largest).collect();
    let motions = ByColumn::new(&known, motions.iter());
    let out = rows.across(&motions, &largest, |_| rounding);
    out.entries(0).1.to_vec()
}

#[test]
fn what_rounding_does_along_a_free_motion_goes() {
    let turn = KernelMotion(vec![(1, 1.0)]);
    assert_eq!(across(&[1.0, 1e-9], &[turn], 1e-6), [1.0, 0.0]);
    // Most of the motion is elsewhere: here it is rounding.
    let far = KernelMotion(vec![(1, 1e-9), (2, 1.0)]);
    assert_eq!(across(&[1.0, 0.5, 0.0], &[far], 1e-6)[..2], [1.0, 0.5]);
}

/// A slide tilts a ring: the two are one motion, of which a larger one has little. Neither counts by itself.
#[test]
fn parts_of_a_motion_that_cancel_stay_together() {
    let tilt = 1.768e-3;
    let row = [1.0, -1.0, tilt, 0.0];
    let slide = KernelMotion(vec![(1, tilt), (2, 1.0)]);
    let other = KernelMotion(vec![(1, -1.78e-4 * tilt), (2, -1.78e-4), (3, 1.0)]);
    for motions in [vec![slide.clone(), other.clone()], vec![other, slide]] {
        let out = across(&row, &motions, 2e-6);
        for (is, was) in out.iter().zip(&row) {
            assert!((is - was).abs() < 1e-12, "{out:?}");
        }
    }
}
