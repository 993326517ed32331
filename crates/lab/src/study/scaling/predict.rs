//! Prediction of weak scaling far beyond this machine: a body on every rank.

use serde::{Deserialize, Serialize};

use super::model::{replicated, CostModel, Modelled, SentData};
use super::network::Network;
use super::{IterationSeconds, ScalingPoint, SetupSeconds};

/// Numbers of ranks in the predictions.
pub const RANKS: [usize; 10] = [
    9, 16, 64, 256, 1024, 4096, 16_384, 65_536, 100_000, 1_000_000,
];

/// Memory of a rank in bytes. Where GᵀG and its factor need more, the tables say that they do not fit.
const ROOM: f64 = 4e9;

/// The problem with a body on each of `ranks` ranks.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct PredictedRow {
    /// Number of ranks, and of bodies.
    pub ranks: usize,
    /// Kernel vectors of all bodies.
    pub kernels: usize,
    /// Unknowns, copies counted.
    pub unknowns: f64,
    /// Bytes of GᵀG and of its part of the factor on a rank.
    pub replicated_bytes: f64,
    /// Seconds by phase.
    pub seconds: Modelled,
    /// Seconds of set-up and a solve.
    pub total: f64,
    /// Seconds of set-up and a solve without all that r costs: set-up and solves with Gᵀ Q G, and the all-reduces of r
    /// numbers.
    pub without_kernels: f64,
}

/// The phase that takes longest, from some number of ranks on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PhaseLimit {
    /// The number of ranks.
    pub from: usize,
    /// Its name.
    pub phase: String,
}

/// One network.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Prediction {
    /// Description of the network.
    pub network_name: String,
    /// Its α and β.
    pub network: Network,
    /// Predictions by number of ranks.
    pub rows: Vec<PredictedRow>,
    /// The phases that take longest in set-up and solve together.
    pub limits: Vec<PhaseLimit>,
    /// The phases that take longest in an iteration.
    pub iteration_limits: Vec<PhaseLimit>,
    /// Number of ranks from which on the time is twice that of the first row; `None`: beyond the last row.
    pub doubles_at: Option<usize>,
    /// Number of ranks from which on GᵀG and its factor need more than 4 GB on every rank; `None`: beyond the last row.
    pub full_at: Option<usize>,
}

/// The data that predictions are based on: the middle rank of 3 × 3, and the number of iterations.
pub struct PredictionBasis<'a> {
    /// The fitted costs.
    pub model: &'a CostModel,
    /// A run with a body on every rank, of which one has all its neighbours.
    pub middle: &'a ScalingPoint,
    /// Number of iterations in the run with the largest number of such bodies.
    pub iterations: usize,
}

/// Number of kernel vectors of `ranks` bodies in a square that is held all round: the inner bodies float.
fn kernels(ranks: f64) -> f64 {
    (ranks.sqrt() - 2.0).max(0.0).powi(2)
}

impl PredictionBasis<'_> {
    fn row(&self, ranks: f64, network: &Network) -> PredictedRow {
        let mut work = self.middle.work;
        work.kernels = kernels(ranks).round();
        let sent = &SentData::of(self.middle);
        let seconds = self.model.seconds(&work, ranks, sent, network);
        let mut free = work;
        free.kernels = 0.0;
        let free = self.model.seconds(&free, ranks, sent, network);
        let n = self.iterations as f64;
        PredictedRow {
            ranks: ranks as usize,
            kernels: work.kernels as usize,
            unknowns: ranks * work.unknowns,
            replicated_bytes: replicated(work.kernels, ranks),
            seconds,
            total: seconds.total(n),
            without_kernels: free.total(n),
        }
    }

    /// The phase that takes longest, of an iteration or of set-up and solve together.
    fn longest(&self, row: &PredictedRow, iteration: bool) -> String {
        let setup = SetupSeconds::NAMES.iter().zip(row.seconds.setup.all());
        let setup = setup.filter(|_| !iteration);
        let setup = setup.map(|(name, t)| (format!("set-up, {name}"), t));
        let n = self.iterations as f64;
        let rest = IterationSeconds::NAMES.iter();
        let rest = rest.zip(row.seconds.iteration.all());
        let rest = rest.map(|(name, t)| (format!("iterations, {name}"), n * t));
        let all = setup.chain(rest);
        all.max_by(|a, b| a.1.total_cmp(&b.1))
            .map_or(String::new(), |(name, _)| name)
    }

    /// The prediction for a network.
    pub fn predict(&self, network_name: &str, network: Network) -> Prediction {
        let rows: Vec<PredictedRow> = RANKS
            .iter()
            .map(|&ranks| self.row(ranks as f64, &network))
            .collect();
        let [first, last] = [RANKS[0] as f64, RANKS[RANKS.len() - 1] as f64];
        let steps = 400;
        let fine = (0..=steps).map(|k| {
            let ranks = first * (last / first).powf(f64::from(k) / f64::from(steps));
            self.row(ranks.round(), &network)
        });
        let fine: Vec<PredictedRow> = fine.collect();
        let limits = |iteration: bool| {
            let mut limits: Vec<PhaseLimit> = Vec::new();
            for row in &fine {
                let phase = self.longest(row, iteration);
                if limits.last().is_none_or(|l| l.phase != phase) {
                    limits.push(PhaseLimit {
                        from: row.ranks,
                        phase,
                    });
                }
            }
            limits
        };
        let from =
            |over: &dyn Fn(&PredictedRow) -> bool| fine.iter().find(|r| over(r)).map(|r| r.ranks);
        Prediction {
            doubles_at: from(&|r| r.total > 2.0 * fine[0].total),
            full_at: from(&|r| r.replicated_bytes > ROOM),
            network_name: network_name.into(),
            network,
            rows,
            limits: limits(false),
            iteration_limits: limits(true),
        }
    }
}
