//! Sets of the assembled problem from a method that converges (see [`DampedNewton`]).
//!
//! Each of its sets is tried: its equations are solved, and the sets that follow by the rule of the active set, for as
//! long as there are fewer and fewer wrong rows. The loop ends with the first set that satisfies all conditions. So the
//! method guarantees the end, and the trials give the accuracy.

use std::cell::RefCell;

use super::course::{ActiveSetEnd, AssembledCourse, OuterEnd, OuterStep, SetState};
use super::damped_newton::DampedNewton;
use super::equations::{Equations, Manner, Solved};
use super::groups::MultiplierSigns;
use super::reduced::Reduced;
use super::rows::Inequalities;
use base::Result;
use fetifeti::inside::driver::{Proposal, Strategy};
use petsc::Session;

/// The strategy.
pub(super) struct Trials<'a, 'm> {
    equations: &'a RefCell<Equations<'m>>,
    search: DampedNewton<'m>,
    state: SetState,
    /// Why the method is needed.
    why: &'static str,
    /// The least number of wrong rows in the present trial; `None` where the next set comes from the search.
    fewest: Option<usize>,
    last: Option<Solved>,
}

impl<'a, 'm> Trials<'a, 'm> {
    /// The search from zero, after the trouble of another strategy. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(
        (session, rows, reduced): (&Session, &'m Inequalities, &'m Reduced),
        equations: &'a RefCell<Equations<'m>>,
        state: SetState,
    ) -> Result<Trials<'a, 'm>> {
        Ok(Trials {
            equations,
            search: DampedNewton::new(session, rows, reduced)?,
            why: state.trouble.unwrap_or("DIVERGED_CONTACT_ITS"),
            fewest: state.fewest,
            state,
            last: None,
        })
    }

    /// The end of the loop at this solution, if it is one or nothing is left to try.
    fn end(&self, solved: &Solved, worse: bool) -> Option<OuterEnd> {
        let (reason, failed) = solved.reason.clone();
        let [settled, _] = solved.settles(solved.certificate.holds());
        if failed {
            Some((false, reason))
        } else if settled {
            Some((solved.met, reason))
        } else if worse && self.search.is_exhausted() {
            Some((false, self.why.to_string()))
        } else {
            None
        }
    }
}

impl Strategy<AssembledCourse> for Trials<'_, '_> {
    fn state(&self) -> &SetState {
        &self.state
    }

    fn step(&mut self) -> Result<(OuterStep, Proposal<OuterEnd>)> {
        let mut equations = self.equations.borrow_mut();
        let mut step = OuterStep::default();
        let fewest = match self.fewest {
            Some(fewest) => fewest,
            None => {
                let round = self.search.round(equations.solvers)?;
                (step.systems, step.iterations) = (round.steps, round.iterations);
                equations.setup += round.setup;
                equations.restart(&self.search.u)?;
                (self.state.active, self.state.priority) = (round.active, round.priority);
                usize::MAX
            }
        };
        let manner = Manner::to_the_end(MultiplierSigns::Pushing);
        let solved = equations.solved(&mut self.state, manner)?;
        step.systems += solved.step.systems;
        step.iterations += solved.step.iterations;
        let wrong = solved.judged.count();
        let worse = !solved.held || wrong >= fewest;
        if let Some(end) = self.end(&solved, worse) {
            self.last = Some(solved);
            return Ok((step, Proposal::End(end)));
        }
        if worse {
            self.fewest = None;
        } else {
            self.fewest = Some(wrong);
            self.state = solved.following();
        }
        Ok((step, Proposal::GoOn))
    }

    fn finish(
        self: Box<Self>,
        steps: &[OuterStep],
        seconds: f64,
        end: OuterEnd,
    ) -> Result<ActiveSetEnd> {
        let last = self.last.expect("the loop ends at a solution");
        self.equations.borrow().ended(last, (steps, seconds), end)
    }
}
