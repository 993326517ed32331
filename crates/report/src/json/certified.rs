//! The part of the record of `solve` about guaranteed bounds of the error, and about the discretisation error.

use super::number;
use fetifeti::solution::CertificationResult;
use serde::{Deserialize, Serialize};

/// Bounds of the distance from the exact solution of the discrete problem in the energy norm, and estimates of how far
/// that is from the exact solution.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Certified {
    /// ‖u − u*‖_K is not larger than this; `null` without a bound.
    pub most: Option<f64>,
    /// ‖u − u*‖_K is not smaller than this.
    pub least: Option<f64>,
    /// `most` relative to ‖u‖_K.
    pub relative: Option<f64>,
    /// ‖u‖_K of the unknowns.
    pub size: Option<f64>,
    /// The part of `most` that rounding may add.
    pub rounding: Option<f64>,
    /// Krylov iterations that the bounds took.
    pub iterations: usize,
    /// Seconds that the bounds took.
    pub seconds: f64,
    /// Why there is no bound.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refused: Option<String>,
    /// Estimates of the discretisation error.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub discretisation: Option<Discretisation>,
}

/// Estimates of the discretisation error in the energy norm.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Discretisation {
    /// That of all bodies.
    #[serde(with = "number")]
    pub total: f64,
    /// That of every body.
    pub bodies: Vec<BodyError>,
    /// Seconds that one estimate took, the meshes included.
    pub seconds: f64,
    /// How often the tolerance of `-fetifeti_rtol auto` was looked at; 0 without it.
    pub looks: usize,
}

/// The discretisation error of a body.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct BodyError {
    /// The name of the body.
    pub name: String,
    /// Estimate of its error in the energy norm.
    #[serde(with = "number")]
    pub error: f64,
    /// Estimate of its error relative to its energy norm; `null` where it has no energy.
    pub relative: Option<f64>,
}

impl Certified {
    /// The record of a bound.
    pub fn new(verdict: &CertificationResult) -> Certified {
        match verdict {
            Ok(c) => Certified {
                most: Some(c.most),
                least: Some(c.least),
                relative: (c.size > 0.0).then(|| c.most / c.size),
                size: Some(c.size),
                rounding: Some(c.rounding),
                iterations: c.iterations,
                seconds: c.seconds,
                ..Certified::default()
            },
            Err(why) => Certified {
                refused: Some(why.text().into()),
                ..Certified::default()
            },
        }
    }

    /// The bounds in one line.
    pub fn text(&self) -> String {
        let known = self.most.zip(self.least).zip(self.size);
        let Some(((most, least), size)) = known else {
            let why = self.refused.as_deref().unwrap_or("nothing is known");
            return format!("no bound: {why}");
        };
        let part = if size > 0.0 { size } else { 1.0 };
        if least > 0.0 {
            format!(
                "between {:.2e} and {:.2e} of the energy norm {size:.3e} ({} iterations)",
                least / part,
                most / part,
                self.iterations
            )
        } else {
            format!("at most {:.2e} of the energy norm {size:.3e}", most / part)
        }
    }
}

impl Discretisation {
    /// The errors in one line: that of all bodies, and the body with the largest.
    pub fn text(&self) -> String {
        let largest = self
            .bodies
            .iter()
            .max_by(|a, b| a.error.total_cmp(&b.error));
        let body = match largest.filter(|_| self.bodies.len() > 1) {
            Some(body) => format!(", most of it in body {}: {:.2e}", body.name, body.error),
            None => String::new(),
        };
        format!("about {:.2e}{body}", self.total)
    }
}
