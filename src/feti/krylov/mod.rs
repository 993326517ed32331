//! The Krylov method: project, iterate, look at the spectrum, deflate, refine, certify, recover. [`solve`] is the
//! module to read first.

mod admissible;
mod bound;
pub mod certificate;
pub mod certified;
pub(super) mod check;
mod eigenvalues;
mod error;
pub mod iterate;
mod leftover;
pub mod loads;
pub mod recovery;
mod recycling;
pub mod refinement;
pub mod residual;
mod rest;
pub(super) mod shells;
pub mod solve;
pub mod system;
pub mod tally;
pub mod target;
pub mod together;
pub mod verdict;
