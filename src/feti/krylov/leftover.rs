//! The residual of the equations at a pair (u, λ), and the error in the energy norm that is credible beside it.

/// The error may be this many times the tolerance, relative to ‖u‖_K: the iteration measures another norm.
const CREDIBLE: f64 = 1e3;

/// No error is too large that is below this part of ‖u‖_K.
const FLOOR: f64 = 1e-11;

/// No error is too large that is below this part of the terms that cancel in r.
const ROUNDING: f64 = 1e-12;

/// However loose the tolerance is, an error is too large from this part of ‖u‖_K on.
const LARGEST: f64 = 0.5;

/// The residual of the equations at (u, λ), and the sizes of their terms. D is the diagonal of K.
#[derive(Debug, Clone, Default)]
pub struct Leftover {
    /// r = f − K u − Bᵀ λ on Γ of each local subdomain, length n_Γ.
    pub on_gamma: Vec<Vec<f64>>,
    /// ‖r‖ inside all subdomains, in the norm of D⁻¹.
    pub inside: f64,
    /// ‖u‖_K.
    pub size: f64,
    /// ‖u‖_D + ‖f‖ + ‖Bᵀ λ‖, forces in the norm of D⁻¹.
    pub terms: f64,
}

impl Leftover {
    /// The largest error that is credible at this relative tolerance.
    pub fn bound(&self, rtol: f64) -> f64 {
        (CREDIBLE * rtol).clamp(FLOOR, LARGEST) * self.size + ROUNDING * self.terms
    }

    /// An error relative to ‖u‖_K, or to rounding if that is larger.
    pub fn relative(&self, error: f64) -> f64 {
        match self.size.max(ROUNDING * self.terms) {
            size if size > 0.0 => error / size,
            _ => error,
        }
    }
}
