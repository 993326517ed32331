//! The forces that a node with friction can exert: a convex set K of normal and tangential forces, and the projection
//! onto it.
//!
//! ```text
//!     Coulomb   λ_n ≥ 0,  |λ_t| ≤ min(μ λ_n, limit)          Tresca   λ_n ≥ 0,  |λ_t| ≤ g
//! ```

use crate::feti::jump::operator::Jump;
use crate::substructures::{FrictionBound, FrictionNode};

/// A normal force and two tangential ones; in the plane the last is 0.
pub type NodeForce = [f64; 3];

/// The set K of a node.
#[derive(Debug, Clone)]
pub struct FrictionCone {
    /// The owned rows: the normal one, then the tangential ones.
    pub rows: Vec<usize>,
    /// The law.
    pub bound: FrictionBound,
}

/// The sets of nodes on the rows that this rank owns.
pub fn cones(nodes: &[FrictionNode], jump: &Jump) -> Vec<FrictionCone> {
    let place = jump.places();
    let of = |node: &FrictionNode| FrictionCone {
        rows: std::iter::once(&node.normal)
            .chain(&node.tangential)
            .map(|&r| place[r])
            .collect(),
        bound: node.bound,
    };
    nodes.iter().map(of).collect()
}

/// Where the projection of a force lies.
enum Face {
    /// The force is in K.
    Inside,
    /// No force.
    Apex,
    /// λ_n = (n + μ T)/(1 + μ²) on the surface |λ_t| = μ λ_n.
    Surface(f64),
    /// |λ_t| is this; λ_n follows n, or stays what it is.
    Side { radius: f64, normal: Option<f64> },
    /// λ_n = 0 and λ_t in the disc of Tresca's law.
    Disc,
}

impl FrictionCone {
    fn face(&self, s: NodeForce) -> Face {
        let (n, t) = (s[0], s[1].hypot(s[2]));
        match self.bound {
            FrictionBound::Tresca(g) if t > g => Face::Side {
                radius: g,
                normal: (n < 0.0).then_some(0.0),
            },
            FrictionBound::Tresca(_) if n < 0.0 => Face::Disc,
            FrictionBound::Tresca(_) => Face::Inside,
            FrictionBound::Coulomb { coefficient, limit } => {
                let inside = t <= coefficient * n;
                let surface = (n + coefficient * t) / (1.0 + coefficient * coefficient);
                let radius = if inside { t } else { coefficient * surface };
                if !inside && surface <= 0.0 {
                    Face::Apex
                } else if radius > limit {
                    let corner = limit / coefficient;
                    Face::Side {
                        radius: limit,
                        normal: (n < corner).then_some(corner),
                    }
                } else if inside {
                    Face::Inside
                } else {
                    Face::Surface(surface)
                }
            }
        }
    }

    /// Π_K s.
    pub fn project(&self, s: NodeForce) -> NodeForce {
        let t = s[1].hypot(s[2]);
        let of_radius = |n: f64, radius: f64| {
            let part = if t > 0.0 { radius / t } else { 0.0 };
            [n, part * s[1], part * s[2]]
        };
        match self.face(s) {
            Face::Inside => s,
            Face::Apex => [0.0; 3],
            Face::Surface(n) => of_radius(n, self.bound.at(n)),
            Face::Side { radius, normal } => of_radius(normal.unwrap_or(s[0]), radius),
            Face::Disc => [0.0, s[1], s[2]],
        }
    }

    /// The derivative of Π_K at s along v. It is symmetric and positive semidefinite.
    pub fn derivative(&self, s: NodeForce, v: NodeForce) -> NodeForce {
        let t = s[1].hypot(s[2]);
        let d = if t > 0.0 {
            [s[1] / t, s[2] / t]
        } else {
            [0.0; 2]
        };
        let along = d[0] * v[1] + d[1] * v[2];
        let across = [v[1] - along * d[0], v[2] - along * d[1]];
        let turned = |n: f64, along: f64, radius: f64| {
            let part = if t > 0.0 { radius / t } else { 0.0 };
            [
                n,
                along * d[0] + part * across[0],
                along * d[1] + part * across[1],
            ]
        };
        match self.face(s) {
            Face::Inside => v,
            Face::Apex => [0.0; 3],
            Face::Surface(n) => {
                let radius = self.bound.at(n);
                let mu = radius / n;
                let dn = (v[0] + mu * along) / (1.0 + mu * mu);
                turned(dn, mu * dn, radius)
            }
            Face::Side { radius, normal } => {
                let dn = if normal.is_some() { 0.0 } else { v[0] };
                turned(dn, 0.0, radius)
            }
            Face::Disc => [0.0, v[1], v[2]],
        }
    }

    /// How far the node opens in the motions against which its forces do no work, if it slips by `slip`.
    pub fn opening(&self, slip: f64) -> f64 {
        match self.bound {
            FrictionBound::Tresca(_) => 0.0,
            FrictionBound::Coulomb { coefficient, .. } => coefficient * slip,
        }
    }

    /// The most work that forces of K do on a motion w of the node, and by how much, as a length, the motion goes
    /// against forces without a bound.
    pub fn support(&self, w: NodeForce) -> [f64; 2] {
        let (n, t) = (w[0], w[1].hypot(w[2]));
        match self.bound {
            FrictionBound::Tresca(g) => [g * t, n.max(0.0)],
            FrictionBound::Coulomb { coefficient, limit } if limit < f64::INFINITY => {
                let corner = if coefficient > 0.0 {
                    limit * (t + n.min(0.0) / coefficient)
                } else {
                    0.0
                };
                [corner.max(0.0), n.max(0.0)]
            }
            FrictionBound::Coulomb { coefficient, .. } => {
                let beyond = (n + coefficient * t) / coefficient.hypot(1.0);
                [0.0, beyond.max(0.0)]
            }
        }
    }
}

#[cfg(test)]
#[path = "../../../tests/inside/contact/existence/cone.rs"]
mod tests;
