//! What a piece of work costs all ranks together: seconds and memory.

use std::time::Instant;

use super::exchange::{max_all, sum_all};
use crate::petsc::{max_memory, Session};
use crate::Result;

/// Wall-clock seconds of some work, from when the first rank begins to when the last one ends. Collective.
pub(crate) fn timed<T>(session: &Session, work: impl FnOnce() -> Result<T>) -> Result<(T, f64)> {
    session.agree(Ok(()))?;
    let clock = Instant::now();
    let result = work()?;
    let mut seconds = [clock.elapsed().as_secs_f64()];
    max_all(session.comm(), &mut seconds);
    Ok((result, seconds[0]))
}

/// Largest resident memory of all ranks, in bytes, without the segments through which ranks of one machine pass messages: they show up in
/// every rank that has them mapped, and are MPI's.
pub(crate) fn memory(session: &Session) -> f64 {
    let mut bytes = [max_memory() - shared_memory()];
    sum_all(session.comm(), &mut bytes);
    bytes[0]
}

/// Resident memory that this process shares with others, in bytes; zero where the system does not tell.
fn shared_memory() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("RssShmem:"));
    let kilobytes = line.and_then(|l| l.trim().trim_end_matches("kB").trim().parse().ok());
    1024.0 * kilobytes.unwrap_or(0.0)
}
