//! The base of every crate of fetifeti: the [`Error`] with its exit code, and small linear algebra without MPI and
//! without PETSc (`linalg`).

pub mod error;
pub mod linalg;
pub mod location;

pub use error::{Error, ErrorKind, Fault, Result};
pub use location::Location;

// Helpers of tests name this crate as others do.
#[cfg(test)]
extern crate self as base;
#[cfg(test)]
#[path = "../../../tests/support/matrices.rs"]
#[allow(dead_code)]
mod matrices;
