//! Unit tests of `src/feti/setup.rs`.

use super::{count, usual_threads};

#[test]
fn ranks_share_the_cores_of_a_machine() {
    assert_eq!(count("0-3,8\n"), Some(5));
    assert_eq!(count("0"), Some(1));
    assert_eq!(count("none"), None);
    assert!(usual_threads(1) >= 1);
    assert_eq!(usual_threads(1 << 20), 1);
}
