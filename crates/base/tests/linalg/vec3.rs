//! Unit tests of `crates/base/src/linalg/vec3.rs`.

use super::*;

#[test]
fn products_and_lengths() {
    let (a, b) = ([1.0, 2.0, 2.0], [3.0, 0.0, 4.0]);
    assert_eq!((dot(a, b), norm(a), norm(b)), (11.0, 3.0, 5.0));
    assert_eq!(minus(b, a), [2.0, -2.0, 2.0]);
    let c = cross(a, b);
    assert_eq!(c, [8.0, 2.0, -6.0]);
    assert_eq!((dot(a, c), dot(b, c)), (0.0, 0.0));
    assert_eq!(
        ball([[0.0, 1.0, 2.0], [4.0, 5.0, 4.0]]),
        ([2.0, 3.0, 3.0], 3.0)
    );
}
