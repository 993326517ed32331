//! Unit tests of `src/feti/deflation/worth.rs`.

use super::*;
use crate::linalg::lists::Lists;

/// A square of n × n bodies with `motions` rigid motions each; every body is near the eight around it.
fn square(n: usize, motions: usize) -> (BodyGraph, Vec<usize>) {
    let near = |k: usize| {
        let (i, j) = (k / n, k % n);
        let along = |c: usize| c.saturating_sub(1)..(c + 2).min(n);
        let all = along(i).flat_map(|p| along(j).map(move |q| (p * n + q) as u32));
        all.collect()
    };
    let graph = BodyGraph {
        n: n * n,
        terms: Lists::default(),
        touched: Lists::default(),
        near: (0..n * n).map(near).collect(),
    };
    (graph, (0..=n * n).map(|k| motions * k).collect())
}

#[test]
fn few_motions_cost_little() {
    let (graph, start) = square(7, 3);
    assert_eq!(from(&graph, &start, true), 0.0);
}

#[test]
fn the_cost_is_that_of_what_is_near() {
    let of = |n: usize, motions: usize, wide: bool| {
        let (graph, start) = square(n, motions);
        from(&graph, &start, wide)
    };
    // Three rings around a body are 7 × 7 bodies: 2 · 3 · 49 products, however many bodies there are.
    let expected = (294.0 / 7.0 + 15.0f64.sqrt()).powi(2);
    assert!((of(20, 3, true) - expected).abs() < 1e-9 * expected);
    assert_eq!(of(30, 3, true), of(20, 3, true));
    assert!(of(20, 3, false) < of(20, 3, true));
    assert!(of(20, 1, true) < of(20, 3, true));
    assert_eq!(of(50, 3, true), f64::INFINITY);
}
