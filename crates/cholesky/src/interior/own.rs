//! Our multifrontal method as an [`Analysis`].

use std::sync::{Arc, OnceLock};

use super::analysis::{Analysis, NoFactor};
use super::factor::{Factor, SparseCholesky};
use crate::multifrontal::{PartialCholesky, SingularInterior};
use crate::symbolic::{Keep, Symbolic};
use base::linalg::csr::Csr;
use base::linalg::dense::Dense;

/// The fronts.
#[derive(Debug)]
pub struct Own {
    symbolic: Arc<Symbolic>,
    /// The fronts without the rows of the interface, built on first use.
    inside: OnceLock<Arc<Symbolic>>,
}

impl Own {
    /// The analysis with these fronts.
    pub fn new(symbolic: Symbolic) -> Own {
        Own {
            symbolic: Arc::new(symbolic),
            inside: OnceLock::new(),
        }
    }

    /// Factors the interior of `k` for solves with it; returns S, too.
    ///
    /// # Errors
    /// A pivot that vanishes.
    pub fn solver(&self, k: &Csr) -> Result<(PartialCholesky, Dense), SingularInterior> {
        PartialCholesky::inside(k, &self.symbolic, self.inside())
    }

    fn inside(&self) -> Arc<Symbolic> {
        let inside = || Arc::new(self.symbolic.inside());
        self.inside.get_or_init(inside).clone()
    }
}

impl Analysis for Own {
    fn factor(&self, k: &Csr) -> Result<Box<dyn SparseCholesky>, NoFactor> {
        assert_eq!(self.symbolic.n_interior(), k.n(), "an interface is kept");
        let (factor, _) = PartialCholesky::new(k, self.symbolic.clone())?;
        Ok(Box::new(factor))
    }

    fn condense(&self, k: &Csr, keep: Keep) -> Result<(Factor, Dense), NoFactor> {
        let (factor, s) = match keep {
            Keep::Boundary => PartialCholesky::new(k, self.symbolic.clone())?,
            Keep::Interior => self.solver(k)?,
        };
        Ok((Factor::new(k, &self.symbolic.interface, factor, keep), s))
    }
}

impl SparseCholesky for PartialCholesky {
    fn solve(&self, x: &mut [f64]) {
        PartialCholesky::solve(self, x);
    }

    fn solve_many(&self, x: &mut [Vec<f64>]) {
        PartialCholesky::solve_many(self, x);
    }

    fn bytes(&self) -> usize {
        PartialCholesky::bytes(self)
    }
}
