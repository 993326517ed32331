//! Sets of the assembled problem that follow from each other: the primal-dual active set.
//!
//! It starts from all candidates. While the set changes, problems are solved loosely, and u is the start of the next
//! solve; once the set stays, its problem is solved to the final tolerance. If a set comes back, the strategy becomes
//! careful: exact solves first, then one row at a time. These sets need not settle. If a set comes back again, if there
//! are too many, or if the last row that holds a body pulls, it hands over.

use std::cell::RefCell;
use std::collections::HashSet;

use super::course::{ActiveSetEnd, AssembledCourse, OuterEnd, OuterStep, SetState};
use super::equations::{Equations, Manner, Solved};
use super::groups::MultiplierSigns;
use base::Result;
use fetifeti::inside::driver::{Checkpoint, Proposal, Strategy};

/// Number of steps after which the sets come from the method that converges.
const STEPS: usize = 200;

/// How carefully the set is changed.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Caution {
    Loose,
    Exact,
    Single,
}

/// The strategy.
pub(super) struct WanderingSets<'a, 'm> {
    equations: &'a RefCell<Equations<'m>>,
    state: SetState,
    /// Whether the set was given, and is the only one.
    is_given: bool,
    /// Whether the next set is solved to the end.
    tight: bool,
    caution: Caution,
    visited: HashSet<Vec<bool>>,
    steps: usize,
    /// The wrong rows of the set before.
    fewest: usize,
    last: Option<Solved>,
}

impl<'a, 'm> WanderingSets<'a, 'm> {
    /// The sets that follow from that of `state`; it is the only one if it was given.
    pub fn new(
        equations: &'a RefCell<Equations<'m>>,
        state: SetState,
        is_given: bool,
    ) -> WanderingSets<'a, 'm> {
        WanderingSets {
            equations,
            state,
            is_given,
            tight: is_given,
            caution: Caution::Loose,
            visited: HashSet::new(),
            steps: 0,
            fewest: 0,
            last: None,
        }
    }

    /// Whether the certificate of a careful step holds: sets that come back differ only in rows that rounding decides.
    fn is_right(&self, solved: &Solved, refined: bool) -> bool {
        refined && self.caution != Caution::Loose && solved.certificate.holds()
    }

    /// The end of the loop at this solution, if it is one.
    fn end(&self, solved: &Solved, refined: bool) -> Option<OuterEnd> {
        let (reason, failed) = solved.reason.clone();
        let [settled, _] = solved.settles(self.is_right(solved, refined));
        if failed {
            Some((false, reason))
        } else if self.is_given {
            Some((!refined || solved.met, reason))
        } else if settled {
            Some((solved.met, reason))
        } else {
            None
        }
    }

    /// Moves on to the next set.
    fn advance(&mut self, solved: Solved, refined: bool) {
        let [_, loose] = solved.settles(self.is_right(&solved, refined));
        self.tight = solved.stays() && !loose;
        if self.tight {
            self.equations.borrow_mut().again(solved);
            return;
        }
        let back = !self.visited.insert(solved.next.clone());
        let trouble = if loose {
            Some("DIVERGED_CONTACT_LOOSE")
        } else if self.steps >= STEPS || (back && self.caution == Caution::Single) {
            Some("DIVERGED_CONTACT_ITS")
        } else {
            None
        };
        if back && trouble.is_none() {
            self.caution = match self.caution {
                Caution::Loose => Caution::Exact,
                _ => Caution::Single,
            };
            self.visited.clear();
        }
        let wrong = solved.judged.count();
        let better = solved.held && wrong < self.fewest;
        self.fewest = wrong;
        self.state = solved.following();
        self.state.trouble = trouble;
        self.state.fewest = better.then_some(wrong);
    }
}

impl Strategy<AssembledCourse> for WanderingSets<'_, '_> {
    fn state(&self) -> &SetState {
        &self.state
    }

    fn checkpoint(&self) -> Checkpoint {
        match self.state.trouble {
            Some(_) => Checkpoint::HandOver,
            None => Checkpoint::Update,
        }
    }

    fn step(&mut self) -> Result<(OuterStep, Proposal<OuterEnd>)> {
        let manner = Manner {
            exact: self.tight || self.caution != Caution::Loose,
            single: self.caution == Caution::Single,
            ..Manner::to_the_end(MultiplierSigns::Any)
        };
        let (solved, refined) = {
            let mut equations = self.equations.borrow_mut();
            let solved = equations.solved(&mut self.state, manner)?;
            (solved, equations.is_refined())
        };
        self.steps += 1;
        let step = solved.step;
        if let Some(end) = self.end(&solved, refined) {
            self.last = Some(solved);
            return Ok((step, Proposal::End(end)));
        }
        self.advance(solved, refined);
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
