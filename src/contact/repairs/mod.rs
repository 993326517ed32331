//! Repairs of what a strategy proposes.
//!
//! | file | repair |
//! |---|---|
//! | [`held`] | rows are put back into a set that leaves a body loose which the load drives |
//! | [`placed`] | bodies that nothing holds come to rest where no row is violated, or as little as possible |
//! | [`dependent`] | rows that cannot all hold get multipliers that do not contradict each other |

mod dependent;
mod held;
mod placed;

use super::judge;
use super::settings::ContactSettings;
use super::tuning::Tuning;
use crate::feti::krylov::residual::Residual;
use crate::feti::operators::dual::Dual;
use crate::feti::projector::balance::KernelLoad;
use crate::feti::LinearMethod;
use crate::Result;
use petsc::Vec as PetscVec;

/// The repairs of a problem.
pub(super) struct Repairs<'a> {
    method: &'a LinearMethod,
    tuning: &'a Tuning,
}

impl<'a> Repairs<'a> {
    /// The repairs of the problem of `method`.
    pub fn new(method: &'a LinearMethod, settings: &'a ContactSettings) -> Repairs<'a> {
        Repairs {
            method,
            tuning: &settings.tuning,
        }
    }

    /// Puts rows into `active` so that the load drives no body away, those with the largest `score` first, none
    /// with the score −∞. Returns their number. Collective.
    ///
    /// # Errors
    /// Bodies that the load pushes away for ever.
    pub fn hold(
        &self,
        dual: &Dual,
        active: &mut [bool],
        score: &dyn Fn(usize) -> f64,
        load: &KernelLoad,
    ) -> Result<usize> {
        let problem = &self.method.problem;
        held::restore_coercivity(problem, dual, active, score, (load, None), self.tuning)
    }

    /// Says which bodies slide away, where no tangential row is left to hold them: `load` has given forces of friction,
    /// and `alone` is the load without them. Collective.
    ///
    /// # Errors
    /// Such bodies.
    pub fn sliding(
        &self,
        dual: &Dual,
        active: &mut [bool],
        score: &dyn Fn(usize) -> f64,
        (load, alone): (&KernelLoad, &KernelLoad),
    ) -> Result<()> {
        let problem = &self.method.problem;
        let loads = (load, Some(alone));
        held::restore_coercivity(problem, dual, active, score, loads, self.tuning).map(|_| ())
    }

    /// Moves bodies that nothing holds to where no row is violated, or as little as possible. Returns the gaps
    /// B u − C λ − c of the owned rows. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn place(&self, dual: &Dual, at: &mut Residual, lambda: &PetscVec) -> Result<Vec<f64>> {
        let gaps = judge::all_gaps(dual, at, lambda)?;
        match placed::least_distance(dual, &gaps, self.tuning) {
            Some(alpha) => {
                at.shift(dual, &alpha);
                judge::all_gaps(dual, at, lambda)
            }
            None => Ok(gaps),
        }
    }

    /// Gives dependent rows of this rank multipliers with the same forces that do not contradict each other.
    pub fn agree(&self, lambda: &mut [f64]) {
        let jump = &self.method.dual().stiffness.jump;
        dependent::ratio_test_descent(jump, lambda, self.tuning.level);
    }
}
