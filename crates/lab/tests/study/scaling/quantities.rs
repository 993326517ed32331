//! Unit tests of `crates/lab/src/study/scaling/quantities.rs`.

use super::*;

#[test]
fn places_and_names_belong_together() {
    let work = Work::from_fn(|k| k as f64);
    assert_eq!(work.all()[12], work.kernels);
    assert_eq!(Work::NAMES[12], "r");
    assert_eq!(SetupSeconds::from_fn(|_| 2.0).sum(), 14.0);
    assert_eq!(IterationSeconds::from_fn(|k| k as f64).reduction, 5.0);
}
