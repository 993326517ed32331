//! Curved bodies: maps that bend a box into shape. Only nodes are mapped; elements stay bilinear (trilinear) between
//! them.

use super::expr::{Expr, Variables};

/// A map of a box.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// Lower left corner of the box.
    pub origin: [f64; 3],
    /// Its edge lengths; 0 in z in the plane.
    pub size: [f64; 3],
    /// The shape into which the box is bent.
    pub shape: BodyShape,
}

/// The shape of a bent box. Angles are in radians.
#[derive(Debug, Clone, PartialEq)]
pub enum BodyShape {
    /// The new coordinates as expressions in the old ones.
    Expressions([Expr; 3]),
    /// A sector of an annulus: x runs from the inner to the outer radius, y along the angle, counter-clockwise; z
    /// stays, so that a solid box becomes a sector of a hollow cylinder.
    Annulus {
        /// Centre in x and y.
        centre: [f64; 2],
        /// Inner and outer radius, 0 < inner < outer.
        radii: [f64; 2],
        /// First and last angle.
        angles: [f64; 2],
    },
    /// A round body that stands on its pole: half a disc in the plane (half a cylinder along z as a solid), or half a
    /// ball. Its curved surface consists of the side `bottom` (`top` if the pole is the highest point) and the adjacent
    /// parts of the other sides.
    Round(Round),
}

/// Half a disc or ball, or the quarter of it beside its axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Round {
    /// Its centre.
    pub centre: [f64; 3],
    /// Its radius, > 0.
    pub radius: f64,
    /// Whether only x ≥ 0 (and z ≥ 0 of a ball) is meshed.
    pub quarter: bool,
    /// A ball; otherwise a disc, or a cylinder along z.
    pub ball: bool,
    /// The pole is the highest point, not the lowest.
    pub upwards: bool,
    /// Grading: node distances from the pole are raised to this power, and elements shrink towards it; 1: no grading.
    pub grading: f64,
    /// Width w of a zone around the pole, as a fraction of the radius, in which elements have about equal size (after
    /// the grading). Beyond it they grow in proportion to the distance. `None`: no such zone.
    pub focus: Option<f64>,
    /// The fraction of the half body that the box covers; 1 is all of it. At 1, two or three sides of the box meet at
    /// angles of 180° on the rim, where elements degenerate; below 1 the flanks are cut off.
    pub trim: f64,
}

impl Map {
    /// The image of a point of the box.
    pub fn apply(&self, point: [f64; 3]) -> [f64; 3] {
        // The relative position in the box: 0 to 1 in each direction.
        let s = [0, 1, 2].map(|d| match self.size[d] {
            0.0 => 0.0,
            size => (point[d] - self.origin[d]) / size,
        });
        match &self.shape {
            BodyShape::Expressions(e) => {
                let at = Variables {
                    point,
                    ..Variables::default()
                };
                [0, 1, 2].map(|d| e[d].eval(&at))
            }
            BodyShape::Annulus {
                centre,
                radii,
                angles,
            } => {
                let r = radii[0] + (radii[1] - radii[0]) * s[0];
                let angle = angles[0] + (angles[1] - angles[0]) * s[1];
                [
                    centre[0] + r * angle.cos(),
                    centre[1] + r * angle.sin(),
                    point[2],
                ]
            }
            BodyShape::Round(round) => round.apply(s, point[2]),
        }
    }
}

impl Round {
    /// A square is mapped onto a disc by (u √(1 − v²/2), v √(1 − u²/2)), a cube onto a ball by the analogous formula;
    /// half of the image is used.
    fn apply(&self, s: [f64; 3], z: f64) -> [f64; 3] {
        let across = |s: f64| {
            let u = if self.quarter { s } else { 2.0 * s - 1.0 };
            // This form is exact at the axis and the rim.
            u.signum() * self.trim * self.spread(u.abs())
        };
        // The mirror image is taken in the box and in space, which preserves the orientation of elements.
        let up = if self.upwards { 1.0 - s[1] } else { s[1] };
        let (u, v) = (across(s[0]), self.spread(up) - 1.0);
        let w = if self.ball { across(s[2]) } else { 0.0 };
        let stretch =
            |a: f64, b: f64| (1.0 - a * a / 2.0 - b * b / 2.0 + a * a * b * b / 3.0).sqrt();
        let [x, y, w] = [u * stretch(v, w), v * stretch(u, w), w * stretch(u, v)];
        let y = if self.upwards { -y } else { y };
        let [cx, cy, cz] = self.centre;
        [
            cx + self.radius * x,
            cy + self.radius * y,
            if self.ball { cz + self.radius * w } else { z },
        ]
    }

    /// Relative distance of a node line from the pole, 0 to 1: w sinh(s arsinh(1/w)) is linear below w, geometric
    /// above.
    fn spread(&self, s: f64) -> f64 {
        let s = s.powf(self.grading);
        match self.focus {
            // Exact at the rim.
            Some(w) if s < 1.0 => w * (s * (1.0 / w).asinh()).sinh(),
            _ => s,
        }
    }
}

#[cfg(test)]
#[path = "../../tests/model/map.rs"]
mod tests;
