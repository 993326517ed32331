//! What the wrappers of the direct solvers return, in Rust.

use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use petsc_sys as sys;

/// One caller at a time, for all instances of all libraries that take this lock.
static ALONE: Mutex<()> = Mutex::new(());

pub(super) fn alone() -> MutexGuard<'static, ()> {
    // What a panic elsewhere left behind does not matter: the lock guards no data of ours.
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Held around calls that reach BLAS: the sequential OpenBLAS hands the same buffer to two callers at once, and both get wrong results.
pub(super) fn blas() -> Option<MutexGuard<'static, ()>> {
    static TAKES_THREADS: OnceLock<bool> = OnceLock::new();
    // SAFETY: takes nothing, asks a constant of the library.
    let takes = TAKES_THREADS.get_or_init(|| unsafe { sys::ff_blas_takes_threads() != 0 });
    (!takes).then(alone)
}

/// Why there is no factor.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Refusal {
    /// A pivot is not positive, or too small; its column, where the library says which.
    NotPositive(Option<usize>),
    /// The library failed for another reason: one sentence without a full stop.
    Failed(String),
}

/// From the code of a wrapper, the column it named and the library's own number.
pub(super) fn refusal(library: &str, doing: &str, code: i32, column: i32, why: i32) -> Refusal {
    if code == sys::FF_NOT_POSITIVE as i32 {
        return Refusal::NotPositive(usize::try_from(column).ok());
    }
    Refusal::Failed(complaint(library, doing, code, why))
}

/// One sentence about a code that is not about pivots.
pub(super) fn complaint(library: &str, doing: &str, code: i32, why: i32) -> String {
    match code {
        sys::FF_ABSENT => format!("this build has no {library}"),
        c if c == sys::FF_NO_MEMORY as i32 => {
            format!("{library} has not enough memory for the {doing} (its code {why})")
        }
        _ => format!("{library} failed at the {doing} (its code {why})"),
    }
}
