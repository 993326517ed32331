//! A punch with a flat bottom and round edges, pressed onto a block of the same material.
//!
//! M. Ciavarella, D. A. Hills and G. Monno, The influence of rounded edges on indentation by a flat punch, Proc. Inst.
//! Mech. Eng. C 212 (1998) 319–328. With the half-width a of the contact, b of the flat part, sin φ₀ = b/a and
//! sin φ = x/a,
//!
//! ```text
//!     4 P R / (E* b²) = (π − 2φ₀)/sin²φ₀ − 2 cot φ₀,
//!     p(x) = 2 P/(π a (π − 2φ₀ − sin 2φ₀)) { (π − 2φ₀) cos φ + sin φ ln |sin(φ + φ₀)/sin(φ − φ₀)|
//!                                             + sin φ₀ ln |tan((φ + φ₀)/2) tan((φ − φ₀)/2)| }.
//! ```
//!
//! The tests hold both against the sum of flat punches of growing width from which they follow.

use std::f64::consts::PI;

use super::hertz::{pressures, scene_of};
use super::meshes::Punch;
use super::report::{MeasuredValue, MeshResult, MeshSeries, ReferencePressure};
use super::runner::{Runner, SolvedScene};
use crate::study::hertz::NodalPressure;
use base::Result;

/// The contact of a punch with the flat half-width b.
#[derive(Debug, Clone, Copy)]
pub struct Rounded {
    /// Half-width of the contact.
    pub a: f64,
    /// Half-width of the flat part.
    pub flat: f64,
    /// Radius of the edges.
    pub radius: f64,
    /// E*.
    pub modulus: f64,
}

impl Rounded {
    /// The force per thickness.
    pub fn force(&self) -> f64 {
        let phi = (self.flat / self.a).asin();
        self.modulus * self.a.powi(2) / (4.0 * self.radius) * (PI - 2.0 * phi - (2.0 * phi).sin())
    }

    /// The pressure at a distance from the middle.
    pub fn pressure(&self, x: f64) -> f64 {
        let x = x.abs();
        if x >= self.a {
            return 0.0;
        }
        // The terms have a limit where the flat part ends, not a value.
        let x = if (x / self.flat - 1.0).abs() < 1e-9 {
            self.flat * (1.0 - 1e-9)
        } else {
            x
        };
        let (phi0, phi) = ((self.flat / self.a).asin(), (x / self.a).asin());
        let (sum, difference) = (phi + phi0, phi - phi0);
        let first = (sum.sin() / difference.sin()).abs().ln();
        let second = ((0.5 * sum).tan() * (0.5 * difference).tan()).abs().ln();
        let open = PI - 2.0 * phi0;
        let bracket = open * phi.cos() + phi.sin() * first + phi0.sin() * second;
        2.0 * self.force() / (PI * self.a * (open - (2.0 * phi0).sin())) * bracket
    }
}

/// A flat part of 20 mm, edges of radius 500 mm, steel on steel, a = 12.5 mm.
pub fn run(runner: &mut Runner) -> Result<Vec<MeshSeries>> {
    let young: f64 = 210e3;
    let theory = Rounded {
        a: 12.5,
        flat: 10.0,
        radius: 500.0,
        modulus: young / (2.0 * (1.0 - 0.3 * 0.3)),
    };
    let punch = Punch {
        flat: theory.flat,
        radius: theory.radius,
        extent: 200.0,
        a: theory.a,
    };
    let edges: [&[f64]; 2] = if runner.quick {
        [&[0.25, 0.125, 0.0625], &[0.5, 0.25, 0.125]]
    } else {
        [&[0.125, 0.0625, 0.03125], &[0.25, 0.125, 0.0625]]
    };
    let mut out = Vec::new();
    for (order, edges) in [1, 2].into_iter().zip(edges) {
        let mut list = Vec::new();
        for (k, &edge) in edges.iter().enumerate() {
            let stem = format!("punch_order{order}_{}", k + 1);
            let file = format!("{stem}.msh");
            let mesh = punch.mesh(&file, edge, order);
            let pressure = 0.5 * theory.force() / punch.extent;
            let text = scene_of(
                "Punch with round edges",
                2,
                &file,
                pressure,
                [young; 2],
                "lower",
            );
            let run = runner.solve_mesh(&stem, &text, &mesh)?;
            list.push(record(&run, edge, &theory, k + 1 == edges.len()));
        }
        out.push(MeshSeries::new(format!("triangles of order {order}"), list));
    }
    Ok(out)
}

fn record(run: &SolvedScene, edge: f64, theory: &Rounded, finest: bool) -> MeshResult {
    let all = pressures(run, |[x, _, _]| x);
    let (mut squares, mut curve) = ([0.0; 2], Vec::new());
    let mean = theory.force() / (2.0 * theory.a);
    let (mut peak, mut expected) = (0.0_f64, 0.0_f64);
    for p in &all {
        let reference = theory.pressure(p.x);
        squares[0] += p.weight * (p.value - reference).powi(2);
        squares[1] += p.weight * reference.powi(2);
        peak = peak.max(p.value);
        expected = expected.max(reference);
        if p.x.abs() < 1.6 * theory.a {
            curve.push(ReferencePressure {
                x: p.x / theory.a,
                p: p.value / mean,
                reference: reference / mean,
            });
        }
    }
    let force: f64 = run
        .last()
        .rows
        .iter()
        .map(|r| r.multiplier * r.normal()[1].abs())
        .sum();
    let within = |limit: f64| finest.then_some(limit);
    let values = vec![
        MeasuredValue::error("rms of p", (squares[0] / squares[1]).sqrt()).within(within(0.05)),
        // Half an edge.
        MeasuredValue::beside("a", half_width(&all), theory.a).within(within(0.6 * edge)),
        MeasuredValue::beside("peak at nodes", peak, expected)
            .within(within((0.8 * edge).max(0.02))),
        MeasuredValue::beside("force", 2.0 * force, theory.force()).within(within(1e-6)),
    ];
    run.with_curve(format!("h = a/{:.3}", 1.0 / edge), edge, values, curve)
}

/// The middle between the last node that touches and the next one.
fn half_width(all: &[NodalPressure]) -> f64 {
    let touching = all.iter().filter(|p| p.active).map(|p| p.x);
    let last = touching.fold(0.0, f64::max);
    let beyond = all.iter().map(|p| p.x).filter(|x| *x > last);
    0.5 * (last + beyond.fold(f64::INFINITY, f64::min))
}

#[cfg(test)]
#[path = "../../../tests/study/benchmarks/punch.rs"]
mod tests;
