//! Seconds and memory of a piece of work, over all ranks.

use std::time::Instant;

use super::exchange::{highest, total};
use base::Result;
use petsc::{max_memory, Session};

/// Wall-clock seconds of some work, from the first rank's begin to the last rank's end. Collective.
pub fn timed<T>(session: &Session, work: impl FnOnce() -> Result<T>) -> Result<(T, f64)> {
    session.agree(Ok(()))?;
    let clock = Instant::now();
    let result = work()?;
    let seconds = clock.elapsed().as_secs_f64();
    Ok((result, highest(session.comm(), seconds)))
}

/// Largest resident memory of all ranks, in bytes. It excludes the shared segments through which ranks of one machine
/// exchange messages: these belong to MPI, and would be counted in every rank that has mapped them.
pub fn memory(session: &Session) -> f64 {
    total(session.comm(), max_memory() - shared_memory())
}

/// Resident memory that this process shares with others, in bytes; zero if the system does not report it.
fn shared_memory() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("RssShmem:"));
    let kilobytes = line.and_then(|l| l.trim().trim_end_matches("kB").trim().parse().ok());
    1024.0 * kilobytes.unwrap_or(0.0)
}
