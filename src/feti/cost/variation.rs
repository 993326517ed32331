//! The variation of coefficients inside a body.

use mpi::topology::SimpleCommunicator;

use crate::substructures::Problem;
use parallel::exchange::max_all;

/// Coefficients jump inside a body if the largest is more than this many times the smallest.
pub const JUMPS: f64 = 1e2;

/// The largest ratio of two scaling weights in one body. Collective.
pub fn varies(comm: &SimpleCommunicator, problem: &Problem) -> f64 {
    let n = problem.n_bodies;
    // −smallest is stored beside the largest, so that one reduction is enough.
    let mut ends = vec![f64::NEG_INFINITY; 2 * n];
    for sub in &problem.local {
        for &rho in &sub.rho {
            ends[sub.body] = ends[sub.body].max(rho);
            ends[n + sub.body] = ends[n + sub.body].max(-rho);
        }
    }
    max_all(comm, &mut ends);
    let ratio = |b: usize| ends[b] / -ends[n + b];
    (0..n)
        .map(ratio)
        .filter(|r| r.is_finite())
        .fold(1.0, f64::max)
}
