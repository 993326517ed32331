//! Choices by counting: dense or sparse operators, M_C or M_D, sizes.

pub mod choice;
pub mod forms;
#[cfg(feature = "cli")]
pub mod sizes;
pub mod variation;
