//! Communication and time of the Krylov iterations of a solver, over all ranks.

use mpi::topology::SimpleCommunicator;
use parallel::clock::{self, Times};
use parallel::exchange::{max_all, sum_all};
use parallel::traffic::{self, Traffic};
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// The iterations of this rank, added up.
#[derive(Debug, Clone, Copy, Default)]
pub struct Tally {
    /// Krylov iterations.
    pub iterations: usize,
    /// Messages and reductions of the iterations.
    pub sent: Traffic,
    /// Their seconds, by phase.
    pub times: Times,
    /// Their seconds in total.
    pub seconds: f64,
}

/// Readings of clocks and counters at the start of an iteration.
pub struct ClockReadings {
    sent: Traffic,
    times: Times,
    clock: Instant,
    petsc: Option<petsc::Counters>,
}

impl ClockReadings {
    /// Reads clocks and counters.
    pub fn now() -> ClockReadings {
        ClockReadings {
            sent: traffic::sent(),
            times: clock::spent(),
            petsc: petsc::counters(),
            clock: Instant::now(),
        }
    }

    /// The tally of the `iterations` iterations since then. PETSc counts the all-reduces of the Krylov method itself,
    /// one number each; a build of PETSc without its log does not count them.
    pub fn since(&self, iterations: usize) -> Tally {
        let seconds = self.clock.elapsed().as_secs_f64();
        let mut sent = traffic::sent() - self.sent;
        if let (Some(before), Some(now)) = (self.petsc, petsc::counters()) {
            let dots = (now.reductions - before.reductions) as u64;
            sent += Traffic {
                reductions: dots,
                reduced_bytes: 8 * dots,
                ..Traffic::default()
            };
        }
        Tally {
            iterations,
            sent,
            times: clock::spent().since(&self.times),
            seconds,
        }
    }
}

impl Tally {
    /// Adds more iterations.
    pub fn add(&mut self, more: &Tally) {
        self.iterations += more.iterations;
        self.sent += more.sent;
        self.times.add(&more.times);
        self.seconds += more.seconds;
    }
}

/// A quantity per iteration.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct PerIteration {
    /// Sum over all ranks.
    pub sum: f64,
    /// Largest value of a rank.
    pub max: f64,
}

/// Communication per Krylov iteration: means over the iterations. The beginning and the end of a run are included.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Communication {
    /// Messages from rank to rank.
    #[serde(rename = "messages_per_iteration")]
    pub messages: PerIteration,
    /// Bytes of the messages.
    #[serde(rename = "bytes_per_iteration")]
    pub bytes: PerIteration,
    /// All-reduces; every rank takes part in each.
    #[serde(rename = "reductions_per_iteration")]
    pub reductions: f64,
    /// Bytes that a rank contributes to the all-reduces.
    #[serde(rename = "reduced_bytes_per_iteration")]
    pub reduced_bytes: f64,
}

impl Communication {
    /// The communication of the iterations in `tally`, over all ranks; `None` if there were none. Collective.
    pub(crate) fn of(comm: &SimpleCommunicator, tally: &Tally) -> Option<Communication> {
        if tally.iterations == 0 {
            return None;
        }
        let n = tally.iterations as f64;
        let mine = [tally.sent.messages, tally.sent.bytes].map(|v| v as f64 / n);
        let reduced = [tally.sent.reductions, tally.sent.reduced_bytes].map(|v| v as f64 / n);
        let (mut sum, mut max) = (mine, mine);
        sum_all(comm, &mut sum);
        max_all(comm, &mut max);
        let both = |k: usize| PerIteration {
            sum: sum[k],
            max: max[k],
        };
        Some(Communication {
            messages: both(0),
            bytes: both(1),
            reductions: reduced[0],
            reduced_bytes: reduced[1],
        })
    }
}
