//! Whether deflation is worth its cost where many bodies float.
//!
//! F W and F Q G are renewed whenever rows switch. Columns that are near each other take products of their own, so that
//! their number is that of the columns around one body: in space a thousand products, each of them half of an
//! iteration. X and Wᵀ Pᵀ F P W are dense. A few iterations more are cheaper than that, thousands of them are not.

use crate::feti::projector::gram::FEW;
use crate::feti::projector::graph::BodyGraph;
use crate::feti::settings::Adaptive;
use crate::linalg::sorted::distinct;

/// With more rigid motions than this the dense matrices take more than a gigabyte, and minutes.
const MOST: usize = 4000;

/// Vectors of a body for each of its rigid motions: coefficients that jump by 10³ from element to element have about so
/// many eigenvalues above 10.
const VECTORS: f64 = 1.0;

/// ln(2/ε) of a solve, in the mean over the steps of a contact loop: nearly all of them are loose.
const REDUCTION: f64 = 7.0;

/// Number of bodies that are looked at.
const LOOKED_AT: usize = 64;

/// The eigenvalue λ from which deflation takes less time than it saves, by the iterations of CG with κ = λ,
///
/// ```text
///     ½ √λ ln(2/ε) − ½ √(1.5 τ) ln(2/ε)  >  the products with F / 2
/// ```
///
/// and zero with few motions, where it costs little. `start` has the first rigid motion of each body, `wide` says that
/// Q leads to the rows of neighbours. The same on every rank.
pub fn from(graph: &BodyGraph, start: &[usize], wide: bool) -> f64 {
    let r = start.last().copied().unwrap_or(0);
    if r <= FEW {
        return 0.0;
    }
    if r > MOST {
        return f64::INFINITY;
    }
    // Two columns can share a product if neither reaches what is near the other's rows.
    let rings = if wide { 3 } else { 2 };
    let motions = |&b: &u32| start[b as usize + 1] - start[b as usize];
    let step = graph.n.div_ceil(LOOKED_AT);
    let around = (0..graph.n as u32).step_by(step).map(|body| {
        let ball = (0..rings).fold(vec![body], |ball, _| graph.around(&ball));
        distinct(ball).iter().map(motions).sum::<usize>()
    });
    let products = (1.0 + VECTORS) * around.max().unwrap_or(0) as f64;
    let usual = (1.5 * Adaptive::USUAL).sqrt();
    (products / REDUCTION + usual).powi(2)
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/deflation/worth.rs"]
mod tests;
