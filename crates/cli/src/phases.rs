//! The phases of `solve` outside the iterations: shown on a terminal while they run, and counted.

use std::time::Instant;

use petsc::Session;
use report::progress::ProgressLine;

/// The clock of a run.
pub(super) struct Phases {
    clock: Instant,
    /// When the phase that runs began.
    begun: f64,
    shown: ProgressLine,
}

impl Phases {
    /// Starts the clock. Phases are shown on rank 0, unless `quiet`.
    pub fn new(session: &Session, quiet: bool) -> Phases {
        Phases {
            clock: Instant::now(),
            begun: 0.0,
            shown: ProgressLine::new(session.rank() == 0 && !quiet),
        }
    }

    /// Begins a phase.
    pub fn begin(&mut self, what: &str) {
        self.begun = self.total();
        self.shown.phase(what);
    }

    /// Ends the phase that runs; its seconds.
    pub fn end(&mut self) -> f64 {
        self.shown.finish();
        self.total() - self.begun
    }

    /// Seconds since the start.
    pub fn total(&self) -> f64 {
        self.clock.elapsed().as_secs_f64()
    }
}
