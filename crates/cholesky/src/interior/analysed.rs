//! What is known of the pattern of a matrix, for further matrices with the same pattern.

use std::sync::{Arc, OnceLock};

use super::analysis::Analysis;
use super::own::Own;

/// Analyses of one pattern with one interface. The first factorisation of each form makes what it needs, those after it
/// take it from here.
#[derive(Debug, Default)]
pub struct Analysed {
    /// With the interface last, for S as a dense matrix.
    pub dense: OnceLock<Arc<dyn Analysis>>,
    /// Of K_rr and K_II, for S and T as sparse solves.
    pub sparse: OnceLock<[Own; 2]>,
}
