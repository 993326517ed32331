//! The interior of a subdomain, eliminated by the multifrontal method: the Schur complement S is what reaches the root,
//! and the fronts are an [`InteriorFactor`] for condensed loads and interior solutions.
//!
//! A pivot is an error if it is not positive, or is below 1e-13 of the diagonal entry it came from.

mod analysis;
mod factor;

#[cfg(test)]
#[path = "../../tests/interior.rs"]
mod tests;

use std::sync::Arc;

use super::multifrontal::SingularInterior;
use super::symbolic::{Keep, Symbolic};
use base::linalg::csr::Csr;
use base::linalg::dense::Dense;

pub use analysis::{Analysed, Analysis, SparseAnalysis};
pub use factor::InteriorFactor;

/// Why a matrix could not be factored.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NoFactor {
    /// A pivot of the interior is not positive: part of the subdomain is not held, or K is no stiffness matrix.
    Interior(SingularInterior),
    /// K is not positive semidefinite at this dof of the interface.
    Indefinite(u32),
}

impl From<SingularInterior> for NoFactor {
    fn from(e: SingularInterior) -> NoFactor {
        NoFactor::Interior(e)
    }
}

/// How the interior of one subdomain is eliminated.
#[derive(Debug, Clone, Copy)]
pub struct Condenser<'a> {
    /// Where analyses of the same pattern and interface are found and left, if they are to be used again.
    pub analysed: Option<&'a Analysed>,
    /// The part of the factor that is kept.
    pub keep: Keep,
}

impl Condenser<'_> {
    /// A condenser that analyses each matrix anew and keeps nothing of it.
    pub fn alone(keep: Keep) -> Condenser<'static> {
        Condenser {
            analysed: None,
            keep,
        }
    }

    /// Returns the factor and S of `k`; analyses `k` first where that has not been done. `interface` lists the dofs
    /// that are kept, in the order wanted for S.
    ///
    /// # Errors
    /// A pivot that vanishes.
    pub fn condense(
        self,
        k: &Csr,
        interface: &[u32],
        coordinates: Option<&[[f64; 3]]>,
    ) -> Result<(InteriorFactor, Dense), SingularInterior> {
        if let Some(analysis) = self.analysed.and_then(|a| a.dense.get()) {
            return analysis.condense(k, self.keep);
        }
        let symbolic = Symbolic::new(k, interface, coordinates);
        let analysis = Arc::new(Analysis::new(symbolic));
        let made = analysis.condense(k, self.keep);
        if let Some(analysed) = self.analysed {
            // Another thread may have left one in the meantime, which is the same.
            let _ = analysed.dense.set(analysis);
        }
        made
    }
}
