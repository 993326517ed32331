//! Whether deflation is worth its cost where bodies are many.
//!
//! F W and F Q G are renewed whenever rows switch. Columns that are near each other take products of their own, so that
//! their number is that of the columns around one body: in space a thousand products, each of them half of an
//! iteration. X and Wᵀ Pᵀ F P W are dense. A few iterations more are cheaper than that, thousands of them are not.

use crate::feti::projector::gram::FEW;
use crate::feti::projector::graph::BodyGraph;
use crate::feti::settings::Adaptive;

/// Dense matrices of more rows than this take more than a gigabyte, and minutes.
const MOST: usize = 10_000;

/// Vectors of a body: where coefficients jump from element to element there are from one to six.
const VECTORS: f64 = 5.0;

/// Expansions of the Krylov spaces of a search.
const EXPANSIONS: f64 = 20.0;

/// Steps of a contact loop that share the cost of a search.
const STEPS: f64 = 8.0;

/// ln(2/ε) of a solve: to 1e-6, and in the mean over the steps of a contact loop, of which nearly all are loose.
const REDUCTION: f64 = 14.5;
const REDUCTION_IN_STEPS: f64 = 7.0;

/// Number of bodies that are looked at.
const LOOKED_AT: usize = 64;

/// The kind of problem.
#[derive(Debug, Clone, Copy)]
pub struct ProblemKind {
    /// Whether Q leads to the rows of neighbours.
    pub wide: bool,
    /// Whether rows switch, and F W and F Q G are renewed with them.
    pub contact: bool,
}

/// Whether deflation of so few bodies and rigid motions costs little.
pub fn is_cheap(bodies: usize, r: usize) -> bool {
    bodies.max(r) <= FEW
}

/// Whether deflation is never worth its cost, whatever the graph of so many bodies and rigid motions.
pub fn is_never(bodies: usize, r: usize) -> bool {
    !is_cheap(bodies, r) && VECTORS * bodies as f64 + r as f64 > MOST as f64
}

/// The eigenvalue λ from which deflation takes less time than it saves, by the iterations of CG with κ = λ,
///
/// ```text
///     ½ √λ ln(2/ε) − ½ √(1.5 τ) ln(2/ε)  >  the products with F and M⁻¹ / 2
/// ```
///
/// and zero where it [is cheap](is_cheap). `start` has the first rigid motion of each body. The same on every rank.
pub fn from(graph: &BodyGraph, start: &[usize], problem: ProblemKind) -> f64 {
    let r = start.last().copied().unwrap_or(0);
    if is_cheap(graph.n, r) {
        return 0.0;
    }
    if is_never(graph.n, r) {
        return f64::INFINITY;
    }
    // Two columns can share a product if neither reaches what is near the other's rows.
    let rings = if problem.wide { 3 } else { 2 };
    let step = graph.n.div_ceil(LOOKED_AT);
    let (mut near, mut bodies, mut motions) = (0, 0, 0);
    for body in (0..graph.n as u32).step_by(step) {
        let ball = |rings: usize| (0..rings).fold(vec![body], |ball, _| graph.around(&ball));
        let around = ball(rings);
        near = near.max(ball(2).len());
        bodies = bodies.max(around.len());
        let of = |&b: &u32| start[b as usize + 1] - start[b as usize];
        motions = motions.max(around.iter().map(of).sum::<usize>());
    }
    // M⁻¹ with a column of each colour in each expansion, and with the vectors; F W and F Q G.
    let vectors = VECTORS * bodies as f64;
    let search = EXPANSIONS * near as f64 + vectors;
    let renewal = vectors + motions as f64;
    let (products, reduction) = if problem.contact {
        (search / STEPS + renewal, REDUCTION_IN_STEPS)
    } else {
        (search + renewal, REDUCTION)
    };
    (products / reduction + (1.5 * Adaptive::USUAL).sqrt()).powi(2)
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/deflation/profitability.rs"]
mod tests;
