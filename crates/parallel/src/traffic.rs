//! Counters of the messages and all-reduces that this rank sends.
//!
//! A halo computes its messages from the ghost list and the ownership ranges. The counts equal those of PETSc's own
//! counters (`-log_view`), but do not need a build of PETSc with logging.

use std::cell::Cell;
use std::ops::{AddAssign, Sub};

/// Bytes of a double.
const NUMBER: u64 = 8;

/// The messages and bytes that one rank has sent.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Messages to single ranks.
    pub messages: u64,
    /// Their bytes.
    pub bytes: u64,
    /// All-reduces that this rank took part in.
    pub reductions: u64,
    /// Bytes that this rank contributed to them.
    pub reduced_bytes: u64,
}

impl Traffic {
    /// An all-reduce of `n` numbers.
    pub fn reduction(n: usize) -> Traffic {
        Traffic {
            reductions: 1,
            reduced_bytes: NUMBER * n as u64,
            ..Traffic::default()
        }
    }

    /// A message of `n` numbers.
    pub fn message(n: usize) -> Traffic {
        Traffic::of_counts([n as u64].into_iter())
    }

    /// One message for every count above zero.
    pub(super) fn of_counts(counts: impl Iterator<Item = u64>) -> Traffic {
        counts
            .filter(|&n| n > 0)
            .fold(Traffic::default(), |t, n| Traffic {
                messages: t.messages + 1,
                bytes: t.bytes + NUMBER * n,
                ..t
            })
    }
}

impl AddAssign for Traffic {
    fn add_assign(&mut self, more: Traffic) {
        self.messages += more.messages;
        self.bytes += more.bytes;
        self.reductions += more.reductions;
        self.reduced_bytes += more.reduced_bytes;
    }
}

impl Sub for Traffic {
    type Output = Traffic;
    fn sub(self, before: Traffic) -> Traffic {
        Traffic {
            messages: self.messages - before.messages,
            bytes: self.bytes - before.bytes,
            reductions: self.reductions - before.reductions,
            reduced_bytes: self.reduced_bytes - before.reduced_bytes,
        }
    }
}

thread_local! {
    /// The counter of this thread: only the thread that runs PETSc sends.
    static SENT: Cell<Traffic> = const {
        Cell::new(Traffic { messages: 0, bytes: 0, reductions: 0, reduced_bytes: 0 })
    };
}

/// The traffic of this rank since it started; take differences.
pub fn sent() -> Traffic {
    SENT.get()
}

/// Adds to the counter.
pub fn count(more: Traffic) {
    let mut all = SENT.get();
    all += more;
    SENT.set(all);
}

#[cfg(test)]
#[path = "../tests/traffic.rs"]
mod tests;
