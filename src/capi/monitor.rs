//! A function of the host that is called after each step of the contact loop.

use crate::contact::Step;
use crate::{Error, Result};
use petsc::{PetscInt, Session};
use std::ffi::{c_int, c_void};

/// FetiFetiContactStep of `wrappers/fetifeti.h`.
#[repr(C)]
pub struct ContactStep {
    step: PetscInt,
    active: PetscInt,
    entered: PetscInt,
    left: PetscInt,
    wrong: PetscInt,
    iterations: PetscInt,
    residual: f64,
    tolerance: f64,
}

/// FetiFetiContactMonitor of the header.
pub type Function = unsafe extern "C" fn(step: *const ContactStep, context: *mut c_void) -> c_int;

/// The function and what it wants to be called with.
#[derive(Clone, Copy)]
pub struct Monitor {
    function: Function,
    context: *mut c_void,
}

impl Monitor {
    /// The function, to be called with `context`.
    pub fn new(function: Function, context: *mut c_void) -> Monitor {
        Monitor { function, context }
    }

    /// Calls the function after step number `step`, from 0. Collective.
    ///
    /// # Errors
    /// The function returned an error on some rank.
    pub fn call(&self, session: &Session, step: usize, what: &Step) -> Result<()> {
        let told = ContactStep {
            step: step as PetscInt,
            active: what.active as PetscInt,
            entered: what.entered as PetscInt,
            left: what.left as PetscInt,
            wrong: what.wrong as PetscInt,
            iterations: what.iterations as PetscInt,
            residual: what.residual,
            tolerance: what.tolerance,
        };
        // SAFETY: the header asks for a function that may be called with this context until it is replaced.
        let code = unsafe { (self.function)(&told, self.context) };
        session.agree(match code {
            0 => Ok(()),
            code => {
                let call = "the monitor of FetiFetiContactMonitorSet";
                Err(Error::petsc(code, call, Vec::new()))
            }
        })
    }
}
