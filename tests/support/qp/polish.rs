//! The step from a point near the solution to the solution: solves the equations on the active set, and exchanges rows
//! until all signs are right.

use super::kkt::System;
use super::scaled::Point;
use super::{Qp, Row};
use std::collections::HashSet;

/// Values below this count as zero, relative to the largest entries of u and λ, and to the data.
const ZERO: f64 = 2e-12;

/// Exchanges of single rows after which the sets are taken to cycle.
const MOST_EXCHANGES: usize = 30;

/// The solution on the active set of `p`.
///
/// The equations are solved for the smallest change of `p`. Where rows are dependent, multipliers are not unique; those
/// of an interior point method are positive on every row that can carry force, and remain so. `epsilon` is that of
/// [`System`]. `None`: no active set near `p` fits.
pub fn polish(qp: &Qp, mut p: Point, epsilon: f64) -> Option<Point> {
    let (n, ne, ni) = (qp.f.len(), qp.equal.len(), qp.below.len());
    let mut closed: Vec<bool> = (0..ni).map(|k| p.below[k] > p.slack[k]).collect();
    let mut seen = HashSet::new();
    // The data have size one and the diagonal is one: small values are compared with 1.
    let largest = |v: &[f64]| v.iter().fold(1.0f64, |m, v| m.max(v.abs()));
    // Rows are exchanged all at once, and one by one, the first of those that are wrong, where that cycles: Murty's
    // least-index rule.
    let (mut one_by_one, mut exchanges) = (false, 0);
    loop {
        if !one_by_one && !seen.insert(closed.clone()) {
            one_by_one = true;
        }
        exchanges += usize::from(one_by_one);
        if exchanges > MOST_EXCHANGES {
            return None;
        }
        let active: Vec<usize> = (0..ni).filter(|&k| closed[k]).collect();
        let held = active.iter().map(|&k| &qp.below[k]);
        let rows: Vec<&Row> = qp.equal.iter().chain(held).collect();
        let sides: Vec<f64> = rows.iter().map(|r| r.rhs).collect();
        let b: Vec<f64> = qp.f.iter().copied().chain(sides).collect();
        let mut system = System::new(qp, rows, epsilon);
        if !system.factor(&vec![0.0; ne + active.len()]) {
            return None;
        }
        // The multipliers to start from are the smallest part of those of `p` that leads to the right signs: rows
        // implied by equations may carry any force, and large forces that cancel cost digits.
        let mut x = Vec::new();
        for part in [0.0, 1e-6, 1e-4, 1e-2, 1.0] {
            x.clone_from(&p.u);
            x.extend(p.equal.iter().map(|l| part * l));
            x.extend(active.iter().map(|&k| part * p.below[k]));
            system.refine(&b, &mut x, 100);
            let force = largest(&x[n..]);
            if x[n + ne..].iter().all(|&l| l >= -ZERO * force) {
                break;
            }
        }
        p.u.copy_from_slice(&x[..n]);
        p.equal.copy_from_slice(&x[n..n + ne]);
        p.below.fill(0.0);
        for (&k, l) in active.iter().zip(&x[n + ne..]) {
            p.below[k] = *l;
        }

        let length = largest(&p.u).max(largest(&b[n..]));
        let force = largest(&p.below).max(largest(&p.equal));
        let wrong: Vec<usize> = (0..ni)
            .filter(|&k| {
                if closed[k] {
                    p.below[k] < -ZERO * force
                } else {
                    qp.below[k].times(&p.u) - qp.below[k].rhs > ZERO * length
                }
            })
            .collect();
        if wrong.is_empty() {
            for k in 0..ni {
                p.below[k] = p.below[k].max(0.0);
                p.slack[k] = qp.below[k].rhs - qp.below[k].times(&p.u);
            }
            p.closed = active;
            return Some(p);
        }
        let count = if one_by_one { 1 } else { wrong.len() };
        wrong
            .into_iter()
            .take(count)
            .for_each(|k| closed[k] = !closed[k]);
    }
}
