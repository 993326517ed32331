//! The analysis of a sparsity pattern, from which matrices with this pattern are factored.

use std::sync::{Arc, OnceLock};

use super::factor::InteriorFactor;
use crate::multifrontal::{PartialCholesky, SingularInterior};
use crate::symbolic::{Keep, Symbolic};
use base::linalg::csr::Csr;
use base::linalg::dense::Dense;

/// Analyses of one pattern with one interface. The first factorisation of each form makes what it needs, those after it
/// take it from here.
#[derive(Debug, Default)]
pub struct Analysed {
    /// With the interface last, for S as a dense matrix.
    pub dense: OnceLock<Arc<Analysis>>,
    /// For S and T as sparse solves.
    pub sparse: OnceLock<SparseAnalysis>,
}

/// Analyses of K_rr and K_II.
#[derive(Debug)]
pub struct SparseAnalysis {
    /// K_rr with the vertices and these averages as a border.
    pub held: Analysis,
    /// The dofs of each average.
    pub averages: Vec<Vec<u32>>,
    /// K_II.
    pub interior: Analysis,
}

impl SparseAnalysis {
    /// Entries of both factors.
    pub fn entries(&self) -> usize {
        let of = |a: &Analysis, keep| a.symbolic.factor_entries(keep);
        of(&self.held, Keep::Boundary) + of(&self.interior, Keep::Interior)
    }

    /// Multiplications and additions of both factorisations.
    pub fn flops(&self) -> f64 {
        self.held.symbolic.flops() + self.interior.symbolic.flops()
    }
}

/// The part of a factorisation that depends on the pattern of K alone: one analysis serves all matrices of this
/// pattern.
#[derive(Debug)]
pub struct Analysis {
    symbolic: Arc<Symbolic>,
    /// The fronts without the rows of the interface, built on first use.
    inside: OnceLock<Arc<Symbolic>>,
    /// The fronts that some dofs reach, built on first use.
    reached: OnceLock<Arc<Symbolic>>,
}

impl Analysis {
    /// The fronts.
    pub fn symbolic(&self) -> &Symbolic {
        &self.symbolic
    }

    /// The analysis with these fronts.
    pub fn new(symbolic: Symbolic) -> Analysis {
        Analysis {
            symbolic: Arc::new(symbolic),
            inside: OnceLock::new(),
            reached: OnceLock::new(),
        }
    }

    /// Factors the interior of `k` for solves with it; returns S, too.
    ///
    /// # Errors
    /// A pivot that vanishes.
    pub fn solver(&self, k: &Csr) -> Result<(PartialCholesky, Dense), SingularInterior> {
        PartialCholesky::inside(k, &self.symbolic, self.inside())
    }

    /// Factors the interior of `k` with the rows of the interface, and stores the fronts that `dofs` reach, the same in
    /// all calls; returns S (both triangles), too.
    ///
    /// # Errors
    /// A pivot that vanishes.
    pub fn bordered(
        &self,
        k: &Csr,
        dofs: &[u32],
    ) -> Result<(PartialCholesky, Dense), SingularInterior> {
        let some = || Arc::new(self.symbolic.only(&self.symbolic.reached(dofs)));
        let kept = self.reached.get_or_init(some).clone();
        PartialCholesky::inside(k, &self.symbolic, kept)
    }

    /// Eliminates the interior; returns the factor and S (both triangles, in the order of the interface).
    ///
    /// # Errors
    /// A pivot that vanishes.
    pub fn condense(
        &self,
        k: &Csr,
        keep: Keep,
    ) -> Result<(InteriorFactor, Dense), SingularInterior> {
        let (factor, s) = match keep {
            Keep::Boundary => PartialCholesky::new(k, self.symbolic.clone())?,
            Keep::Interior => self.solver(k)?,
        };
        Ok((
            InteriorFactor::new(k, &self.symbolic.interface, factor, keep),
            s,
        ))
    }

    fn inside(&self) -> Arc<Symbolic> {
        let inside = || Arc::new(self.symbolic.inside());
        self.inside.get_or_init(inside).clone()
    }
}
