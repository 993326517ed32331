//! Pairs of bodies that may be near each other, without a look at every pair.

use crate::scene::body::Body;

/// The pairs of bodies whose bounds are at most `slack` apart in x, where `slack` is that of the body further left.
/// Each pair is in increasing order; the pairs are in the order of the sweep.
pub(crate) fn near_in_x(bodies: &[Body], slack: impl Fn(usize) -> f64) -> Vec<[usize; 2]> {
    let left = |b: usize| bodies[b].bounds[0][0];
    let mut order: Vec<usize> = (0..bodies.len()).collect();
    order.sort_by(|&a, &b| left(a).total_cmp(&left(b)).then(a.cmp(&b)));
    let mut out = Vec::new();
    for (k, &a) in order.iter().enumerate() {
        let end = bodies[a].bounds[1][0] + slack(a);
        let behind = order[k + 1..].iter().take_while(|&&b| left(b) <= end);
        out.extend(behind.map(|&b| [a.min(b), a.max(b)]));
    }
    out
}

/// Whether the bounds of two bodies are more than `reach` apart along an axis.
pub(crate) fn are_apart([a, b]: [&Body; 2], reach: f64) -> bool {
    let [x, y] = [&a.bounds, &b.bounds];
    (0..3).any(|d| x[0][d] > y[1][d] + reach || y[0][d] > x[1][d] + reach)
}
