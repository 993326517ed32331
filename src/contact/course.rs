//! The types of a contact loop around the linear method.

use super::state::{State, Step};
use super::strategy::Course;
use crate::feti::LinearSolution;
use crate::status::Status;

/// The types of a loop around the linear method.
pub(super) struct DualCourse;

impl Course for DualCourse {
    type State = State;
    type Step = Step;
    type End = Status;
    type Solution = LinearSolution;
}
