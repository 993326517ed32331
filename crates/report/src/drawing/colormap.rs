//! The colour map Viridis: equal steps look equal, also to colour-blind readers and in grey print.

use super::canvas::Colour;

/// Viridis at 0, 1/16, …, 1 (Smith and van der Walt, public domain).
const VIRIDIS: [Colour; 17] = [
    Colour(0x44, 0x01, 0x54),
    Colour(0x48, 0x18, 0x6a),
    Colour(0x47, 0x2d, 0x7b),
    Colour(0x42, 0x40, 0x86),
    Colour(0x3b, 0x52, 0x8b),
    Colour(0x33, 0x63, 0x8d),
    Colour(0x2c, 0x72, 0x8e),
    Colour(0x26, 0x82, 0x8e),
    Colour(0x21, 0x91, 0x8c),
    Colour(0x1f, 0xa0, 0x88),
    Colour(0x28, 0xae, 0x80),
    Colour(0x3f, 0xbc, 0x73),
    Colour(0x5e, 0xc9, 0x62),
    Colour(0x84, 0xd4, 0x4b),
    Colour(0xad, 0xdc, 0x30),
    Colour(0xd8, 0xe2, 0x19),
    Colour(0xfd, 0xe7, 0x25),
];

/// The colour of t in [0, 1]; outside it the nearer end, grey for NaN.
pub fn viridis(t: f64) -> Colour {
    if t.is_nan() {
        return Colour(0xb0, 0xb0, 0xb0);
    }
    let steps = (VIRIDIS.len() - 1) as f64;
    let x = t.clamp(0.0, 1.0) * steps;
    let k = (x as usize).min(VIRIDIS.len() - 2);
    let s = x - k as f64;
    let mix = |a: u8, b: u8| (f64::from(a) * (1.0 - s) + f64::from(b) * s).round() as u8;
    let (a, b) = (VIRIDIS[k], VIRIDIS[k + 1]);
    Colour(mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
}

#[cfg(test)]
#[path = "../../tests/drawing/colormap.rs"]
mod tests;
