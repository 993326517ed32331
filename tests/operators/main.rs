//! The operators of the method, compared with dense algebra, and what it sends.

// As the other test programs name it.
extern crate fetifeti_scene as scene;

mod coarse_solvers;
mod congruent;
mod dense;
mod equal;
mod forms;
mod operators;
mod springs;
mod traffic;
mod turn;
mod weights;

#[path = "../support/checks.rs"]
#[allow(dead_code)]
mod checks;
#[path = "../support/direct.rs"]
#[allow(dead_code)]
mod direct;
#[path = "../support/matrices.rs"]
#[allow(dead_code)]
mod matrices;
#[path = "../support/mpi.rs"]
#[allow(dead_code)]
mod mpi;
#[path = "../support/session.rs"]
mod testing;
