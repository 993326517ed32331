//! The data of a solver that `-ksp_view` shows.

use super::plugin::PluginSolver;
use std::ffi::{c_char, c_int, c_void};

/// Longest name of an option's value with its end, FETIFETI_NAME in wrappers/kspfetifeti.h.
const NAME: usize = 16;

/// The data that -ksp_view shows.
#[repr(C)]
pub struct ViewData {
    bodies: c_int,
    floating: c_int,
    kernel: c_int,
    subdomains: c_int,
    primal: c_int,
    local_rows: f64,
    global_rows: f64,
    scaling: [c_char; NAME],
    work: [c_char; LINE],
}

/// Longest line of counts with its end, FETIFETI_LINE in wrappers/kspfetifeti.h.
const LINE: usize = 256;

/// The data that -ksp_view shows.
///
/// # Safety
/// `solver` comes from `fetifeti_plugin_setup`, and `facts` is valid.
#[no_mangle]
pub unsafe extern "C" fn fetifeti_plugin_facts(solver: *mut c_void, facts: *mut ViewData) {
    // SAFETY: by the caller.
    let PluginSolver { embedded, work, .. } = unsafe { &*solver.cast::<PluginSolver>() };
    let solver = embedded.solver();
    let (known, problem) = (solver.facts(), solver.problem());
    // SAFETY: by the caller.
    unsafe {
        *facts = ViewData {
            bodies: problem.n_bodies as c_int,
            floating: known.floating_bodies as c_int,
            kernel: known.kernel_dimension as c_int,
            subdomains: problem.n_subdomains as c_int,
            primal: known.primal as c_int,
            local_rows: known.multipliers_local as f64,
            global_rows: known.multipliers_global as f64,
            scaling: name(known.scaling.name()),
            work: name(&work.lines()),
        }
    };
}

/// A name as a string of C. Names that are too long are cut.
fn name<const N: usize>(name: &str) -> [c_char; N] {
    let mut out = [0; N];
    for (to, from) in out[..N - 1].iter_mut().zip(name.bytes()) {
        *to = from as c_char;
    }
    out
}
