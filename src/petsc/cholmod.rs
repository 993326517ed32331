//! CHOLMOD's factors of symmetric positive definite matrices.

use std::os::raw::c_int;
use std::ptr::null_mut;

use petsc_sys as sys;

use super::direct::{blas, complaint, refusal, Refusal};

const NAME: &str = "CHOLMOD";

/// Whether this build has CHOLMOD.
pub fn have_cholmod() -> bool {
    // SAFETY: takes nothing, returns a constant.
    unsafe { sys::ff_have_cholmod() != 0 }
}

/// The upper triangle of a symmetric matrix by compressed columns, rows increasing, the diagonal included.
#[derive(Debug, Clone, Copy)]
pub struct Upper<'a> {
    /// Start of each column; length n + 1.
    pub ptr: &'a [i32],
    /// Row of each entry.
    pub row: &'a [i32],
}

impl Upper<'_> {
    fn n(self) -> usize {
        self.ptr.len() - 1
    }

    /// What C relies on.
    fn check(self) {
        let entries = self.ptr.last().map_or(0, |&e| e as usize);
        assert_eq!(entries, self.row.len());
        assert!(self.ptr.windows(2).all(|w| w[0] <= w[1]) && self.ptr[0] == 0);
        assert!(self
            .row
            .iter()
            .all(|&i| (0..self.n()).contains(&(i as usize))));
    }
}

/// The analysis of a pattern, or a factor: both are the same object to CHOLMOD.
#[derive(Debug)]
struct Handle {
    raw: *mut sys::ff_cholmod,
    n: usize,
}

// SAFETY: the object is memory that no thread owns; CHOLMOD has no variables of the process apart from the pointers to malloc, every call
// makes a workspace of its own, and those that reach BLAS ask whether it takes several threads.
unsafe impl Send for Handle {}
// SAFETY: shared calls only read the object.
unsafe impl Sync for Handle {}

impl Drop for Handle {
    fn drop(&mut self) {
        // SAFETY: we own the object, and this is its end.
        unsafe { sys::ff_cholmod_free(self.raw) }
    }
}

/// The elimination of a pattern in its own order.
#[derive(Debug)]
pub struct CholmodSymbolic(Handle);

impl CholmodSymbolic {
    /// Analyses the pattern; `supernodal` insists on supernodes, else CHOLMOD decides by the number of operations.
    ///
    /// # Errors
    /// [`Refusal::Failed`].
    pub fn new(pattern: Upper, supernodal: bool) -> Result<CholmodSymbolic, Refusal> {
        pattern.check();
        let (mut raw, mut why) = (null_mut(), 0);
        // SAFETY: the arrays were checked and live until the call returns; the out-pointers are locals.
        let code = unsafe {
            sys::ff_cholmod_analyse(
                pattern.n() as c_int,
                pattern.ptr.as_ptr(),
                pattern.row.as_ptr(),
                supernodal.into(),
                &mut raw,
                &mut why,
            )
        };
        match code {
            0 => Ok(CholmodSymbolic(Handle {
                raw,
                n: pattern.n(),
            })),
            code => Err(refusal(NAME, "analysis", code, -1, why)),
        }
    }

    /// L of the matrix with these values, on the pattern that was analysed.
    ///
    /// # Errors
    /// A pivot that is not positive, or the library's own.
    pub fn factor(&self, pattern: Upper, values: &[f64]) -> Result<Cholmod, Refusal> {
        pattern.check();
        assert_eq!((pattern.n(), pattern.row.len()), (self.0.n, values.len()));
        let (mut raw, mut column, mut why) = (null_mut(), -1, 0);
        let _alone = blas();
        // SAFETY: as above, and `values` is as long as the pattern says.
        let code = unsafe {
            sys::ff_cholmod_factor(
                self.0.raw,
                pattern.ptr.as_ptr(),
                pattern.row.as_ptr(),
                values.as_ptr(),
                &mut raw,
                &mut column,
                &mut why,
            )
        };
        match code {
            0 => Ok(Cholmod(Handle { raw, n: self.0.n })),
            code => Err(refusal(NAME, "factorisation", code, column, why)),
        }
    }
}

/// L with A = L Lᵀ.
#[derive(Debug)]
pub struct Cholmod(Handle);

/// Some columns of L with the same rows.
#[derive(Debug, Clone, Copy)]
pub struct Supernode<'a> {
    /// Its first column.
    pub start: usize,
    /// Number of columns.
    pub width: usize,
    /// Rows, increasing; the first ones are the columns themselves.
    pub rows: &'a [i32],
    /// Entries by columns of `rows.len()`; those above the diagonal mean nothing.
    pub values: &'a [f64],
}

impl Cholmod {
    /// x ← A⁻¹ x for vectors that lie one after the other.
    ///
    /// # Panics
    /// If there is no memory for a copy of them.
    pub fn solve(&self, x: &mut [f64]) {
        if self.0.n == 0 {
            return;
        }
        assert_eq!(x.len() % self.0.n, 0);
        let mut why = 0;
        let _alone = blas();
        // SAFETY: `x` holds that many vectors of length n.
        let code = unsafe {
            let columns = (x.len() / self.0.n) as c_int;
            sys::ff_cholmod_solve(self.0.raw, columns, x.as_mut_ptr(), &mut why)
        };
        assert!(code == 0, "{}", complaint(NAME, "solution", code, why));
    }

    /// The diagonal of L.
    pub fn diagonal(&self) -> Vec<f64> {
        let mut out = vec![0.0; self.0.n];
        // SAFETY: n entries are written.
        unsafe { sys::ff_cholmod_diagonal(self.0.raw, out.as_mut_ptr()) }
        out
    }

    /// The supernodes of L in order; nothing where L was made without.
    pub fn supernodes(&self) -> Vec<Supernode<'_>> {
        let mut n = 0;
        let mut at = [std::ptr::null::<c_int>(); 4];
        let mut x = std::ptr::null();
        let [columns, first_row, first_value, rows] = &mut at;
        // SAFETY: the out-pointers are locals.
        let code = unsafe {
            sys::ff_cholmod_supernodes(
                self.0.raw,
                &mut n,
                columns,
                first_row,
                first_value,
                rows,
                &mut x,
            )
        };
        if code != 0 {
            return Vec::new();
        }
        let [columns, first_row, first_value, rows] = at;
        let lent = |s: usize| {
            // SAFETY: the first three arrays have n + 1 entries, and what they say about the other two is CHOLMOD's own invariant. All live
            // as long as the factor, which `self` borrows.
            unsafe {
                let start = *columns.add(s) as usize;
                let width = *columns.add(s + 1) as usize - start;
                let (from, to) = (*first_row.add(s) as usize, *first_row.add(s + 1) as usize);
                let rows = std::slice::from_raw_parts(rows.add(from), to - from);
                let values = x.add(*first_value.add(s) as usize);
                Supernode {
                    start,
                    width,
                    rows,
                    values: std::slice::from_raw_parts(values, width * rows.len()),
                }
            }
        };
        (0..n as usize).map(lent).collect()
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        // SAFETY: the object is alive.
        unsafe { sys::ff_cholmod_bytes(self.0.raw) as usize }
    }
}
