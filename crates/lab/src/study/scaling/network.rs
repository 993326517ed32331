//! Messages between ranks: measurements, and their model by seconds per message (α) and per byte (β).

use std::time::Instant;

use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, CommunicatorCollectives, Destination, Source};
use serde::{Deserialize, Serialize};

use super::fit::Law;
use parallel::exchange::sum_all;

/// Lengths of the measured messages, in numbers.
const LENGTHS: [usize; 8] = [1, 8, 64, 512, 2048, 8192, 32_768, 131_072];

/// Duration of one measurement. It is repeated [`ROUNDS`] times, and the fastest counts.
const SECONDS: f64 = 2e-3;
const ROUNDS: usize = 12;

/// A network on which a message costs α plus β per byte; the sums of an all-reduce cost γ per byte in addition.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Network {
    /// Seconds per message.
    pub alpha: f64,
    /// Seconds per byte.
    pub beta: f64,
    /// Seconds per byte of an all-reduce for sums and copies, a property of the core.
    pub gamma: f64,
}

impl Network {
    /// Seconds of messages one after the other.
    pub fn messages(&self, messages: f64, bytes: f64) -> f64 {
        self.alpha * messages + self.beta * bytes
    }

    /// Seconds of an all-reduce of `bytes` among `ranks`: recursive doubling for short ones, a reduce-scatter and an
    /// all-gather for long ones.
    pub fn all_reduce(&self, ranks: f64, bytes: f64) -> f64 {
        if ranks <= 1.0 {
            return 0.0;
        }
        let steps = ranks.log2().ceil();
        let added = self.gamma * bytes;
        let short = steps * (self.messages(1.0, bytes) + added);
        let long = self.messages(2.0 * steps, 2.0 * bytes * (ranks - 1.0) / ranks) + added;
        short.min(long)
    }
}

/// Seconds of one operation.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// Number of ranks that take part.
    pub ranks: usize,
    /// Bytes per rank.
    pub bytes: usize,
    /// Seconds.
    pub seconds: f64,
}

/// The measurements on this machine, and the network fitted to them.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct MeasuredNetwork {
    /// Messages one way between two ranks.
    pub messages: Vec<Timing>,
    /// All-reduces.
    pub reductions: Vec<Timing>,
    /// Seconds of these all-reduces by the fitted network.
    pub modelled_reductions: Vec<f64>,
    /// α and β, fitted to `messages`, and γ, to `reductions` on two ranks.
    pub network: Network,
    /// Median of |fitted − measured| / measured of the messages.
    pub median_deviation: f64,
    /// Largest of these deviations.
    pub largest_deviation: f64,
}

impl MeasuredNetwork {
    /// Fits α, β and γ.
    pub fn new(messages: Vec<Timing>, reductions: Vec<Timing>) -> MeasuredNetwork {
        let fit = |timings: &mut dyn Iterator<Item = &Timing>| {
            let samples: Vec<(Vec<f64>, f64)> = timings
                .map(|t| (vec![1.0, t.bytes as f64], t.seconds))
                .collect();
            Law::fit("message", &["messages", "bytes"], &samples)
        };
        let law = fit(&mut messages.iter());
        let reduced = fit(&mut reductions.iter().filter(|t| t.ranks == 2));
        let network = Network {
            alpha: law.seconds[0],
            beta: law.seconds[1],
            gamma: (reduced.seconds[1] - law.seconds[1]).max(0.0),
        };
        let modelled = |t: &Timing| network.all_reduce(t.ranks as f64, t.bytes as f64);
        MeasuredNetwork {
            modelled_reductions: reductions.iter().map(modelled).collect(),
            messages,
            reductions,
            network,
            median_deviation: law.median_deviation,
            largest_deviation: law.largest_deviation,
        }
    }
}

/// Messages (on two ranks) and all-reduces of all lengths; every rank knows the result. Collective.
pub fn measure(comm: &SimpleCommunicator) -> (Vec<Timing>, Vec<Timing>) {
    let ranks = comm.size() as usize;
    let timing = |n: usize, seconds| Timing {
        ranks,
        bytes: 8 * n,
        seconds,
    };
    let messages = match ranks {
        2 => LENGTHS
            .iter()
            .map(|&n| timing(n, 0.5 * fastest(comm, |buffer| ping_pong(comm, buffer), n)))
            .collect(),
        _ => Vec::new(),
    };
    let mut target = vec![0.0; LENGTHS[LENGTHS.len() - 1]];
    let reductions = LENGTHS.iter().map(|&n| {
        let mut reduce = |buffer: &mut [f64]| {
            let into = &mut target[..buffer.len()];
            comm.all_reduce_into(&*buffer, into, mpi::collective::SystemOperation::sum());
        };
        timing(n, fastest(comm, &mut reduce, n))
    });
    (messages, reductions.collect())
}

fn ping_pong(comm: &SimpleCommunicator, buffer: &mut [f64]) {
    let other = comm.process_at_rank(1 - comm.rank());
    if comm.rank() == 0 {
        other.send(&*buffer);
        other.receive_into(buffer);
    } else {
        other.receive_into(buffer);
        other.send(&*buffer);
    }
}

/// Seconds of `work` on `n` numbers: the smallest mean of several rounds, averaged over the ranks.
fn fastest(comm: &SimpleCommunicator, mut work: impl FnMut(&mut [f64]), n: usize) -> f64 {
    let mut buffer = vec![1.0; n];
    let mut run = |times: usize| {
        comm.barrier();
        let clock = Instant::now();
        (0..times).for_each(|_| work(&mut buffer));
        let mut seconds = [clock.elapsed().as_secs_f64() / times as f64];
        sum_all(comm, &mut seconds);
        seconds[0] / f64::from(comm.size())
    };
    run(3);
    let times = ((SECONDS / run(3)) as usize).clamp(3, 2000);
    (0..ROUNDS)
        .map(|_| run(times))
        .fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
#[path = "../../../tests/study/scaling/network.rs"]
mod tests;
