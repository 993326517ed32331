//! The base of every crate of fetifeti: the [`Error`] with its exit code, small linear algebra without MPI and without
//! PETSc (`linalg`), and files that are written as a whole or not at all (`output`).

pub mod error;
pub mod linalg;
pub mod location;
pub mod output;

pub use error::{Error, ErrorKind, Fault, Result};
pub use location::Location;

// Helpers of tests name this crate as others do.
#[cfg(test)]
extern crate self as base;
#[cfg(test)]
#[path = "../../../tests/support/matrices.rs"]
#[allow(dead_code)]
mod matrices;
#[cfg(test)]
#[path = "../../../tests/support/scratch.rs"]
mod scratch;
