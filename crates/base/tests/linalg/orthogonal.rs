//! Unit tests of `crates/base/src/linalg/orthogonal.rs`.

use super::*;
use crate::matrices::random;

/// A product of reflections at planes: a rotation if their number is even.
fn reflections(normals: &[[f64; 3]]) -> Matrix {
    let mirror = |n: &[f64; 3]| {
        let square = dot(*n, *n);
        [0, 1, 2].map(|i| [0, 1, 2].map(|j| IDENTITY[i][j] - 2.0 * n[i] * n[j] / square))
    };
    normals
        .iter()
        .fold(IDENTITY, |q, n| product(&q, &mirror(n)))
}

fn largest(a: &Matrix, b: &Matrix) -> f64 {
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.fold(0.0, |far, (a, b)| far.max((a - b).abs()))
}

#[test]
fn turns_and_mirrors_are_found_in_space_and_in_the_plane() {
    let noise = random(300, 3);
    let points: Vec<[f64; 3]> = noise.chunks(3).map(|c| [c[0], c[1], c[2]]).collect();
    let normals = [[1.0, 0.3, -0.2], [0.4, -1.0, 0.7], [0.1, 0.2, 1.0]];
    for count in 0..=3 {
        for dim in [2, 3] {
            let normals = normals.map(|n| [n[0], n[1], if dim == 2 { 0.0 } else { n[2] }]);
            let count = if dim == 2 { count.min(2) } else { count };
            let q = reflections(&normals[..count]);
            let flat = |p: [f64; 3]| [p[0], p[1], if dim == 2 { 0.0 } else { p[2] }];
            let moved = |p: [f64; 3]| {
                let y = times(&q, flat(p));
                [y[0] + 5.0, y[1] - 2.0, y[2] + 0.5]
            };
            let pair = |k: usize| [flat(points[k]), moved(points[k])];
            let found = fit(points.len(), dim, pair).expect("congruent");
            assert!(largest(&found.q, &q) < 1e-14, "{dim} {count}: {found:?}");
            assert!(found.far < 1e-14, "{dim} {count}: {found:?}");
            if count == 0 {
                assert_eq!(found.q, IDENTITY);
            }
            // One point beside its place is seen.
            let wrong = |k: usize| {
                let [x, mut y] = pair(k);
                y[0] += if k == 7 { 1e-6 } else { 0.0 };
                [x, y]
            };
            let found = fit(points.len(), dim, wrong).expect("nearly congruent");
            assert!((3e-7..3e-6).contains(&found.far), "{found:?}");
        }
    }
}

#[test]
fn a_needle_is_placed_as_well_as_a_ball() {
    let noise = random(300, 5);
    let needle = |c: &[f64]| [100.0 * c[0], c[1], c[2]];
    let points: Vec<[f64; 3]> = noise.chunks(3).map(needle).collect();
    let q = reflections(&[[1.0, 2.0, 3.0], [-2.0, 1.0, 0.5]]);
    let pair = |k: usize| [points[k], times(&q, points[k])];
    let found = fit(points.len(), 3, pair).expect("congruent");
    assert!(largest(&found.q, &q) < 1e-13, "{found:?}");
}

#[test]
fn flat_points_and_other_shapes_have_no_fit() {
    let noise = random(300, 9);
    let points: Vec<[f64; 3]> = noise.chunks(3).map(|c| [c[0], c[1], c[2]]).collect();
    let flat = |k: usize| [[points[k][0], points[k][1], 0.0]; 2];
    assert_eq!(fit(points.len(), 3, flat), None);
    assert!(fit(points.len(), 2, flat).is_some());
    let other = |k: usize| [points[k], points[(7 * k + 3) % points.len()]];
    assert!(fit(points.len(), 3, other).is_none_or(|f| f.far > 0.1));
    assert_eq!(fit(0, 3, flat), None);
}
