//! Buffers for the vectors of one subdomain.

use crate::feti::subdomain::halves::Halfway;
use crate::feti::subdomain::scaled::ScaledSubdomain;
use base::linalg::dense::Dense;

/// Buffers of one subdomain on its interface Γ.
#[derive(Debug, Clone, Default)]
pub struct InterfaceBuffers {
    /// Input: a load, length n_Γ.
    pub v: Vec<f64>,
    /// Output: a displacement, length n_Γ.
    pub y: Vec<f64>,
    /// Coarse values in and out, length n_Π.
    pub p: Vec<f64>,
    /// The part of the output that is there before the coarse values are known.
    pub half: Halfway,
}

/// Several columns of one subdomain on its interface Γ.
#[derive(Debug, Clone, Default)]
pub struct InterfaceColumns {
    /// Inputs, n_Γ × their number.
    pub v: Dense,
    /// Outputs, same shape.
    pub y: Dense,
}

impl InterfaceBuffers {
    /// Zeros in the sizes of this subdomain.
    pub fn for_subdomain(local: &ScaledSubdomain) -> InterfaceBuffers {
        InterfaceBuffers {
            v: vec![0.0; local.gamma().n_gamma()],
            y: vec![0.0; local.gamma().n_gamma()],
            p: vec![0.0; local.gamma().n_pi()],
            half: Halfway::default(),
        }
    }
}
