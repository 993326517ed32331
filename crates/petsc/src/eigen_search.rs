//! The course of a long search for eigenvalues.

use std::time::Duration;

/// How far a search is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EigenSearch {
    /// Whether it looks for the largest eigenvalue, and not for the smallest.
    pub largest: bool,
    /// Restarts so far.
    pub restarts: usize,
    /// The residual, relative to the eigenvalue.
    pub residual: f64,
    /// Where it may end.
    pub tolerance: f64,
    /// Since it began.
    pub elapsed: Duration,
}

/// Who is told of the course of searches, and with `None` of their end.
pub type Listener = Box<dyn Fn(Option<&EigenSearch>)>;
