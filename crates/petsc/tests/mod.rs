//! Tests of the layer over PETSc and SLEPc.

mod eps;
mod mpi;
mod objects;
mod options;
mod shells;
#[path = "../../../tests/support/mpi.rs"]
#[allow(dead_code)]
mod under_mpirun;
