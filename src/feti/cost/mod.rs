//! Choices by counting: dense or sparse operators, M_C or M_D, sizes.

pub mod choice;
pub mod forms;
pub mod sizes;
pub mod variation;
