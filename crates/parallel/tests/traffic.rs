//! Unit tests of `crates/parallel/src/traffic.rs`.

use super::*;

#[test]
fn counts_are_messages_and_bytes() {
    let traffic = Traffic::of_counts([3, 0, 5].into_iter());
    assert_eq!((traffic.messages, traffic.bytes), (2, 64));
    let before = sent();
    count(traffic);
    count(Traffic::reduction(4));
    let now = sent() - before;
    assert_eq!((now.messages, now.bytes), (2, 64));
    assert_eq!((now.reductions, now.reduced_bytes), (1, 32));
}
