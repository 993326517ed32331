//! `-fetifeti_rtol auto`: the iteration stops where the discretisation error makes further digits useless.
//!
//! ```text
//!     solve to rtol = 1e-2
//!     while  bound of ‖u − u*‖_K  >  0.1 × estimate of ‖u* − u_exact‖_K:   solve further, from where it stands
//! ```

use super::FetiFeti;
use crate::contact::{self, ContactType, State};
use crate::solution::Discretisation;
use crate::{Result, Solution};
use petsc::Options;

/// The algebraic error may be this part of the discretisation error. Both together are then at most 10 % above the
/// discretisation error, and mostly half a per cent: they are nearly orthogonal in the energy.
pub const PART: f64 = 0.1;

/// The first tolerance.
const FIRST: f64 = 1e-2;

/// The last tolerance, unless `fetifeti_ksp_rtol` says another.
const LAST: f64 = 1e-10;

/// The next tolerance aims at this part of the error that is allowed.
const AIM: f64 = 0.5;

/// Factors of one step, from the smallest to the largest.
const FACTORS: [f64; 2] = [1e-3, 0.3];

impl FetiFeti {
    /// Solves as [`FetiFeti::solve_from`] until the bound of the error in the energy norm is at most a tenth of the
    /// discretisation error, which `discretisation` estimates, or until `fetifeti_ksp_rtol` (1e-10 if it is not set) is
    /// reached. The Krylov method keeps the tolerance at which that was; after an error it has the one that it had
    /// before. Collective.
    ///
    /// # Errors
    /// As [`FetiFeti::solve_from`], and those of `discretisation`.
    pub fn solve_early(
        &mut self,
        start: Option<&State>,
        observe: &mut contact::Observer,
        discretisation: &mut Discretisation,
    ) -> Result<Solution> {
        let before = self.ksp().tolerances()?.0;
        let solved = self.solve_to_accuracy(start, observe, discretisation);
        solved.inspect_err(|_| {
            // The error of the solve is the one that counts.
            let _ = self.ksp().set_tolerances(Some(before), None, None, None);
        })
    }

    fn solve_to_accuracy(
        &self,
        start: Option<&State>,
        observe: &mut contact::Observer,
        discretisation: &mut Discretisation,
    ) -> Result<Solution> {
        let _staged = self.solve_stage.scope()?;
        self.check_idle()?;
        let (method, settings) = (&self.method, &self.settings);
        let last = Options::new(self.session(), &settings.method.prefix).get_f64("ksp_rtol")?;
        let last = last.unwrap_or(LAST);
        let mut rtol = FIRST.max(last);
        let go_to = |rtol: f64| self.ksp().set_tolerances(Some(rtol), None, None, None);
        go_to(rtol)?;
        let equations = self.facts().inequalities == 0;
        let (mut found, mut steps) = if equations {
            (method.solve(None)?, Vec::new())
        } else {
            contact::solve(method, &settings.contact, start, observe)?
        };
        let verdict = loop {
            let verdict = method.bounded(&found)?;
            let allowed = PART * discretisation(&found.u)?;
            let error = verdict.map_or(f64::INFINITY, |c| c.most);
            if error <= allowed || rtol <= last || !found.status.converged() {
                break verdict;
            }
            let factor = AIM * allowed / error;
            let factor = if error.is_finite() && factor > 0.0 {
                factor.clamp(FACTORS[0], FACTORS[1])
            } else {
                FACTORS[0]
            };
            rtol = (factor * rtol).max(last);
            go_to(rtol)?;
            if equations {
                found = method.further(&found, factor)?;
            } else {
                let mut state = State::warm(found.lambda.clone(), &found.active);
                state.steps = steps.len();
                let contact = contact::ContactSettings {
                    kind: ContactType::ActiveSet,
                    ..settings.contact
                };
                let (next, more) = contact::solve(method, &contact, Some(&state), observe)?;
                steps.extend(more);
                found = crate::feti::LinearSolution {
                    iterations: found.iterations + next.iterations,
                    solve_seconds: found.solve_seconds + next.solve_seconds,
                    recover_seconds: found.recover_seconds + next.recover_seconds,
                    ..next
                };
            }
        };
        if settings.method.certify {
            return self.certified(found, steps);
        }
        let mut solution = self.solution(found, steps)?;
        solution.certified = Some(verdict);
        Ok(solution)
    }
}
