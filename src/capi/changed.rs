//! Changes that a host has made since the last set-up.

use parallel::exchange::max_all;
use petsc::Session;

/// Changes since the last set-up, by kind.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Changed {
    /// Anything that is not among the following.
    pub whole: bool,
    /// Entries of matrices.
    pub matrices: bool,
    /// Rows.
    pub rows: bool,
    /// Right-hand sides of rows.
    pub gaps: bool,
}

impl Changed {
    /// The changes on any rank. Collective.
    pub fn anywhere(self, session: &Session) -> Changed {
        let mut all =
            [self.whole, self.matrices, self.rows, self.gaps].map(|b| f64::from(u8::from(b)));
        max_all(session.comm(), &mut all);
        let [whole, matrices, rows, gaps] = all.map(|v| v > 0.0);
        Changed {
            whole,
            matrices,
            rows,
            gaps,
        }
    }
}
