//! Points of quadrature on the multiplier side, each with the point opposite.

use super::side::MortarSide;
use super::{plane, space};

/// A point of the multiplier side and the point opposite it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MortarSample {
    /// The face of the multiplier side.
    pub face: u32,
    /// Where the point is in the reference cell of that face.
    pub at: [f64; 3],
    /// The face of the other side.
    pub other: u32,
    /// Where the point opposite is in the reference cell of that face.
    pub opposite: [f64; 3],
    /// The weight of the point: lengths in the plane, areas in space.
    pub weight: f64,
}

/// The points of quadrature on the part of `side` that lies opposite `other`, at a distance of `reach` at most along
/// the normals of `side`, by increasing face. Sides face each other where their normals are opposite.
pub fn samples(side: &MortarSide, other: &MortarSide, reach: f64) -> Vec<MortarSample> {
    match side.dim() {
        2 => plane::samples(side, other, reach),
        _ => space::samples(side, other, reach),
    }
}
