//! The linear method from the outside: spectra, solutions, deflation, local solvers.

#[path = "../support/mod.rs"]
mod support;

mod certificate;
mod deflation;
mod direct;
mod forms;
mod lifting;
mod mortar;
mod mortar_operators;
mod spectra;
