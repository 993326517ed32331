//! The factor of a body's primal problem, and what is known of its pattern for the next set-up.

use std::sync::Arc;

use base::linalg::csr::Csr;
use cholesky::multifrontal::PartialCholesky;
use cholesky::symbolic::Symbolic;

/// A pattern and its analysis.
#[derive(Debug, Clone)]
pub struct AnalysedPattern {
    row_ptr: Vec<usize>,
    col: Vec<u32>,
    symbolic: Arc<Symbolic>,
}

/// The factor of a body's matrix.
pub struct PrimalFactor {
    /// The first row of the body on this rank.
    pub first: usize,
    pub factor: PartialCholesky,
    /// The pattern, if it is to be kept.
    pub pattern: Option<AnalysedPattern>,
}

impl PrimalFactor {
    /// Factors `k`, with the analysis of `known` where the pattern is the same. `None` if a pivot vanishes.
    pub fn new(
        first: usize,
        k: &Csr,
        known: Option<&AnalysedPattern>,
        keeps: bool,
    ) -> Option<PrimalFactor> {
        let same = known.filter(|known| known.row_ptr == k.row_ptr && known.col == k.col);
        let symbolic = match same {
            Some(known) => known.symbolic.clone(),
            None => Arc::new(Symbolic::new(k, &[], None)),
        };
        let (factor, _) = PartialCholesky::new(k, symbolic.clone()).ok()?;
        let pattern = || AnalysedPattern {
            row_ptr: k.row_ptr.clone(),
            col: k.col.clone(),
            symbolic,
        };
        Some(PrimalFactor {
            first,
            factor,
            pattern: keeps.then(pattern),
        })
    }
}
