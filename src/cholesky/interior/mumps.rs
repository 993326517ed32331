//! MUMPS behind the common face.
//!
//! MUMPS does not show its pivots, so smallness cannot be judged afterwards: the interior is scaled to a unit diagonal, and pivots below a
//! number count as zero.

use std::sync::{Arc, Mutex, PoisonError};

use super::condensation::{Condensation, Factor};
use super::order::Elimination;
use super::own::Own;
use super::triangle::Triangle;
use super::{positive_diagonal, refused, Analysis, Keep, NoFactor, SparseCholesky};
use crate::cholesky::multifrontal::SINGULAR;
use crate::linalg::csr::Csr;
use crate::linalg::dense::Dense;
use crate::petsc::{Mumps, Refusal};

/// The analysis of a pattern.
#[derive(Debug)]
pub struct OfMumps {
    triangle: Arc<Triangle>,
    order: Elimination,
    /// An instance of MUMPS that has been analysed: the first factor takes it, for it holds one factor at most.
    analysed: Mutex<Option<Mumps>>,
}

impl OfMumps {
    /// Analyses the pattern of `k`.
    pub fn new(k: &Csr, order: Elimination) -> Result<OfMumps, NoFactor> {
        let triangle = Triangle::new(k, &order);
        let first = instance(&triangle)?;
        Ok(OfMumps {
            triangle: Arc::new(triangle),
            order,
            analysed: Mutex::new(Some(first)),
        })
    }

    fn numeric(&self, k: &Csr) -> Result<(MumpsFactor, Vec<f64>), NoFactor> {
        let triangle = &*self.triangle;
        let (n, interior) = (triangle.n(), triangle.n_interior());
        positive_diagonal(k, &triangle.dofs[..interior])?;
        let mut waiting = self.analysed.lock().unwrap_or_else(PoisonError::into_inner);
        let mut mumps = match waiting.take() {
            Some(analysed) => analysed,
            None => instance(triangle)?,
        };
        drop(waiting);
        let mut values = triangle.values(k);
        let mut scale = vec![1.0; n];
        for (s, d) in scale.iter_mut().zip(triangle.interior_diagonal(&values)) {
            *s = 1.0 / d.sqrt();
        }
        for (v, (i, j)) in values.iter_mut().zip(triangle.entries()) {
            *v *= scale[i as usize] * scale[j as usize];
        }
        let schur = mumps.factor(&values, SINGULAR);
        let schur = schur.map_err(|e| self.located(k, e))?;
        let factor = MumpsFactor {
            triangle: self.triangle.clone(),
            scale,
            mumps,
        };
        Ok((factor, schur))
    }

    /// MUMPS counts negative pivots and does not say where they are: our own elimination does.
    fn located(&self, k: &Csr, error: Refusal) -> NoFactor {
        let first = self.triangle.dofs.first().copied().unwrap_or(0);
        let unknown = match (&error, Own::new(k, &self.order).condense(k, Keep::Interior)) {
            (Refusal::NotPositive(None), Err(NoFactor::Interior(e))) => e.dof,
            _ => first,
        };
        let triangle = &self.triangle;
        refused(error, &triangle.dofs, triangle.n_interior(), unknown)
    }
}

fn instance(triangle: &Triangle) -> Result<Mumps, NoFactor> {
    let kept = triangle.n() - triangle.n_interior();
    Mumps::new(triangle.n(), triangle.entries(), kept)
        .map_err(|e| refused(e, &triangle.dofs, triangle.n_interior(), 0))
}

impl Analysis for OfMumps {
    fn factor(&self, k: &Csr) -> Result<Box<dyn SparseCholesky>, NoFactor> {
        assert_eq!(self.triangle.n_interior(), k.n(), "an interface is kept");
        Ok(Box::new(self.numeric(k)?.0))
    }

    fn condense(&self, k: &Csr, _: Keep) -> Result<(Factor, Dense), NoFactor> {
        let (factor, schur) = self.numeric(k)?;
        let n = self.order.interface.len();
        let s = Dense {
            rows: n,
            cols: n,
            data: schur,
        };
        let condensation = Condensation::new(k, &self.order.interface, Box::new(factor));
        Ok((Factor::Solves(condensation), s))
    }
}

/// L of the scaled interior, inside MUMPS. Solves leave zero on the interface, whatever was there.
#[derive(Debug)]
struct MumpsFactor {
    triangle: Arc<Triangle>,
    /// By position in the order of elimination.
    scale: Vec<f64>,
    mumps: Mumps,
}

impl MumpsFactor {
    fn solve_ordered(&self, b: &mut [f64]) {
        let (n, interior) = (self.triangle.n(), self.triangle.n_interior());
        let scaled = |b: &mut [f64]| {
            for column in b.chunks_exact_mut(n) {
                let (inside, outside) = column.split_at_mut(interior);
                inside
                    .iter_mut()
                    .zip(&self.scale)
                    .for_each(|(b, s)| *b *= s);
                outside.fill(0.0);
            }
        };
        scaled(b);
        self.mumps.solve(b);
        scaled(b);
    }
}

impl SparseCholesky for MumpsFactor {
    fn solve(&self, x: &mut [f64]) {
        if !x.is_empty() {
            self.triangle.solve(x, |b| self.solve_ordered(b));
        }
    }

    fn solve_many(&self, x: &mut [Vec<f64>]) {
        self.triangle.solve_many(x, |b| self.solve_ordered(b));
    }

    fn bytes(&self) -> usize {
        self.mumps.bytes()
    }
}
