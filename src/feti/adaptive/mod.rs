//! Adaptive primal constraints inside bodies whose coefficients jump.

pub mod classes;
pub mod constrain;
pub mod constraints;
pub mod pencil;
