//! The problem that the driver of the contact loop goes round: who solves the equations on a set of rows, by which
//! strategies.

use super::strategy::{Course, Strategy};
use crate::Result;

/// A strategy that has begun.
pub type Begun<'a, C> = Box<dyn Strategy<C> + 'a>;

/// Where a strategy begins.
#[derive(Debug, Clone)]
pub enum Begin<State> {
    /// The loop begins, from a state or from scratch.
    First(Option<State>),
    /// The strategy before has handed over.
    HandOver(State),
    /// The certificate has found rows on the wrong side.
    Again(State),
}

/// The word of the certificate.
pub enum Verdict<C: Course> {
    /// The end of the loop.
    Done(C::Solution),
    /// Rows are on the wrong side of this solution: the loop goes on from the state.
    Wrong(C::State, C::Solution),
}

/// A problem with inequalities, and its strategies: the linear method has one, with the equations as its inner problem,
/// and so has a program that compares with it, with other solvers. All methods are collective.
pub trait InnerProblem {
    /// The types of its loop.
    type Course: Course;

    /// The strategy that goes on from there.
    ///
    /// # Errors
    /// Bodies that the load pushes away for ever; PETSc's own errors.
    fn begin<'a>(
        &'a self,
        begin: Begin<<Self::Course as Course>::State>,
    ) -> Result<Begun<'a, Self::Course>>;

    /// Why a loop may take no further step from this state; `None` if it may, as where strategies end by themselves.
    fn stop(
        &self,
        _state: &<Self::Course as Course>::State,
    ) -> Option<<Self::Course as Course>::End> {
        None
    }

    /// Whether the question if there is a solution is due after so many steps of a strategy.
    fn is_doubtful(&self, _steps: usize) -> bool {
        false
    }

    /// Asks whether there is a solution: an error names bodies which the load pushes away for ever. `at` is where the
    /// loop is. By itself a problem does not ask: a loop that finds nothing says so.
    ///
    /// # Errors
    /// Such bodies.
    fn doubt(&self, _at: &<Self::Course as Course>::State) -> Result<()> {
        Ok(())
    }

    /// Asks whether there is a solution where a loop has ended, if it has found none.
    ///
    /// # Errors
    /// Such bodies.
    fn doubt_end(&self, _found: &<Self::Course as Course>::Solution) -> Result<()> {
        Ok(())
    }

    /// Certifies the end of the loop, after so many steps, in round `round`, from 0.
    ///
    /// # Errors
    /// PETSc's own.
    fn certify(
        &self,
        found: <Self::Course as Course>::Solution,
        steps: usize,
        round: usize,
    ) -> Result<Verdict<Self::Course>>;

    /// The solution of a loop that has gone on from a certified one: iterations and seconds of both.
    fn joined(
        &self,
        _before: &<Self::Course as Course>::Solution,
        next: <Self::Course as Course>::Solution,
    ) -> <Self::Course as Course>::Solution {
        next
    }
}
