//! The primal problem of the bodies: S_Π, the kernels that it shows, and its refinement.

pub mod body;
pub mod coarse;
pub mod kernel;
pub mod matrix;
pub mod refinement;
pub mod slack;
pub mod space;
