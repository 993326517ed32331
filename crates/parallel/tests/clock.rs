//! Unit tests of `crates/parallel/src/clock.rs`.

use super::*;

#[test]
fn one_clock_runs_at_a_time() {
    let before = spent();
    let answer = timed(Phase::Lifting, || {
        std::thread::sleep(std::time::Duration::from_millis(2));
        42
    });
    let now = spent().since(&before);
    assert_eq!(answer, 42);
    assert!(now.of(Phase::Lifting) >= 2e-3);
    assert_eq!(now.of(Phase::Natural), 0.0);
    let mut twice = now;
    twice.add(&now);
    assert_eq!(twice.of(Phase::Lifting), 2.0 * now.of(Phase::Lifting));
}
