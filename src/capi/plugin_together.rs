//! Several right-hand sides of a KSP at once (KSPMatSolve).

use super::error::status;
use super::handle::lent;
use super::plugin::{forward, PluginSolver, Wishes};
use crate::Result;
use petsc::{raw, Vec as PetscVec};
use std::ffi::{c_int, c_void};

/// Runs the iterations for `n` right-hand sides with initial guess zero. `fetifeti_plugin_solve` finishes each: its
/// `begun` says which. Collective.
///
/// # Safety
/// `solver` comes from `fetifeti_plugin_setup`; `b` has `n` vectors of its matrix, and `wishes` is valid.
#[no_mangle]
pub unsafe extern "C" fn fetifeti_plugin_together(
    solver: *mut c_void,
    wishes: *const Wishes,
    n: c_int,
    b: *const raw::Vec,
) -> c_int {
    status("KSPMatSolve_FETIFETI", |at_work| {
        // A monitor may ask for the present solution while this runs: hence no unique reference.
        // SAFETY: by the caller.
        let (plugin, wishes) = unsafe { (&*solver.cast::<PluginSolver>(), &*wishes) };
        let solver = &plugin.embedded;
        *at_work = Some(solver.session().clone());
        // SAFETY: by the caller.
        let given = unsafe { std::slice::from_raw_parts(b, n.max(0) as usize) };
        let given = given.iter().map(|&b| lent(b, solver.session()));
        let given = given.collect::<Result<Vec<PetscVec>>>()?;
        forward(solver, wishes)?;
        *plugin.begun.borrow_mut() = solver.together(&given)?;
        Ok(())
    })
}
