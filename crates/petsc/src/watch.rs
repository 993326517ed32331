//! Solves that somebody watches and may stop early.

use std::ffi::{c_int, c_void};

use super::error::{got, guard};
use super::{Ksp, Vec};
use base::Result;
use petsc_sys as sys;

/// The condition on the eigenvalue estimates of CG that stops a solve.
#[derive(Debug, Clone, Copy)]
pub struct LargeEigenvalue {
    /// Iterations before the first look at the estimates.
    pub first: usize,
    /// The solve is stopped above this eigenvalue.
    pub limit: f64,
    /// It is no longer stopped once the residual is below this.
    pub rest: f64,
}

/// Called after each iteration with the residual norm of the convergence test; `true` stops the solve. All ranks give
/// the same answer.
pub type ResidualMonitor<'a> = dyn FnMut(f64) -> Result<bool> + 'a;

/// Who stopped a solve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stopped {
    /// Nobody: the method's own test ended it.
    No,
    /// A large eigenvalue.
    Eigenvalue,
    /// The look.
    Look,
}

impl Ksp {
    /// Solves A x = b and may stop early: at a large eigenvalue (CG only), or if `look` says so. Collective.
    ///
    /// # Errors
    /// Those of [`Ksp::solve`], and the error of `look`.
    pub fn solve_watched(
        &self,
        b: &Vec,
        x: &Vec,
        eigenvalue: Option<LargeEigenvalue>,
        look: Option<&mut ResidualMonitor>,
    ) -> Result<Stopped> {
        let (b, x) = (b.read()?, x.write()?);
        let (first, limit, rest) = match eigenvalue {
            Some(watch) => (watch.first as c_int, watch.limit, watch.rest),
            None => (-1, 0.0, 0.0),
        };
        let looks = look.is_some();
        let mut look: &mut ResidualMonitor = match look {
            Some(look) => look,
            None => &mut |_| Ok(false),
        };
        // PETSc gives the address of the reference back to `looked` during this solve only.
        let looker = &mut look as *mut &mut ResidualMonitor as *mut c_void;
        let callback: sys::ff_look = looks.then_some(looked as _);
        let stopped = got(|stopped| {
            petsc!(ff_ksp_solve_watched(
                self.raw(),
                b,
                x,
                first,
                limit,
                rest,
                callback,
                looker,
                stopped
            ))
        })?;
        Ok(match stopped as u32 {
            sys::FF_EIGENVALUE => Stopped::Eigenvalue,
            sys::FF_LOOK => Stopped::Look,
            _ => Stopped::No,
        })
    }
}

unsafe extern "C" fn looked(looker: *mut c_void, residual: f64, stop: *mut c_int) -> c_int {
    guard("a look at the iteration", || {
        // SAFETY: `solve_watched` passes the address of its reference, which lives until the solve returns, and a place
        // for the answer.
        let (look, stop) = unsafe { (&mut *(looker as *mut &mut ResidualMonitor), &mut *stop) };
        *stop = c_int::from(look(residual)?);
        Ok(())
    })
}
