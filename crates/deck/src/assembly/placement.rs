//! Where nodes are: the placement of an instance, and the system of coordinates that *SYSTEM defines.

use base::linalg::vec3::{cross, dot, minus, norm, unit};

/// A turn by R and a way: x becomes R x + way.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct InstancePlacement {
    turn: [[f64; 3]; 3],
    way: [f64; 3],
}

/// No turn.
const EYE: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The part of the length of a vector that counts as zero.
const NOTHING: f64 = 1e-10;

impl InstancePlacement {
    /// Everything stays where it is.
    pub const NONE: InstancePlacement = InstancePlacement {
        turn: EYE,
        way: [0.0; 3],
    };

    /// A way, and then a turn by some degrees about the axis from `a` to `b`. `None` for an axis without length.
    pub fn new(
        way: [f64; 3],
        rotation: Option<([f64; 3], [f64; 3], f64)>,
    ) -> Option<InstancePlacement> {
        let Some((a, b, degrees)) = rotation else {
            return Some(InstancePlacement { turn: EYE, way });
        };
        let k = unit(minus(b, a))?;
        let (sin, cos) = sin_cos(degrees);
        let turn = [0, 1, 2].map(|i| {
            [0, 1, 2].map(|j| {
                let mut e = [0.0; 3];
                e[j] = 1.0;
                e[i] * cos + cross(k, e)[i] * sin + k[i] * k[j] * (1.0 - cos)
            })
        });
        let only = InstancePlacement {
            turn,
            way: [0.0; 3],
        };
        // R (x + way − a) + a
        let from = [0, 1, 2].map(|d| way[d] - a[d]);
        let moved = only.vector(from);
        Some(InstancePlacement {
            turn,
            way: [0, 1, 2].map(|d| moved[d] + a[d]),
        })
    }

    /// The system of *SYSTEM: its origin, a point on its first axis, a point in the plane of the first two. Without the
    /// last one the third axis stays. `None` if the points define no axes.
    pub fn system(points: &[[f64; 3]]) -> Option<InstancePlacement> {
        let [a, rest @ ..] = points else {
            return Some(InstancePlacement::NONE);
        };
        let [b, rest @ ..] = rest else {
            return InstancePlacement::new(*a, None);
        };
        let first = unit(minus(*b, *a))?;
        let across = match rest {
            [c, ..] => cross(first, minus(*c, *a)),
            [] => cross(first, cross([0.0, 0.0, 1.0], first)),
        };
        let size = rest.first().map_or(1.0, |c| norm(minus(*c, *a)));
        if norm(across) <= NOTHING * size {
            return None;
        }
        let third = unit(across)?;
        let axes = [first, cross(third, first), third];
        Some(InstancePlacement {
            turn: [0, 1, 2].map(|i| [0, 1, 2].map(|j| axes[j][i])),
            way: *a,
        })
    }

    /// Whether everything stays where it is.
    pub fn is_none(&self) -> bool {
        *self == InstancePlacement::NONE
    }

    /// Where a point gets.
    pub fn point(&self, x: [f64; 3]) -> [f64; 3] {
        let turned = self.vector(x);
        [0, 1, 2].map(|d| turned[d] + self.way[d])
    }

    /// The direction `v` after the turn.
    pub fn vector(&self, v: [f64; 3]) -> [f64; 3] {
        if self.turn == EYE {
            v
        } else {
            self.turn.map(|row| dot(row, v))
        }
    }
}

/// Sine and cosine of degrees, those of right angles without rounding.
fn sin_cos(degrees: f64) -> (f64, f64) {
    match degrees.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        other => other.to_radians().sin_cos(),
    }
}
