//! The state from which a stepper resumes, and where it is made.

use serde::{Deserialize, Serialize};

use super::layout::{GlobalState, RowLayout};
use crate::displaced::Displaced;
use base::{Error, Result};
use fetifeti::solution::State;
use petsc::Session;

/// Where a [`Stepper`](super::Stepper) stands, without the ranks: all that it needs to resume.
///
/// It serialises by the names of its fields. A format that keeps names (JSON is one) passes over a field that it does
/// not know, and a field that is added later gets `#[serde(default)]`: states of other versions stay readable.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct StepperState {
    /// The load step, from 0.
    pub load_step: usize,
    /// The displacements by body and node for which the contacts of the load step were made; empty unless load steps
    /// renew them.
    #[serde(default)]
    pub left: Vec<(usize, usize, [f64; 3])>,
    /// The state of the contact loop in the load step.
    pub contact: GlobalState,
}

impl StepperState {
    /// Whether the state can be one of a scene with `n` load steps.
    pub(super) fn check(&self, n: usize) -> Result<()> {
        if self.load_step >= n {
            return Err(Error::input(format!(
                "the checkpoint stands in load step {}, expected one below {n}",
                self.load_step
            )));
        }
        if !self.contact.is_consistent() {
            return Err(Error::input(
                "the checkpoint contradicts itself, expected a state of a stepper",
            ));
        }
        Ok(())
    }
}

/// Makes checkpoints inside a load step; from [`Stepper::checkpointer`](super::Stepper::checkpointer).
pub struct Checkpointer {
    pub(super) session: Session,
    pub(super) rows: RowLayout,
    pub(super) load_step: usize,
    /// The displacements for which the contacts of the step were made.
    pub(super) left: Displaced,
}

impl Checkpointer {
    /// The state of the stepper where its contact loop is in this state, on rank 0; `None` on the others. Collective.
    pub fn checkpoint(&self, state: &State) -> Option<StepperState> {
        Some(StepperState {
            contact: self.rows.gather(&self.session, state)?,
            load_step: self.load_step,
            left: self.left.nodes(),
        })
    }
}
