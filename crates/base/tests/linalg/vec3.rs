//! Unit tests of `crates/base/src/linalg/vec3.rs`.

use super::*;

#[test]
fn tangents_are_perpendicular_unit_vectors() {
    assert_eq!(tangents([0.0, 1.0, 0.0], 2), [[-1.0, 0.0, 0.0]]);
    for n in [[0.0, 1.0, 0.0], [0.6, 0.0, -0.8], [2.0, -1.0, 2.0]] {
        let n = unit(n).expect("not 0");
        let [a, b] = tangents(n, 3).try_into().expect("two");
        for (x, y, value) in [
            (a, n, 0.0),
            (b, n, 0.0),
            (a, b, 0.0),
            (a, a, 1.0),
            (b, b, 1.0),
        ] {
            assert!((dot(x, y) - value).abs() < 1e-15, "{n:?}: {a:?}, {b:?}");
        }
    }
}

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
