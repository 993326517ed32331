//! Unit tests of `crates/base/src/linalg/similar.rs`.

use super::*;

/// Three blocks that nothing but multiples of the identity commutes with.
const BLOCKS: [Matrix; 3] = [
    [[4.0, 1.0, 0.5], [1.0, 3.0, 0.2], [0.5, 0.2, 5.0]],
    [[-1.0, 0.4, 0.3], [0.7, -2.0, 0.1], [-0.2, 0.6, -1.5]],
    [[0.1, -0.3, 0.0], [0.2, 0.4, 0.9], [0.5, 0.0, -0.6]],
];

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    a.map(|row| [0, 1, 2].map(|j| (0..3).map(|k| row[k] * b[k][j]).sum()))
}

fn transposed(a: &Matrix) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| a[j][i]))
}

fn found(size: usize, q: &Matrix) -> Matrix {
    let pair = |k: usize| {
        let mut a = BLOCKS[k];
        a[size..].iter_mut().for_each(|row| row.fill(0.0));
        a.iter_mut().for_each(|row| row[size..].fill(0.0));
        let b = product(&product(q, &a), &transposed(q));
        [a, b.map(|row| row.map(|v| 2.5 * v))]
    };
    similarity(3, size, 2.5, pair).expect("similar blocks")
}

#[test]
fn turns_and_reflections_are_found_up_to_their_sign() {
    let (c, s) = (0.3f64.cos(), 0.3f64.sin());
    for (size, q) in [
        (2, [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]),
        (2, [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
        (3, [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, -1.0]]),
        (3, [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
    ] {
        let found = found(size, &q);
        for (row, expected) in found.iter().zip(q) {
            for (v, e) in row.iter().zip(expected) {
                assert!((v - e).abs() < 1e-14, "{found:?}");
            }
        }
    }
    let mirrored = [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let other = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]];
    assert_eq!(found(3, &mirrored), other);
}

#[test]
fn blocks_that_are_not_similar_do_not_fit() {
    let pair = |k: usize| [BLOCKS[k], BLOCKS[(k + 1) % 3]];
    if let Some(q) = similarity(3, 3, 1.0, pair) {
        let far = (0..3).map(|k| {
            let [a, b] = pair(k);
            let (left, right) = (product(&b, &q), product(&q, &a));
            let entries = left.iter().flatten().zip(right.iter().flatten());
            entries.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
        });
        assert!(far.fold(0.0, f64::max) > 0.1);
    }
}
