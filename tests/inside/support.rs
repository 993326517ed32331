//! Helpers that these tests share with the test programs.
#![allow(dead_code)]

#[path = "../support/checks.rs"]
pub mod checks;
#[path = "../support/direct.rs"]
pub mod direct;
#[path = "../support/mpi.rs"]
pub mod mpi;
