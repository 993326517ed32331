//! The Krylov method kept at work until its tolerance is reached: broken off where large eigenvalues are to be deflated, started anew where rounding
//! has broken it down.
//!
//! With coefficients that jump by 10⁶ and more, P M⁻¹ Pᵀ and P_2 lose so many digits that CG may meet rᵀ z < 0 long before rounding ends the
//! iteration as a whole. The λ that it has reached is good: a residual evaluated afresh and a new Krylov space lead further.

use super::inner::{iterate, Inner, Loads, Residual};
use crate::feti::deflation;
use crate::feti::settings::Adaptive;
use crate::feti::solver::FetiFeti;
use crate::petsc::Vec as PetscVec;
use crate::Result;

/// A run that breaks down has got somewhere if the residual became less than this part of what it began with.
const PROGRESS: f64 = 0.5;

/// New starts at most.
const STARTS: usize = 20;

impl FetiFeti {
    /// Iterates from `lambda`, whose residual Pᵀ r is in `residual`, to a residual of `tolerance`; `size` is the size of the displacements that it comes
    /// from. On return `residual` belongs to an earlier λ. Collective.
    pub(crate) fn reach(
        &self,
        loads: &Loads,
        residual: &mut Residual,
        size: f64,
        lambda: &PetscVec,
        tolerance: f64,
    ) -> Result<Inner> {
        let session = self.session();
        if self.blind()? {
            self.search(None)?;
        }
        let mut so_far: Option<Inner> = None;
        let mut starts = 0;
        loop {
            let run = iterate(
                &self.dual(),
                self.ksp(),
                &residual.r,
                size,
                lambda,
                tolerance,
            )?;
            let (broken_off, seen) = (run.broken_off, run.estimate);
            let converged = run.reason.converged();
            let again = run.broke_down(PROGRESS) && starts < STARTS;
            let all = match so_far.take() {
                Some(before) => before.followed_by(run),
                None => run,
            };
            if broken_off {
                self.search(seen)?;
            } else if converged {
                return Ok(all);
            } else if again {
                starts += 1;
            } else if self.dual().give_deflation_up() {
                // Where rounding has made P_2 useless (elements a thousand times as long as high), the plain iteration begins at λ₀.
                lambda.set(0.0)?;
                let natural = &self.dual().natural;
                natural.balance(session.comm(), &loads.kernel, lambda)?;
            } else {
                return Ok(all);
            }
            so_far = Some(all);
            residual.evaluate(session, &self.dual(), loads, lambda)?;
            self.dual().p_transpose(&residual.r)?;
        }
    }

    /// Whether large eigenvalues are to be expected, or a bound is asked for, while only CG lets its Ritz values be seen: then the search cannot wait for them.
    fn blind(&self) -> Result<bool> {
        let dual = self.dual();
        let expected = dual
            .watch()
            .is_some_and(|limit| match self.settings().adaptive {
                Adaptive::Below(_) => true,
                _ => limit <= deflation::EXPECTED,
            });
        let searched = dual.deflation().is_some();
        Ok(expected && !searched && self.ksp().type_name()? != "cg")
    }
}
