//! Unit tests of `crates/report/src/pace.rs`.

use super::*;

#[test]
fn the_rest_takes_as_long_as_what_is_done() {
    let after = |seconds, done, parts| left(Duration::from_secs(seconds), done, parts);
    assert_eq!(after(5, 0, 10), None);
    assert_eq!(after(5, 10, 10), None);
    assert_eq!(after(6, 3, 10).as_deref(), Some("about 14 s left"));
    assert_eq!(after(600, 1, 3).as_deref(), Some("about 20 min left"));
    assert_eq!(after(7200, 1, 3).as_deref(), Some("about 4.0 h left"));
    assert_eq!(after(1, 9, 10).as_deref(), Some("less than 1 s left"));
}
