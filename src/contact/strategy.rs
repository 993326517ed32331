//! A strategy of the contact loop: it proposes steps, and the driver acts on its answers.

use crate::Result;

/// The types of a course of the loop.
pub trait Course {
    /// Where a strategy is, sufficient for it or another one to continue from there.
    type State: Clone;
    /// The record of a step.
    type Step;
    /// Why a strategy has ended.
    type End;
    /// The end of the loop.
    type Solution;
}

/// The answer of a strategy after a step: the next one, or none.
#[derive(Debug, Clone, PartialEq)]
pub enum Proposal<End> {
    /// Another step.
    GoOn,
    /// Nothing: the strategy has found a solution, or its equations were not solved.
    End(End),
}

/// Whether a strategy goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Checkpoint {
    /// It does.
    Update,
    /// It has come to where it gets no further: another strategy takes over from its state.
    HandOver,
}

/// A strategy of the contact loop. The methods are collective.
pub trait Strategy<C: Course> {
    /// Where the loop is after the last step.
    fn state(&self) -> &C::State;

    /// Whether the question if there is a solution must be answered before the first step, because the strategy would
    /// go on for ever without one.
    fn asks_first(&self) -> bool {
        false
    }

    /// Whether the strategy goes on from where it is.
    fn checkpoint(&self) -> Checkpoint {
        Checkpoint::Update
    }

    /// One outer step: sets the rows that hold, solves, judges, and says what is to follow.
    ///
    /// # Errors
    /// Bodies that the load pushes away for ever; PETSc's own errors.
    fn step(&mut self) -> Result<(C::Step, Proposal<C::End>)>;

    /// The solution where the loop is, after these steps and seconds.
    ///
    /// # Errors
    /// PETSc's own.
    fn finish(self: Box<Self>, steps: &[C::Step], seconds: f64, end: C::End)
        -> Result<C::Solution>;
}
