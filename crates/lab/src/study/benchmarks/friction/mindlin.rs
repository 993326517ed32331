//! Cattaneo's and Mindlin's solution for equal bodies that touch as Hertz says, under P and then Q: R. D. Mindlin and
//! H. Deresiewicz, Elastic spheres in contact under varying oblique forces, J. Appl. Mech. 20 (1953) 327–344, and
//! K. L. Johnson, Contact Mechanics (1985), sections 7.2 to 7.4.
//!
//! ```text
//!     q(x)/(μ p₀) = s(x; Q₁/μP),                      s(x; Q) = √(1 − x²/a²) − (c/a) √(1 − x²/c²),  c/a = (1 − Q)^k
//!     q(x)/(μ p₀) = s(x; Q₁/μP) − 2 s(x; (Q₁ − Q)/(2 μP))       while Q falls from Q₁ to −Q₁
//! ```
//!
//! with k = ½ for cylinders and ⅓ for spheres, and no root outside its circle. The nodes inside c stick.

use std::f64::consts::PI;

use super::super::report::{MeasuredValue, ReferencePressure};
use super::{resultant, sticking, NodeTraction};
use fetifeti::solution::RowState;

/// The number of load steps: Q/(μP) is about 0, 0.25, 0.5, 0.75, 0.5, …, −0.5; it is measured.
pub const STEPS: usize = 9;

/// The load step with the largest Q.
const TURN: usize = 3;

/// The load steps that are compared, and their names.
pub const STAGES: [(usize, &str); 3] = [(3, "loaded"), (6, "unloaded"), (8, "reversed")];

/// The factor of Q over the load steps, as an expression.
pub const FACTOR: &str = "0.25*min(9*t - 1, 7 - 9*t)";

/// Equal bodies in contact.
#[derive(Debug, Clone, Copy)]
pub struct Mindlin {
    /// E/(2 (1 − ν²)).
    pub modulus: f64,
    /// The radius of the one that is round, half of it if both are.
    pub radius: f64,
    /// The coefficient of friction.
    pub friction: f64,
    /// Spheres, else cylinders of unit length.
    pub spheres: bool,
}

/// The contact under a normal force.
#[derive(Debug, Clone, Copy)]
pub struct NormalContact {
    /// Half-width or radius.
    pub a: f64,
    /// The largest pressure.
    pub p0: f64,
}

impl Mindlin {
    /// Hertz's contact under the force P.
    pub fn under(&self, force: f64) -> NormalContact {
        if self.spheres {
            let a = (0.75 * force * self.radius / self.modulus).cbrt();
            let p0 = 1.5 * force / (PI * a * a);
            NormalContact { a, p0 }
        } else {
            let a = (4.0 * force * self.radius / (PI * self.modulus)).sqrt();
            let p0 = 2.0 * force / (PI * a);
            NormalContact { a, p0 }
        }
    }

    /// c/a of a load Q/(μP) from rest.
    pub fn stick(&self, load: f64) -> f64 {
        let rest = (1.0 - load).max(0.0);
        if self.spheres {
            rest.cbrt()
        } else {
            rest.sqrt()
        }
    }

    /// s at x/a.
    fn first(&self, x: f64, load: f64) -> f64 {
        let c = self.stick(load);
        let root = |x: f64| (1.0 - x * x).max(0.0).sqrt();
        root(x) - if c > 0.0 { c * root(x / c) } else { 0.0 }
    }

    /// q/(μ p₀) at x/a after a load up to the first Q/(μP) and, if there is one, back to the second.
    pub fn shear(&self, x: f64, turn: f64, back: Option<f64>) -> f64 {
        let fallen = back.map_or(0.0, |q| 2.0 * self.first(x, 0.5 * (turn - q)));
        self.first(x, turn) - fallen
    }
}

/// The largest permitted errors at a stage.
#[derive(Debug, Clone, Copy)]
pub struct StageLimits {
    /// Of the root mean square of q, relative to that of μ p.
    pub curve: f64,
    /// Of c and of the largest q.
    pub extremes: f64,
}

/// A stage of the load steps beside the theory for the forces that the nodes bear: P, and Q at the turn and at present.
/// The normal is y, Q goes along x.
pub struct Stage<'a> {
    /// The nodes of all load steps.
    pub steps: &'a [Vec<NodeTraction>],
    /// The load step.
    pub step: usize,
    /// The tolerances, if it has some.
    pub limits: Option<StageLimits>,
}

impl Stage<'_> {
    /// The values of the stage, and its curve of the nodes that `drawn` takes.
    pub fn beside(
        &self,
        theory: &Mindlin,
        drawn: impl Fn(&NodeTraction) -> bool,
    ) -> (Vec<MeasuredValue>, Vec<ReferencePressure>) {
        let nodes = &self.steps[self.step];
        let normal = resultant(nodes)[1].abs();
        let load = |step: usize| resultant(&self.steps[step])[0].abs() / (theory.friction * normal);
        // Q has one sign up to the turn; the force of friction is against it.
        let signed = -resultant(nodes)[0] / (theory.friction * normal);
        let turn = load(self.step.min(TURN));
        let back = (self.step > TURN).then_some(signed);
        let contact = theory.under(normal);
        let scale = theory.friction * contact.p0;
        let (mut squares, mut peaks) = ([0.0; 2], [0.0_f64; 2]);
        let mut curve = Vec::new();
        for node in nodes {
            let [x, _, z] = node.point;
            let from_middle = x.hypot(z) / contact.a;
            let reference = theory.shear(from_middle, turn, back);
            let found = -node.shear[0] / scale;
            let pressure = (1.0 - from_middle * from_middle).max(0.0).sqrt();
            squares[0] += node.area * (found - reference).powi(2);
            squares[1] += node.area * pressure * pressure;
            peaks[0] = peaks[0].max(found.abs());
            peaks[1] = peaks[1].max(reference.abs());
            if from_middle < 1.6 && drawn(node) {
                curve.push(ReferencePressure {
                    x: x / contact.a,
                    p: found,
                    reference,
                });
            }
        }
        let radius = |area: f64| {
            if theory.spheres {
                (area / PI).sqrt()
            } else {
                0.5 * area
            }
        };
        let touching = nodes.iter().filter(|n| n.state != RowState::Open);
        let a = radius(touching.map(|n| n.area).sum());
        let c = radius(sticking(nodes)) / contact.a;
        let expected = theory.stick(back.map_or(turn, |q| 0.5 * (turn - q)));
        let extremes = self.limits.map(|l| l.extremes);
        let rms = (squares[0] / squares[1]).sqrt();
        let values = vec![
            MeasuredValue::error("rms of τ / μp", rms).within(self.limits.map(|l| l.curve)),
            MeasuredValue::beside("c/a", c, expected).within(extremes),
            MeasuredValue::beside("largest τ / μp0", peaks[0], peaks[1]).within(extremes),
            MeasuredValue::beside("a", a, contact.a).within(extremes),
        ];
        (values, curve)
    }
}

#[cfg(test)]
#[path = "../../../../tests/study/benchmarks/mindlin.rs"]
mod tests;
