//! Unit tests of `src/feti/deflation/profitability.rs`.

use super::*;
use base::linalg::lists::Lists;

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
        at: None,
        near: (0..n * n).map(near).collect(),
    };
    (graph, (0..=n * n).map(|k| motions * k).collect())
}

fn of(n: usize, motions: usize, wide: bool, contact: bool) -> f64 {
    let (graph, start) = square(n, motions);
    from(&graph, &start, ProblemKind { wide, contact })
}

#[test]
fn few_motions_cost_little() {
    assert_eq!(of(7, 3, true, true), 0.0);
    // Springs hold all bodies: 144 of them are few, 169 are not.
    assert_eq!(of(12, 0, true, true), 0.0);
    assert!(of(13, 0, true, true) > 100.0);
    assert_eq!(of(50, 0, true, true), f64::INFINITY);
}

#[test]
fn the_cost_is_that_of_what_is_near() {
    // Three rings around a body are 7 × 7 bodies, two 5 × 5, however many bodies there are: 20 · 25 products and those
    // of five vectors in the search, five vectors and three motions of each body in a renewal.
    let (search, renewal) = (500.0 + 245.0, 245.0 + 147.0);
    let expected = |products: f64, ln: f64| (products / ln + 15.0f64.sqrt()).powi(2);
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-9 * b, "{a} {b}");
    close(of(20, 3, true, false), expected(search + renewal, 14.5));
    close(of(20, 3, true, true), expected(search / 8.0 + renewal, 7.0));
    assert_eq!(of(30, 3, true, true), of(20, 3, true, true));
    assert!(of(20, 3, false, true) < of(20, 3, true, true));
    assert!(of(20, 1, true, true) < of(20, 3, true, true));
    assert_eq!(of(50, 3, true, true), f64::INFINITY);
}
