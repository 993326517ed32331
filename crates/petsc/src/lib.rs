//! The safe layer over PETSc and SLEPc, one file per class; names are PETSc's without the prefix.
//!
//! - A [`Session`] stands for an initialised PETSc. Every object keeps it alive, so nothing outlives `PetscFinalize`.
//! - Objects are reference counted by PETSc: `clone` counts up, `drop` counts down.
//! - PETSc owns the captured data of a shell ([`ShellMat`], [`ShellPc`], [`ShellOp`]) and drops it with the object.
//! - An error or a panic in a callback travels through PETSc's C frames as an error code and comes out of the outer
//!   call ([`Ksp::solve`], [`Mat::mult`], …) as the original Rust error.
//! - Nothing that is PETSc's is `Send`: PETSc is not thread safe.

#![allow(unsafe_code)]

#[macro_use]
mod error;
mod citations;
mod eigen_search;
mod eps;
mod handle;
mod has;
mod heap;
mod is;
mod known;
mod ksp;
mod log;
mod mat;
mod matis;
mod nested;
mod options;
mod partition;
mod pc;
mod scatter;
mod session;
mod shell;
pub mod signals;
mod spectrum;
mod together;
mod vec;
mod watch;

pub use citations::cite;
pub use eigen_search::{EigenSearch, Listener};
pub use eps::{End, Eps, ProblemType, Settled, Which};
pub use handle::Handle;
pub use has::{has_cholesky, has_pc};
pub use heap::{give_back, let_threads_allocate, Heap};
pub use is::Is;
pub use known::known;
pub use ksp::{ConvergedReason, Ksp, NormType};
pub use log::{counters, Counters, Event, LogStage, Scope};
pub use mat::{Mat, MatFlag};
pub use matis::AttachedNullSpace;
pub use options::{Named, Options};
pub use partition::partition;
pub use pc::Pc;
pub use petsc_sys::{PetscInt, REPEATS};
pub use scatter::Scatter;
pub use session::version;
pub use session::{max_memory, print_on_stderr, Comm, Session};
pub use shell::{ShellMat, ShellOp, ShellPc};
pub use spectrum::extreme_eigenvalues;
pub use vec::{Array, ArrayMut, Vec};
pub use watch::{LargeEigenvalue, ResidualMonitor, Stopped};

/// PETSc's own types and the guard against unwinding, for `capi`, which takes objects from C.
pub mod raw {
    pub use super::error::{caught, settled as settle};
    pub use petsc_sys::{
        ff_comm_f2c, ff_comm_self, ff_error, MPI_Comm, Mat, MatNullSpace, PetscInt, PetscViewer,
        Vec, IS, KSP, PC,
    };

    /// Prints to a viewer if it is a text viewer.
    ///
    /// # Safety
    /// `viewer` is a live viewer.
    pub unsafe fn show(viewer: PetscViewer, text: &str) -> base::Result<()> {
        let mut ascii = 0;
        petsc!(ff_viewer_is_ascii(viewer, &mut ascii))?;
        if ascii != 0 {
            let text = super::error::c_string(text);
            petsc!(ff_viewer_print(viewer, text.as_ptr()))?;
        }
        Ok(())
    }
}

// Helpers of tests name this crate as others do.
#[cfg(test)]
extern crate self as petsc;
#[cfg(test)]
#[path = "../../../tests/support/session.rs"]
mod testing;
#[cfg(test)]
#[path = "../tests/mod.rs"]
mod tests;
