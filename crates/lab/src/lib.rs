//! Where the method is measured against others and against itself.
//!
//! - `assembled`: the problem as one matrix, with its active set, for PETSc's own solvers and the direct solution;
//! - `baselines`: PETSc's own solvers on the same scene: `fetifeti compare` and `fetifeti bench`;
//! - `study`: questions that take many runs;
//! - `delaunay`: meshes that the benchmarks make.
//!
//! No program that solves contact needs this crate.
// `len` is a number of unknowns or of rows here, which is never asked whether it is 0.
#![allow(clippy::len_without_is_empty)]

pub mod assembled;
pub mod baselines;
pub mod delaunay;
pub mod study;

#[cfg(test)]
#[path = "../../../tests/support/session.rs"]
mod testing;
