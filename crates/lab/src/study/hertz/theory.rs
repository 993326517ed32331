//! Hertz's formulas for frictionless contact (K. L. Johnson, *Contact Mechanics*, 1985, chapter 4).

/// An elastic body, or a rigid one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elastic {
    /// Young's modulus; infinite for a rigid body.
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Radius; infinite for a plane.
    pub radius: f64,
}

impl Elastic {
    /// The rigid plane.
    pub const PLANE: Elastic = Elastic {
        young: f64::INFINITY,
        poisson: 0.0,
        radius: f64::INFINITY,
    };
}

/// The parameters of the formulas for a pair of bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HertzPair {
    /// E*, with 1/E* the sum of (1 − ν²)/E.
    pub modulus: f64,
    /// R, with 1/R the sum of the curvatures.
    pub radius: f64,
    /// Spheres; otherwise parallel cylinders in plane strain.
    pub spheres: bool,
}

/// The result of the formulas.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HertzContact {
    /// Half-width, or radius, of the contact zone.
    pub a: f64,
    /// Pressure in the middle of the zone.
    pub p0: f64,
}

impl HertzPair {
    /// The pair of two bodies.
    pub fn new(bodies: [Elastic; 2], spheres: bool) -> HertzPair {
        let compliance = |b: &Elastic| (1.0 - b.poisson * b.poisson) / b.young;
        let curvature = |b: &Elastic| 1.0 / b.radius;
        HertzPair {
            modulus: 1.0 / bodies.iter().map(compliance).sum::<f64>(),
            radius: 1.0 / bodies.iter().map(curvature).sum::<f64>(),
            spheres,
        }
    }

    /// The contact under the force F (per length for cylinders).
    pub fn under(&self, force: f64) -> HertzContact {
        use std::f64::consts::PI;
        let (e, r) = (self.modulus, self.radius);
        if self.spheres {
            let a = (3.0 * force * r / (4.0 * e)).cbrt();
            let p0 = 3.0 * force / (2.0 * PI * a * a);
            return HertzContact { a, p0 };
        }
        let a = (4.0 * force * r / (PI * e)).sqrt();
        let p0 = 2.0 * force / (PI * a);
        HertzContact { a, p0 }
    }
}

impl HertzContact {
    /// The pressure at a distance from the middle.
    pub fn pressure(&self, x: f64) -> f64 {
        self.p0 * (1.0 - (x / self.a).powi(2)).max(0.0).sqrt()
    }
}

#[cfg(test)]
#[path = "../../../tests/study/hertz/theory.rs"]
mod tests;
