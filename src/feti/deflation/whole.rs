//! The pencil of the whole problem, deflated: eigenvalues above the bound that the vectors of the bodies leave.
//!
//! Modes that several bodies share have eigenvalues up to τ times the number of bodies that meet. Where such
//! eigenvalues show, the top of
//!
//! ```text
//!     P_2 P M⁻¹ Pᵀ P_2ᵀ F μ = θ μ
//! ```
//!
//! is deflated too. There is one such pencil, and a product with it costs as much as an iteration.

use std::ops::Range;

use super::search::Pencils;
use super::Deflation;
use crate::feti::operators::dual::Dual;
use crate::Result;
use parallel::exchange::sum_all;
use petsc::Vec as PetscVec;

/// The pencil of the whole problem.
pub struct Whole<'a> {
    dual: &'a Dual,
    deflation: &'a Deflation,
    part: Vec<Range<usize>>,
    x: PetscVec,
    y: PetscVec,
}

impl<'a> Whole<'a> {
    /// The pencil that `deflation` leaves.
    pub fn new(dual: &'a Dual, deflation: &'a Deflation) -> Result<Whole<'a>> {
        Ok(Whole {
            dual,
            deflation,
            part: std::iter::once(0..dual.stiffness.jump.n_owned).collect(),
            x: dual.multipliers()?,
            y: dual.multipliers()?,
        })
    }

    fn with(&self, v: &[f64], apply: impl FnOnce(&PetscVec) -> Result<()>) -> Result<Vec<f64>> {
        self.x.array_mut()?.copy_from_slice(v);
        apply(&self.x)?;
        self.x.to_vec()
    }
}

impl Pencils for Whole<'_> {
    fn parts(&self) -> &[Range<usize>] {
        &self.part
    }

    fn row(&self, i: usize) -> u64 {
        (self.dual.stiffness.jump.first + i) as u64
    }

    fn f(&self, v: &[f64]) -> Result<Vec<f64>> {
        self.x.array_mut()?.copy_from_slice(v);
        self.dual.f(&self.x, &self.y)?;
        self.y.to_vec()
    }

    fn m(&self, v: &[f64]) -> Result<Vec<f64>> {
        self.x.array_mut()?.copy_from_slice(v);
        self.dual.m(&self.x, &self.y)?;
        self.dual.p(&self.y)?;
        if let Some(p2) = self.deflation.matrices() {
            p2.project(&self.y)?;
        }
        self.y.to_vec()
    }

    fn jump_part(&self, v: &mut Vec<f64>) -> Result<()> {
        *v = self.with(v, |x| {
            if let Some(p2) = self.deflation.matrices() {
                p2.project_transpose(x)?;
            }
            self.dual.p_transpose(x)
        })?;
        Ok(())
    }

    fn sum(&self, values: &mut [f64]) {
        sum_all(self.dual.comm(), values);
    }
}
