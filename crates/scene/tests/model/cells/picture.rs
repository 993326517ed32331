//! Unit tests of `crates/scene/src/model/cells/picture.rs`.

use super::*;

#[test]
fn black_and_white_are_exact_and_grey_lies_between() {
    for tone in [Tone::Linear, Tone::Log] {
        assert_eq!(value(0.0, [1e-3, 1e3], tone), 1e-3);
        assert_eq!(value(1.0, [1e-3, 1e3], tone), 1e3);
        // The values may be in any order.
        assert_eq!(value(0.0, [5.0, 0.1], tone), 5.0);
    }
    assert_eq!(value(0.25, [1.0, 5.0], Tone::Linear), 2.0);
    assert!((value(0.5, [1e-3, 1e3], Tone::Log) - 1.0).abs() < 1e-14);
    assert!((value(0.25, [1.0, 1e4], Tone::Log) - 10.0).abs() < 1e-13);
}
