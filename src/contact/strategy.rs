//! A strategy of the contact loop: it proposes steps, and the driver acts on its answers.

use super::state::{State, Step};
use crate::feti::LinearSolution;
use crate::status::Status;
use crate::Result;

/// The answer of a strategy after a step: the next one, or none.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Proposal {
    /// Another step.
    GoOn,
    /// Nothing: the strategy has found a solution, or its equations were not solved. The status says which.
    End(Status),
}

/// Whether a strategy goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Checkpoint {
    /// It does.
    Update,
    /// It has come to where it gets no further: the augmented Lagrangian takes over from its state.
    HandOver,
}

/// A strategy of the contact loop. The methods are collective.
pub(super) trait Strategy {
    /// Where the loop is after the last step, sufficient to continue from there.
    fn state(&self) -> &State;

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
    fn step(&mut self) -> Result<(Step, Proposal)>;

    /// The solution where the loop is, after these steps and seconds.
    ///
    /// # Errors
    /// PETSc's own.
    fn finish(
        self: Box<Self>,
        steps: &[Step],
        seconds: f64,
        status: Status,
    ) -> Result<LinearSolution>;
}
