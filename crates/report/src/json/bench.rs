//! The record of `bench`.

use super::compare::{ComparedScene, MethodRun, PhaseSeconds};
use serde::{Deserialize, Serialize};

/// The report of `bench`: one document for all cases.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BenchReport {
    /// Name and version of this record: [`BenchReport::SCHEMA`].
    pub schema: String,
    /// Version of fetifeti.
    pub version: String,
    /// The file of the BLAS that all methods use; `null` where the system does not know it.
    pub blas: Option<String>,
    /// Number of cores given to methods without a layout of their own.
    pub cores: usize,
    /// Number of rounds that were asked for.
    pub rounds: usize,
    /// Whether the named cases are the small ones.
    pub quick: bool,
    /// The cases so far; if the run was interrupted, the last case may lack some of its rounds.
    pub cases: Vec<BenchCase>,
}

impl BenchReport {
    /// The value of `schema`.
    pub const SCHEMA: &'static str = "fetifeti.bench/1";
}

/// One scene.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct BenchCase {
    /// Its name; the stem of the file for a scene of the user.
    pub case: String,
    /// The scene and its direct solution.
    #[serde(flatten)]
    pub facts: ComparedScene,
    /// Number of finished rounds.
    pub rounds: usize,
    /// The methods, in the order in which every round runs them.
    pub methods: Vec<BenchRow>,
}

/// One method in one layout.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct BenchRow {
    /// The method and its result.
    #[serde(flatten)]
    pub run: MethodRun,
    /// Wall-clock time over the rounds that converged.
    pub seconds: BenchSeconds,
    /// The median total over that of the fastest variant of ours.
    pub ratio: Option<f64>,
    /// Largest resident memory over the ranks, summed, in MB of 10⁶ bytes.
    pub memory_mb: Option<Spread>,
    /// The part of `memory_mb` that was used before the problem was read: program and libraries, once per rank.
    pub memory_at_start_mb: Option<Spread>,
    /// All runs.
    pub samples: Vec<BenchSample>,
}

/// Wall-clock seconds of one method over the rounds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct BenchSeconds {
    /// The phases.
    #[serde(flatten)]
    pub phases: PhaseSeconds<Spread>,
    /// The part of `solve` for the recovery of displacements from multipliers.
    pub recover: Option<Spread>,
    /// A solve for another load with the set-up of the first; in contact scenes the whole loop, including the set-up
    /// for its active sets.
    pub again: Option<Spread>,
    /// In contact loops: the total over the number of active sets.
    pub step: Option<Spread>,
}

/// One run of one method.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct BenchSample {
    /// Number of the round, from 1.
    pub round: usize,
    /// The position of this run among all runs of the case, from 1.
    pub sequence: usize,
    /// Seconds of the phases.
    #[serde(flatten)]
    pub seconds: PhaseSeconds<f64>,
    /// Seconds of the recovery.
    pub recover: Option<f64>,
    /// Seconds of the second solve.
    pub again: Option<f64>,
    /// Number of active sets that were solved for.
    pub outer: Option<usize>,
    /// Iterations.
    pub iterations: Option<usize>,
    /// Resident memory, MB.
    pub memory_mb: Option<f64>,
    /// Resident memory before the problem was read, MB.
    pub memory_at_start_mb: Option<f64>,
    /// Whether the residual was reached.
    pub converged: bool,
}

/// Median and range of some samples.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// The median; of an even number of samples, the mean of the two in the middle.
    pub median: f64,
    /// The smallest.
    pub min: f64,
    /// The largest.
    pub max: f64,
}

impl Spread {
    /// Median and range of these samples; `None` where there are none.
    pub fn of(samples: impl IntoIterator<Item = f64>) -> Option<Spread> {
        let mut all: Vec<f64> = samples.into_iter().collect();
        all.sort_by(f64::total_cmp);
        let (&min, &max) = (all.first()?, all.last()?);
        let (low, high) = (all[(all.len() - 1) / 2], all[all.len() / 2]);
        Some(Spread {
            median: 0.5 * (low + high),
            min,
            max,
        })
    }
}

impl BenchRow {
    /// Computes median and range of the samples.
    pub fn sum_up(&mut self) {
        let converged = || self.samples.iter().filter(|s| s.converged);
        let spread = |of: fn(&BenchSample) -> Option<f64>| Spread::of(converged().filter_map(of));
        let seconds = BenchSeconds {
            phases: PhaseSeconds {
                assemble: spread(|s| s.seconds.assemble),
                setup: spread(|s| s.seconds.setup),
                solve: spread(|s| s.seconds.solve),
                total: spread(|s| s.seconds.total),
            },
            recover: spread(|s| s.recover),
            again: spread(|s| s.again),
            step: spread(|s| Some(s.seconds.total? / s.outer.filter(|n| *n > 0)? as f64)),
        };
        let memory = [spread(|s| s.memory_mb), spread(|s| s.memory_at_start_mb)];
        self.seconds = seconds;
        [self.memory_mb, self.memory_at_start_mb] = memory;
    }

    /// The median total.
    pub fn total(&self) -> Option<f64> {
        self.seconds.phases.total.map(|t| t.median)
    }
}

impl BenchCase {
    /// Computes medians and ranges of every method, and their ratios to the fastest variant of ours.
    pub fn sum_up(&mut self) {
        self.methods.iter_mut().for_each(BenchRow::sum_up);
        let ours = self.fastest(true).and_then(BenchRow::total);
        for row in &mut self.methods {
            row.ratio = row.total().zip(ours).map(|(total, ours)| total / ours);
        }
    }

    /// The fastest variant of ours, or of the others. Only methods that solve the whole problem and always converged
    /// are compared, by the median total.
    pub fn fastest(&self, ours: bool) -> Option<&BenchRow> {
        let fit = |run: &MethodRun| run.is_ours() == ours && run.converged && !run.set_given();
        let rows = self.methods.iter().filter(|r| fit(&r.run));
        let timed = rows.filter_map(|r| Some((r, r.total()?)));
        timed.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(row, _)| row)
    }
}

#[cfg(test)]
#[path = "../../tests/json/bench.rs"]
mod tests;
