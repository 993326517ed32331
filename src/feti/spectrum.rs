//! The ends of a spectrum.

/// The smallest and the largest eigenvalue of an operator.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Spectrum {
    /// Smallest eigenvalue outside the kernel.
    pub lambda_min: f64,
    /// Largest eigenvalue.
    pub lambda_max: f64,
    /// Where an exact eigenvalue has settled before its residual reached the tolerance: that residual, relative to the
    /// eigenvalue. An eigenvalue lies within it; as a rule the error is about its square. `None` otherwise.
    pub settled: Option<f64>,
}

impl Spectrum {
    /// λ_max / λ_min.
    pub fn kappa(&self) -> f64 {
        self.lambda_max / self.lambda_min
    }
}
