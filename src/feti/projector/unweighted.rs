//! (GᵀG)⁻¹, where Q = I: the factor that tells what the rows hold.

use std::rc::Rc;

use super::coarse_solver::{CoarseSolver, InverseSide};
use super::gram::Gram;
use crate::Result;

/// The factor of GᵀG as a solver.
pub struct Unweighted(pub Rc<Gram>);

impl CoarseSolver for Unweighted {
    fn solve(&self, x: &mut [f64], _: InverseSide) -> Result<()> {
        self.0.solve(x);
        Ok(())
    }

    fn defect(&self) -> Result<f64> {
        // G alone has no jumps.
        Ok(0.0)
    }

    fn describe(&self) -> Result<String> {
        Ok("G^T G by a sparse Cholesky factor".into())
    }

    fn loses_less(&self, eigenvalue: f64, _: f64) -> bool {
        self.0.smallest_eigenvalue() > eigenvalue
    }

    fn shared(&self) -> Option<&Gram> {
        Some(&self.0)
    }
}
