//! Unit tests of `src/feti/lifting/block.rs`.

use super::*;

#[test]
fn rows_that_follow_each_other_make_runs() {
    let inside = [true, true, false, true, false, false, true];
    assert_eq!(runs(inside.into_iter()), [0..2, 3..4, 6..7]);
    assert!(runs([false, false].into_iter()).is_empty());
}
