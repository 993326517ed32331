//! The load steps of a scene, for programs in C: the functions of `wrappers/step/fetifeti_step.h`, whose manual pages
//! are there.
//!
//! The library is one of its own because scenes stand on the solver: `libfetifeti.so` has none. It is named after its
//! functions: a second library `fetifeti_scene` would collide with the crate of that name.
//!
//! Handles, errors and panics are those of `fetifeti.h` (`src/capi`). No panic unwinds into C, and an error is one
//! sentence for the host's error handler.

#![allow(unsafe_code)]

mod checkpoint;
mod life;
mod object;
mod results;
mod rows;
