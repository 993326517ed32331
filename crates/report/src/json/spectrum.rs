//! Spectra.

use super::number;
use serde::{Deserialize, Serialize};

/// Extreme eigenvalues of the preconditioned operator.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Condition {
    /// From an eigenvalue solver; `null` where it was not asked for.
    pub exact: Option<Spectrum>,
    /// Lanczos estimate of the solve; `null` where the Krylov method gives none.
    pub estimate: Option<Spectrum>,
}

/// The two ends of a spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Spectrum {
    /// Smallest eigenvalue.
    #[serde(with = "number")]
    pub lambda_min: f64,
    /// Largest eigenvalue.
    #[serde(with = "number")]
    pub lambda_max: f64,
    /// Their ratio.
    #[serde(with = "number")]
    pub kappa: f64,
    /// The relative residual of an exact eigenvalue that has settled above the tolerance of the eigensolver.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settled: Option<f64>,
}

impl Spectrum {
    /// κ = λ_max / λ_min.
    pub fn new(lambda_min: f64, lambda_max: f64) -> Self {
        Spectrum {
            lambda_min,
            lambda_max,
            kappa: lambda_max / lambda_min,
            settled: None,
        }
    }
}

impl From<fetifeti::solution::Spectrum> for Spectrum {
    fn from(s: fetifeti::solution::Spectrum) -> Spectrum {
        Spectrum {
            settled: s.settled,
            ..Spectrum::new(s.lambda_min, s.lambda_max)
        }
    }
}
