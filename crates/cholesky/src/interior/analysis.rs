//! The analysis of a sparsity pattern, from which matrices with this pattern are factored.

use std::fmt::Debug;

use super::factor::{Factor, SparseCholesky};
use crate::multifrontal::SingularInterior;
use crate::symbolic::Keep;
use base::linalg::csr::Csr;
use base::linalg::dense::Dense;

/// Why a matrix could not be factored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NoFactor {
    /// A pivot of the interior is not positive: part of the subdomain is not held, or K is no stiffness matrix.
    Interior(SingularInterior),
    /// K is not positive semidefinite at this dof of the interface.
    Indefinite(u32),
    /// The library failed; the reason is one sentence without a full stop.
    Failed(String),
}

impl From<SingularInterior> for NoFactor {
    fn from(e: SingularInterior) -> NoFactor {
        NoFactor::Interior(e)
    }
}

/// The part of a factorisation that depends on the pattern of K alone: one analysis serves all matrices of this
/// pattern.
pub trait Analysis: Debug + Send + Sync {
    /// L Lᵀ of the whole matrix.
    ///
    /// # Errors
    /// [`NoFactor`].
    ///
    /// # Panics
    /// If the analysis was made with an interface.
    fn factor(&self, k: &Csr) -> Result<Box<dyn SparseCholesky>, NoFactor>;

    /// Eliminates the interior; returns the factor and S (both triangles, in the order of the interface).
    ///
    /// # Errors
    /// [`NoFactor`].
    fn condense(&self, k: &Csr, keep: Keep) -> Result<(Factor, Dense), NoFactor>;
}
