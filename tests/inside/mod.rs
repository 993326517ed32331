//! Tests of what only the crate itself can reach: operators against dense algebra, the layer over PETSc, the files of the report.

mod dense;
mod operators;
mod petsc;
mod petsc_eps;
mod petsc_mpi;
mod report_contact;
mod support;
mod traffic;
