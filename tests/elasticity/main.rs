//! Elasticity in the plane and in space: patch tests, spectra, adaptive constraints.

#[path = "../support/mod.rs"]
mod support;

mod adaptive;
mod patch;
mod rings;
mod solve;
mod spectra;
