//! MUMPS on this process alone.
//!
//! MUMPS keeps a list of its instances in variables of the process and speaks to MPI, which most programs start for one thread: all calls are
//! made one at a time, and [`LocalSolver::most_threads`](crate::cholesky::interior::LocalSolver::most_threads) keeps them on the thread that
//! started MPI.

use std::os::raw::c_int;
use std::ptr::null_mut;

use petsc_sys as sys;

use super::direct::{alone, complaint, refusal, Refusal};

const NAME: &str = "MUMPS";

/// Whether this build has MUMPS.
pub fn have_mumps() -> bool {
    // SAFETY: takes nothing, returns a constant.
    unsafe { sys::ff_have_mumps() != 0 }
}

/// An instance: the analysis of a pattern, and its factor once there is one.
#[derive(Debug)]
pub struct Mumps {
    raw: *mut sys::ff_mumps,
    n: usize,
    kept: usize,
    /// Entries of one triangle, counted from 1: MUMPS keeps pointers to them.
    _row: Vec<i32>,
    col: Vec<i32>,
}

// SAFETY: an instance belongs to no thread; calls are made one at a time, under one lock.
unsafe impl Send for Mumps {}
// SAFETY: as above: shared calls take the lock.
unsafe impl Sync for Mumps {}

impl Drop for Mumps {
    fn drop(&mut self) {
        let _alone = alone();
        // SAFETY: we own the instance, and this is its end.
        unsafe { sys::ff_mumps_free(self.raw) }
    }
}

impl Mumps {
    /// Analyses the pattern of one triangle, `entries` of (row, column) counted from 0, for elimination in the order given; the last `kept`
    /// unknowns are not eliminated.
    ///
    /// # Errors
    /// [`Refusal::Failed`], also where MPI does not run.
    pub fn new(
        n: usize,
        entries: impl Iterator<Item = (u32, u32)>,
        kept: usize,
    ) -> Result<Mumps, Refusal> {
        let (row, col): (Vec<i32>, Vec<i32>) =
            entries.map(|(i, j)| (i as i32 + 1, j as i32 + 1)).unzip();
        let inside = |i: &i32| (1..=n as i32).contains(i);
        assert!(row.iter().chain(&col).all(inside) && kept <= n);
        let (mut raw, mut why) = (null_mut(), 0);
        let locked = alone();
        // SAFETY: both arrays have that many entries and live as long as the instance: a vector that moves keeps its heap.
        let code = unsafe {
            sys::ff_mumps_analyse(
                n as c_int,
                row.len() as c_int,
                row.as_ptr(),
                col.as_ptr(),
                kept as c_int,
                &mut raw,
                &mut why,
            )
        };
        drop(locked);
        match code {
            0 => Ok(Mumps {
                raw,
                n,
                kept,
                _row: row,
                col,
            }),
            code => Err(refusal(NAME, "analysis", code, -1, why)),
        }
    }

    /// Factors the matrix with these values by entry, pivots below `small` being none, and returns the Schur complement of the unknowns kept, by
    /// columns, both triangles.
    ///
    /// # Errors
    /// A pivot that is not positive (MUMPS counts negative ones and does not say where they are), or the library's own.
    pub fn factor(&mut self, values: &[f64], small: f64) -> Result<Vec<f64>, Refusal> {
        assert_eq!(values.len(), self.col.len());
        let mut schur = vec![0.0; self.kept * self.kept];
        let (mut column, mut why) = (-1, 0);
        let locked = alone();
        // SAFETY: lengths are as the analysis was told; MUMPS does not use the pointers after the call.
        let code = unsafe {
            sys::ff_mumps_factor(
                self.raw,
                values.as_ptr(),
                small,
                schur.as_mut_ptr(),
                &mut column,
                &mut why,
            )
        };
        drop(locked);
        match code {
            0 => Ok(schur),
            code => Err(refusal(NAME, "factorisation", code, column, why)),
        }
    }

    /// x ← K_II⁻¹ x on the unknowns eliminated and zero on those kept, for vectors of length n that lie one after the other.
    ///
    /// # Panics
    /// If MUMPS fails, for want of memory.
    pub fn solve(&self, x: &mut [f64]) {
        if self.n == 0 {
            return;
        }
        assert_eq!(x.len() % self.n, 0);
        let mut why = 0;
        let locked = alone();
        // SAFETY: `x` holds that many vectors of length n, and nobody else uses the instance.
        let code = unsafe {
            let columns = (x.len() / self.n) as c_int;
            sys::ff_mumps_solve(self.raw, columns, x.as_mut_ptr(), &mut why)
        };
        drop(locked);
        assert!(code == 0, "{}", complaint(NAME, "solution", code, why));
    }

    /// Bytes held by the factor.
    pub fn bytes(&self) -> usize {
        // SAFETY: the instance is alive.
        unsafe { sys::ff_mumps_bytes(self.raw) as usize }
    }
}
