//! The bilinear element on a rectangle.
//!
//! Its four nodes are numbered lower left, lower right, upper left, upper right: node a lies at
//! (a mod 2, a div 2) of the unit square.

/// How loads are integrated over an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Quadrature {
    /// One point in the middle: exact for regions whose borders follow the elements.
    #[default]
    Midpoint,
    /// The 2 × 2 (× 2) Gauss rule.
    Gauss,
}

/// Stiffness of −Δ on a rectangle of width `dx` and height `dy`:
/// `K[a][b]` = ∫ ∇N_a·∇N_b = (dy/dx) D(x) M(y) + (dx/dy) M(x) D(y), with D = [1 −1; −1 1] and M = [2 1; 1 2]/6.
pub fn stiffness(dx: f64, dy: f64) -> [[f64; 4]; 4] {
    let d = |a: usize, b: usize| if a == b { 1.0 } else { -1.0 };
    let m = |a: usize, b: usize| if a == b { 1.0 / 3.0 } else { 1.0 / 6.0 };
    let mut k = [[0.0; 4]; 4];
    for (a, row) in k.iter_mut().enumerate() {
        for (b, entry) in row.iter_mut().enumerate() {
            let (ax, ay, bx, by) = (a % 2, a / 2, b % 2, b / 2);
            *entry = dy / dx * d(ax, bx) * m(ay, by) + dx / dy * m(ax, bx) * d(ay, by);
        }
    }
    k
}

/// The two-point Gauss rule on \[0,1\]: (point, weight), exact for cubics.
pub const GAUSS2: [(f64, f64); 2] = [
    (0.211_324_865_405_187_1, 0.5),
    (0.788_675_134_594_812_9, 0.5),
];

/// The four-point Gauss rule on \[0,1\]: (point, weight), exact for degree 7.
pub const GAUSS4: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

#[cfg(test)]
#[path = "../tests/q1.rs"]
mod tests;
