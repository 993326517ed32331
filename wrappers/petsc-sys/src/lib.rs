//! Raw bindings to the part of PETSc and SLEPc that fetifeti uses.
//!
//! Names and meaning are PETSc's own; `ff_*` functions come from `shim.c` and stand for macros, inline functions and
//! things that differ between PETSc 3.18 and 3.26. The safe layer is the crate `fetifeti-petsc`.
#![allow(
    non_camel_case_types,
    non_snake_case,
    non_upper_case_globals,
    clippy::all
)]

pub use mpi::ffi::MPI_Comm;
use std::os::raw::c_int;

/// An MPI count or rank.
pub type PetscMPIInt = c_int;
/// PETSc's error code: an int in 3.18, an enum of the same size later.
pub type PetscErrorCode = c_int;

include!(concat!(env!("OUT_DIR"), "/bindings.rs"));

/// Whether a MATIS may have several subdomains on a rank (`ff_allow_repeated`).
pub const REPEATS: bool =
    PETSC_VERSION_MAJOR > 3 || (PETSC_VERSION_MAJOR == 3 && PETSC_VERSION_MINOR >= 21);

/// PETSc chooses the value.
pub const PETSC_DECIDE: PetscInt = -1;
/// PETSc computes the value.
pub const PETSC_DETERMINE: PetscInt = -1;
/// Keep the present value; its name was PETSC_DEFAULT up to 3.21.
pub const PETSC_CURRENT: PetscInt = -2;

/// Error in external code; a macro in 3.18, a member of an enum later, the same number in all.
pub const PETSC_ERR_LIB: c_int = 76;

/// A truth value of PETSc: a four-byte enum up to 3.23, one byte from 3.24.
pub trait Flag: Copy {
    /// From a Rust truth value.
    fn of(value: bool) -> Self;
    /// To a Rust truth value.
    fn get(self) -> bool;
}

impl Flag for bool {
    fn of(value: bool) -> Self {
        value
    }
    fn get(self) -> bool {
        self
    }
}

impl Flag for std::os::raw::c_uint {
    fn of(value: bool) -> Self {
        value.into()
    }
    fn get(self) -> bool {
        self != 0
    }
}
