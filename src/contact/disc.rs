//! The forces of friction of a node in the augmented Lagrangian φ: the projection Π_g onto the disc of radius g.
//!
//! ```text
//!     ½ C (|s|² − |s − Π_g s|²),      s = μ_t + w/C,      its gradient in w: λ_t = Π_g s
//! ```
//!
//! For a given g this is convex and continuously differentiable in w (Stadler 2004).

/// The tangential rows of a node, one in the plane and two in space, and g.
#[derive(Debug, Clone, PartialEq)]
pub struct Disc {
    /// The owned rows.
    pub rows: Vec<usize>,
    /// The radius g, a force.
    pub radius: f64,
}

impl Disc {
    /// The values of the rows; 0 for the second one in the plane.
    pub fn of(&self, values: &[f64]) -> [f64; 2] {
        let mut out = [0.0; 2];
        for (v, &row) in out.iter_mut().zip(&self.rows) {
            *v = values[row];
        }
        out
    }

    /// s/|s| where |s| > g; `None` inside the disc.
    pub fn direction(&self, s: [f64; 2]) -> Option<[f64; 2]> {
        let size = s[0].hypot(s[1]);
        (size > self.radius).then(|| s.map(|s| s / size))
    }

    /// Π_g s.
    pub fn project(&self, s: [f64; 2]) -> [f64; 2] {
        self.direction(s).map_or(s, |d| d.map(|d| self.radius * d))
    }

    /// The derivative of Π_g s along v: v inside the disc, else what of it is across s, times g/|s|.
    pub fn derivative(&self, s: [f64; 2], v: [f64; 2]) -> [f64; 2] {
        let Some(d) = self.direction(s) else {
            return v;
        };
        let along = d[0] * v[0] + d[1] * v[1];
        let ratio = self.radius / s[0].hypot(s[1]);
        [0, 1].map(|k| ratio * (v[k] - along * d[k]))
    }

    /// ½ (|s|² − |s − Π_g s|²).
    pub fn value(&self, s: [f64; 2]) -> f64 {
        let size = s[0].hypot(s[1]);
        let inside = size.min(self.radius);
        inside * (size - 0.5 * inside)
    }
}

#[cfg(test)]
#[path = "../../tests/inside/contact/disc.rs"]
mod tests;
