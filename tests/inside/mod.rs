//! Tests of parts that only the crate itself can access: operators compared with dense algebra, the PETSc layer, the
//! files of the report.

mod coarse_solvers;
mod dense;
mod operators;
mod petsc;
mod petsc_eps;
mod petsc_mpi;
mod petsc_options;
mod petsc_shells;
mod report_contact;
mod soak;
pub(crate) mod support;
mod traffic;
