//! Load steps as written: the times, and factors as functions of them.

use super::expr::{Expr, Variables};
use base::Location;
use std::fmt;

/// A factor as a function of the time t of a load step.
#[derive(Debug, Clone, PartialEq)]
pub struct Ramp(Expr);

impl Ramp {
    /// The expression in t written as `text`.
    ///
    /// # Errors
    /// As [`Expr::parse`].
    pub fn parse(text: &str) -> std::result::Result<Ramp, String> {
        Expr::parse_in(text, &["t"]).map(Ramp)
    }

    /// The constant `value`.
    pub fn constant(value: f64) -> Ramp {
        Ramp(Expr::constant(value))
    }

    /// The factor at time `t`.
    pub fn at(&self, t: f64) -> f64 {
        // The expression was parsed with t as its first variable.
        self.0.eval(&Variables {
            point: [t, 0.0, 0.0],
            ..Variables::default()
        })
    }
}

impl fmt::Display for Ramp {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(out)
    }
}

/// Load steps as written.
#[derive(Debug, Clone, PartialEq)]
pub struct StepsSpec {
    /// The times, increasing.
    pub times: Vec<f64>,
    /// Factor of all loads.
    pub load: Ramp,
    /// Factor of all gaps and of the bounds of obstacles.
    pub gap: Ramp,
    /// Factor of all given values.
    pub dirichlet: Ramp,
    /// Whether each load step renews normals, pairing and gaps of contacts where the last one left the bodies.
    pub update: bool,
    /// Where it was written, if it was.
    pub location: Location,
}
