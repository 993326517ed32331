//! How far two sides are apart: along a row, and as far as they are looked for.

use super::side::MortarSide;
use base::linalg::vec3::{dot, minus};

/// Sides may be so many of their longest edges apart where nothing is said.
const FAR: f64 = 4.0;

/// Distances below this part of the coordinates are rounding.
const ROUNDING: f64 = 1e-13;

/// How far along the normals the other side is looked for: `wanted`, or a few edges where that is infinite.
pub fn reach(side: &MortarSide, other: &MortarSide, wanted: f64) -> f64 {
    if wanted.is_finite() {
        wanted
    } else {
        FAR * side.longest().max(other.longest())
    }
}

/// How far the other side is along the normal `n` out of the multiplier side, in the sense of a row with these
/// coefficients of both sides. `places` are the positions of their nodes, `origin` that of the row's node.
pub fn distance<K: Copy>(
    [own, other]: [&[(K, f64)]; 2],
    places: [&dyn Fn(K) -> [f64; 3]; 2],
    origin: [f64; 3],
    n: [f64; 3],
) -> f64 {
    // Positions from the row's node, so that large coordinates cost no digits.
    let along = |place: &dyn Fn(K) -> [f64; 3], list: &[(K, f64)]| {
        let each = list
            .iter()
            .map(|&(k, v)| v * dot(minus(place(k), origin), n));
        each.sum::<f64>()
    };
    let distance = along(places[1], other) - along(places[0], own);
    let size = origin.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
    if distance.abs() <= ROUNDING * size {
        0.0
    } else {
        distance
    }
}

#[cfg(test)]
#[path = "../../tests/mortar/distance.rs"]
mod tests;
