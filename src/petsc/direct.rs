//! What the wrappers of the direct solvers return, in Rust.

use petsc_sys as sys;

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
