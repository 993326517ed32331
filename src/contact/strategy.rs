//! What a strategy of the contact loop is: it proposes steps, and the driver acts on what it says.
//!
//! | strategy | proposes |
//! |---|---|
//! | [`ActiveSet`] | the equations on the set that multipliers and gaps ask for |
//! | [`AugmentedLagrangian`] | semismooth Newton steps on springs, and trials of the sets that they find |
//! | [`Smalbe`] | bound-constrained problems by MPRGP, and trials of the sets that they find |
//!
//! A trial wraps a strategy: it is an [`ActiveSet`] that is followed for as long as it comes nearer.

use super::active_set::ActiveSet;
use super::lagrangian::AugmentedLagrangian;
use super::settings::{ContactSettings, ContactType};
use super::smalbe::Smalbe;
use super::state::{State, Step};
use crate::feti::{LinearMethod, LinearSolution};
use crate::status::Status;
use crate::Result;

/// What is to follow a step.
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

/// The strategy of this kind, from `start` or from scratch. Collective.
///
/// # Errors
/// Bodies that the load pushes away for ever; PETSc's own errors.
pub(super) fn begin<'a>(
    kind: ContactType,
    method: &'a LinearMethod,
    settings: &'a ContactSettings,
    start: Option<State>,
) -> Result<Box<dyn Strategy + 'a>> {
    let cold = || State::cold(&method.dual().stiffness.jump);
    Ok(match kind {
        ContactType::ActiveSet => Box::new(ActiveSet::new(method, settings, start.as_ref())?),
        ContactType::AugmentedLagrangian => {
            let state = start.unwrap_or_else(cold);
            Box::new(AugmentedLagrangian::new(method, settings, state)?)
        }
        ContactType::Smalbe => {
            let state = start.unwrap_or_else(cold);
            Box::new(Smalbe::new(method, settings, state)?)
        }
    })
}
