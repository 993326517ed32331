//! The method in other programs: the plug-in, the C API, and the examples of the crate.

#[path = "../support/mod.rs"]
mod support;

mod bodies;
mod capi_c;
mod capi_languages;
mod clients;
mod examples;
mod friction;
mod installed;
mod ksp;
mod languages;
mod mortar;
mod outer;
mod packages;
mod partitions;
mod petsc_examples;
mod python;
mod steps;
mod ways;
mod wrong_petsc;
