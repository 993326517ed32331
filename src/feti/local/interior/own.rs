//! Our multifrontal method behind the common face.

use std::sync::Arc;

use super::condensation::Factor;
use super::order::Elimination;
use super::{Analysis, NoFactor, SparseCholesky};
use crate::feti::local::dense::Dense;
use crate::feti::local::lanes::LANES;
use crate::feti::local::multifrontal::{PartialCholesky, Symbolic};
use crate::sparse::Csr;

/// The fronts.
#[derive(Debug)]
pub struct Own(Arc<Symbolic>);

impl Own {
    /// Fronts as they are ordered.
    pub fn new(k: &Csr, order: &Elimination) -> Own {
        let symbolic = Symbolic::with_supernodes(k, &order.interface, &order.supernodes);
        Own(Arc::new(symbolic))
    }

    /// Fronts by nested dissection.
    pub fn nested(k: &Csr, interface: &[u32], coordinates: Option<&[[f64; 3]]>) -> Own {
        Own(Arc::new(Symbolic::new(k, interface, coordinates)))
    }
}

impl Analysis for Own {
    fn factor(&self, k: &Csr) -> Result<Box<dyn SparseCholesky>, NoFactor> {
        assert_eq!(self.0.n_interior(), k.n(), "an interface is kept");
        let (factor, _) = PartialCholesky::new(k, self.0.clone())?;
        Ok(Box::new(factor))
    }

    fn condense(&self, k: &Csr) -> Result<(Factor, Dense), NoFactor> {
        let (factor, s) = PartialCholesky::new(k, self.0.clone())?;
        Ok((Factor::Fronts(factor), s))
    }
}

/// Where nothing is kept, the partial factorisation is the whole one.
impl SparseCholesky for PartialCholesky {
    fn solve(&self, x: &mut [f64]) {
        self.forward(x);
        self.backward(x);
    }

    fn solve_many(&self, x: &mut [Vec<f64>]) {
        for lanes in x.chunks_mut(LANES) {
            match lanes {
                [x] => self.solve(x),
                _ => {
                    self.forward_many(lanes);
                    self.backward_many(lanes);
                }
            }
        }
    }

    fn bytes(&self) -> usize {
        PartialCholesky::bytes(self)
    }
}
