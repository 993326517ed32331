//! Unit tests of `crates/report/src/json/compare.rs`.

use super::*;

#[test]
fn what_is_not_known_is_null() {
    let nothing = PhaseSeconds {
        assemble: Some(0.5),
        setup: Some(f64::NAN),
        solve: None,
        total: Some(1.0),
    };
    assert_eq!(
        serde_json::to_string(&nothing).unwrap(),
        r#"{"assemble":0.5,"setup":null,"solve":null,"total":1.0}"#
    );
}
