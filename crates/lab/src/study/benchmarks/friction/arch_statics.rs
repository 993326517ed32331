//! Limit analysis of a semicircular arch of rigid voussoirs: a reference that knows nothing of elements.
//!
//! The arch has the radius 1 at its centre line, the thickness t and n voussoirs, each a row of m trapezia between the
//! circles 1 ± t/2 (the shape that elements give it). Half of an arch is in equilibrium under its weight, the force
//! H at the crown, at the height K/H, and the reaction at a joint. Let W be the weight between the joint and the crown,
//! M its moment about the centre of the arch, and θ the angle of the joint from the springing. The reaction is then
//! (−H, W), and
//!
//! ```text
//!     inside the joint    K − y_i H + M − x_i W ≥ 0,   K − y_o H + M − x_o W ≤ 0
//!     no sliding          |W sin θ − H cos θ| ≤ μ (W cos θ + H sin θ)
//! ```
//!
//! with (x_i, y_i) and (x_o, y_o) the ends of the joint. By the static theorem the arch stands (as long as nothing
//! slides) if and only if some (H, K) satisfies all of them. They are linear; a region in the plane has a corner, or
//! none: all pairs are tried.

use std::f64::consts::{FRAC_PI_2, PI};

/// An arch; the radius of its centre line is 1.
#[derive(Debug, Clone, Copy)]
pub struct Arch {
    /// Thickness.
    pub thickness: f64,
    /// The number of voussoirs.
    pub voussoirs: usize,
    /// Trapezia in a voussoir.
    pub parts: usize,
}

/// a H + b K ≤ c.
type HalfPlane = [f64; 3];

impl Arch {
    /// The inner and the outer radius.
    pub fn radii(self) -> [f64; 2] {
        [1.0 - 0.5 * self.thickness, 1.0 + 0.5 * self.thickness]
    }

    /// Weight, and moment about the centre, of what lies between the angle of the joint `j` and the crown.
    fn above(self, j: usize) -> [f64; 2] {
        let [inner, outer] = self.radii();
        let angle = PI / (self.voussoirs * self.parts) as f64;
        // A trapezium between two chords: its area, and how far its centroid is from the centre of the arch.
        let (cos, sin) = ((0.5 * angle).cos(), (0.5 * angle).sin());
        let area = (outer * outer - inner * inner) * cos * sin;
        let height = (outer - inner) * cos;
        let centroid = inner * cos + height * (inner + 2.0 * outer) / (3.0 * (inner + outer));
        let mut sums = [0.0; 2];
        for k in j * self.parts..self.voussoirs * self.parts {
            let middle = (k as f64 + 0.5) * angle;
            if middle < FRAC_PI_2 - 1e-9 {
                sums[0] += area;
                sums[1] += area * centroid * middle.cos();
            } else if middle < FRAC_PI_2 + 1e-9 {
                // Half of the one at the crown.
                let squares = inner * inner + inner * outer + outer * outer;
                sums[0] += 0.5 * area;
                sums[1] += 0.5 * area * sin * squares / (3.0 * (inner + outer));
            }
        }
        sums
    }

    fn half_planes(self, friction: f64) -> Vec<HalfPlane> {
        let [inner, outer] = self.radii();
        let mut out = Vec::new();
        for j in 0..=self.voussoirs / 2 {
            let (sin, cos) = (PI * j as f64 / self.voussoirs as f64).sin_cos();
            let [weight, moment] = self.above(j);
            out.push([inner * sin, -1.0, moment - inner * cos * weight]);
            out.push([-outer * sin, 1.0, outer * cos * weight - moment]);
            let bound = friction * weight * cos;
            out.push([-cos - friction * sin, 0.0, bound - weight * sin]);
            out.push([cos - friction * sin, 0.0, bound + weight * sin]);
        }
        out
    }

    /// The weight of the whole arch.
    pub fn weight(self) -> f64 {
        2.0 * self.above(0)[0]
    }

    /// Whether its weight can be carried with this coefficient of friction.
    pub fn stands(self, friction: f64) -> bool {
        let planes = self.half_planes(friction);
        let inside = |[h, k]: [f64; 2]| {
            let keeps = |[a, b, c]: &HalfPlane| a * h + b * k <= c + 1e-12;
            planes.iter().all(keeps)
        };
        let corner = |p: &HalfPlane, q: &HalfPlane| {
            let det = p[0] * q[1] - p[1] * q[0];
            let at = [p[2] * q[1] - p[1] * q[2], p[0] * q[2] - p[2] * q[0]];
            (det.abs() > 1e-12).then(|| at.map(|x| x / det))
        };
        let mut pairs = (planes.iter().enumerate()).flat_map(|(k, p)| {
            let later = planes[..k].iter();
            later.filter_map(move |q| corner(p, q))
        });
        pairs.any(inside)
    }

    /// The least thickness of this arch with this coefficient of friction.
    pub fn least_thickness(self, friction: f64) -> f64 {
        let with = |thickness| Arch { thickness, ..self };
        bisect([0.02, 0.5], |t| with(t).stands(friction))
    }

    /// The least coefficient of friction with which it stands.
    pub fn least_friction(self) -> f64 {
        bisect([0.0, 2.0], |friction| self.stands(friction))
    }
}

/// Where a condition begins to hold.
fn bisect([mut low, mut high]: [f64; 2], holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..48 {
        let middle = 0.5 * (low + high);
        if holds(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}

#[cfg(test)]
#[path = "../../../../tests/study/benchmarks/arch_statics.rs"]
mod tests;
