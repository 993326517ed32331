//! Rigid obstacles of elastic bodies: plane, cylinder, sphere, points, as distance and normal.

use base::linalg::vec3::{dot, minus, norm};

/// A rigid body that elastic bodies cannot enter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rigid {
    /// The half space on the far side of a plane.
    Plane {
        /// A point of the plane.
        point: [f64; 3],
        /// The unit normal, towards the side that is free.
        normal: [f64; 3],
    },
    /// A plane of its own behind each node, through where the node is to begin with.
    Behind {
        /// The unit normal, towards the side that is free.
        normal: [f64; 3],
        /// Which ground it is: a point of the file of the bodies that no cell has.
        ground: u32,
    },
    /// A cylinder (a disc in the plane); a sphere has no axis.
    Round {
        /// A point of the axis, or the centre.
        centre: [f64; 3],
        /// The unit direction of the axis; `None` for a sphere.
        axis: Option<[f64; 3]>,
        /// The radius, > 0.
        radius: f64,
        /// The obstacle is what surrounds the cylinder or sphere.
        cavity: bool,
    },
}

impl Rigid {
    /// Distance of a point from the surface (negative inside the obstacle) and the unit normal of the nearest point of
    /// the surface, towards the free side; `None` where no point is the nearest (on an axis or in a centre).
    pub fn distance(&self, x: [f64; 3]) -> Option<(f64, [f64; 3])> {
        match *self {
            Rigid::Plane { point, normal } => Some((dot(minus(x, point), normal), normal)),
            Rigid::Behind { normal, .. } => Some((0.0, normal)),
            Rigid::Round {
                centre,
                axis,
                radius,
                cavity,
            } => {
                let from = outward(centre, axis, x);
                let r = norm(from);
                if r <= 1e-12 * radius {
                    return None;
                }
                let sign = if cavity { -1.0 } else { 1.0 };
                Some((sign * (r - radius), from.map(|v| sign * v / r)))
            }
        }
    }
}

/// The vector to a point from the nearest point of the axis, or from the centre of a sphere.
pub fn outward(centre: [f64; 3], axis: Option<[f64; 3]>, x: [f64; 3]) -> [f64; 3] {
    let from = minus(x, centre);
    match axis {
        Some(axis) => {
            let along = dot(from, axis);
            minus(from, axis.map(|v| along * v))
        }
        None => from,
    }
}

#[cfg(test)]
#[path = "../../tests/model/rigid.rs"]
mod tests;
