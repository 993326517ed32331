//! The cost of a rank's work by phase, and the cost of messages.
//!
//! The seconds of a phase are a sum of a few terms, fitted to the runs on one rank, where nothing is sent and nobody
//! waits. Messages are added by the α–β model: their number and bytes are counted; α and β are measured separately.
//! Runs on several ranks test the model, they do not enter the fit.
//!
//! An iteration reads its operators from the cache as long as they fit there, and otherwise from memory, which is many
//! times slower. Every term of an iteration therefore occurs twice: as it is, and times the part of the data that does
//! not fit in the cache. The cache size is the one that gives the best fit.

use serde::{Deserialize, Serialize};

use super::fit::Law;
use super::network::Network;
use super::{IterationSeconds, ScalingPoint, SetupSeconds, Work};
use fetifeti::inside::FEW;

/// Projections in an iteration: P and Pᵀ around F and around M⁻¹, each with an all-reduce of r numbers; or of many
/// motions Pᵀ after F and P after M⁻¹, each with messages up and down the tree.
fn projections(r: f64) -> f64 {
    if r > FEW as f64 {
        2.0
    } else {
        4.0 * any(r)
    }
}

/// Entries in a row of Gᵀ G: a body of a plane grid and its eight neighbours, scalar.
const NEAR: f64 = 9.0;

/// A phase: its terms as functions of a rank's work, and the measured seconds.
struct CostPhase {
    /// The name; the phases of an iteration are [`ITERATED`].
    name: &'static str,
    terms: &'static [&'static str],
    values: fn(&Work) -> Vec<f64>,
    seconds: fn(&ScalingPoint) -> f64,
}

/// 1 if x is positive, else 0.
fn any(x: f64) -> f64 {
    f64::from(u8::from(x > 0.0))
}

/// The phase of the factor of GᵀQG in the set-up.
const FACTOR: usize = 4;

/// The phase of its order.
const ORDER: usize = 5;

/// Numbers that fronts leave to each other on the way to the root, for each rigid motion: about two lines of a square
/// for each line, and a quarter of that every second time.
const LEFT: f64 = 2.0;

/// The phases that read the same operators again and again.
const ITERATED: std::ops::Range<usize> = 7..12;

/// Number of cache sizes that are tried: powers of √2 times 128 kB.
const CACHES: usize = 20;

const PHASES: [CostPhase; 13] = [
    CostPhase {
        name: "set-up, subdomains",
        terms: &["subdomains", "unknowns", "interface^3"],
        values: |w| vec![w.subdomains, w.unknowns, w.interface_cubes],
        seconds: |p| p.setup.local,
    },
    CostPhase {
        name: "set-up, S_Π",
        terms: &["1", "primal", "primal log primal"],
        values: |w| vec![any(w.primal), w.primal, w.primal_factor],
        seconds: |p| p.setup.primal,
    },
    CostPhase {
        name: "set-up, Z_c",
        terms: &["interface^2 columns", "columns^2", "columns^3"],
        values: |w| vec![w.lifting_products, w.lifting_squares, w.lifting_cubes],
        seconds: |p| p.setup.lifting,
    },
    CostPhase {
        name: "set-up, GᵀQG",
        terms: &["multipliers", "1"],
        values: |w| vec![any(w.kernels) * w.multipliers, any(w.kernels)],
        seconds: |p| p.setup.natural,
    },
    CostPhase {
        name: "set-up, factor of GᵀQG",
        terms: &["r", "r^1.5"],
        values: |w| vec![w.kernels, w.kernels.powf(1.5)],
        seconds: |p| p.setup.factor,
    },
    CostPhase {
        name: "set-up, order of GᵀQG",
        terms: &["r", "r log r"],
        values: |w| vec![w.kernels, w.kernels * (w.kernels + 1.0).log2()],
        seconds: |p| p.setup.order,
    },
    CostPhase {
        name: "set-up, rest",
        terms: &["subdomains", "unknowns", "multipliers"],
        values: |w| vec![w.subdomains, w.unknowns, w.multipliers],
        seconds: |p| p.setup.rest,
    },
    CostPhase {
        name: "iteration, subdomains",
        terms: &["subdomains", "interface^2", "multipliers"],
        values: |w| vec![w.subdomains, w.interface_squares, w.multipliers],
        seconds: |p| p.iteration.local,
    },
    CostPhase {
        name: "iteration, S_Π",
        terms: &["1", "primal", "primal log primal"],
        values: |w| vec![any(w.primal), w.primal, w.primal_factor],
        seconds: |p| p.iteration.primal,
    },
    CostPhase {
        name: "iteration, Z_c",
        terms: &["columns", "columns^2"],
        values: |w| vec![w.lifting, w.lifting_squares],
        seconds: |p| p.iteration.lifting,
    },
    CostPhase {
        name: "iteration, GᵀQG",
        terms: &["1", "r", "r log r"],
        values: |w| {
            let r = w.kernels;
            vec![any(r), r, r * (r + 1.0).log2()]
        },
        seconds: |p| p.iteration.natural,
    },
    CostPhase {
        name: "iteration, copies for messages",
        terms: &["1", "ghosts"],
        values: |w| vec![1.0, w.ghosts],
        seconds: |p| p.iteration.exchange,
    },
    CostPhase {
        name: "solve, outside the iterations",
        terms: &["subdomains", "unknowns", "interface^2"],
        values: |w| vec![w.subdomains, w.unknowns, w.interface_squares],
        seconds: |p| p.outside,
    },
];

/// The data that a rank sends in an iteration.
pub struct SentData {
    messages: f64,
    bytes: f64,
    /// All-reduces of one number: the inner products of CG.
    dots: f64,
}

impl SentData {
    /// The data that the rank with the largest amount sends in a run.
    pub fn of(point: &ScalingPoint) -> SentData {
        let counted = &point.communication;
        let projections = projections(point.work.kernels);
        SentData {
            messages: counted.messages.max,
            bytes: counted.bytes.max,
            dots: (counted.reductions - projections).max(0.0),
        }
    }
}

/// The fitted costs of all phases.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct CostModel {
    /// By phase.
    pub laws: Vec<Law>,
    /// Bytes of operators that a rank keeps in its cache.
    pub cache: f64,
}

/// Bytes of the sparse factors of Gᵀ Q G over r log r, for nested dissection of a plane grid of bodies, with 12 bytes
/// per entry.
const FILL: f64 = 93.0;

/// Bytes that every rank has for each rigid motion while the order is found, whoever factors it: its place, the
/// structure of the fronts, and who has what.
const KNOWN: f64 = 200.0;

/// Bytes of pattern and entries of Gᵀ G for each rigid motion in a rank's rows of the factor and of G.
const ENTRIES: f64 = 3.0 * 12.0 * NEAR;

/// The part of the operations of the factor on the way from a single body to the root.
const WAY: f64 = 0.2;

/// How ranks share the factor of Gᵀ Q G of a plane grid of bodies (`cholesky::deal`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FactorShares {
    /// Messages, one after the other, from a subtree to the root; none if every rank has the whole factor.
    pub messages: f64,
    /// Number of rows between subtrees on the way to the root.
    pub way: f64,
    /// Number of rows that are eliminated one after the other: those of the subtree of a rank, and the way.
    pub rows: f64,
    /// The part of the operations that are done one after the other.
    pub work: f64,
}

impl FactorShares {
    /// Of r rigid motions among `ranks` ranks: squares of bodies, one for each rank, and the lines between them.
    pub fn new(r: f64, ranks: f64) -> FactorShares {
        if r <= FEW as f64 || ranks <= 1.0 {
            return FactorShares {
                messages: 0.0,
                way: 0.0,
                rows: r,
                work: 1.0,
            };
        }
        // A line through the square, two halves of one, two quarters …
        let way = (3.0 * (1.0 - ranks.sqrt().recip()) * r.sqrt()).min(r);
        FactorShares {
            messages: ranks.log2(),
            way,
            rows: way + (r - way) / ranks,
            work: WAY + (1.0 - WAY) / ranks,
        }
    }
}

/// Bytes of Gᵀ G and its factor on a rank.
pub fn replicated(r: f64, ranks: f64) -> f64 {
    let rows = FactorShares::new(r, ranks).rows;
    KNOWN * r + ENTRIES * rows + FILL * rows * (r + 1.0).log2()
}

/// The part of the data read by a rank in an iteration that does not fit in a cache of this size.
fn beyond(cache: f64, work: &Work) -> f64 {
    let r = work.kernels;
    let dense = 8.0 * (work.interface_squares + work.lifting_squares);
    let bytes = dense + FILL * r * (r + 1.0).log2();
    if bytes > cache {
        1.0 - cache / bytes
    } else {
        0.0
    }
}

/// The terms of phase `k`.
fn terms(k: usize, cache: f64, work: &Work) -> Vec<f64> {
    let mut values = (PHASES[k].values)(work);
    if ITERATED.contains(&k) {
        let part = beyond(cache, work);
        let slow: Vec<f64> = values.iter().map(|x| part * x).collect();
        values.extend(slow);
    }
    values
}

/// The model's seconds of a run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Modelled {
    /// Seconds of set-up.
    pub setup: SetupSeconds,
    /// Seconds of an iteration.
    pub iteration: IterationSeconds,
    /// Seconds of a solve besides its iterations.
    pub outside: f64,
}

impl Modelled {
    /// Seconds of set-up and of a solve with this many iterations.
    pub fn total(&self, iterations: f64) -> f64 {
        self.setup.sum() + iterations * self.iteration.sum() + self.outside
    }
}

impl CostModel {
    /// Fits all phases to the points on one rank.
    pub fn fit(points: &[ScalingPoint]) -> CostModel {
        let fit = |k: usize, cache: f64| {
            let phase = &PHASES[k];
            let one = points.iter().filter(|p| p.fitted);
            let samples: Vec<(Vec<f64>, f64)> = one
                .map(|p| (terms(k, cache, &p.work), (phase.seconds)(p)))
                .collect();
            let mut names: Vec<String> = phase.terms.iter().map(|t| t.to_string()).collect();
            if ITERATED.contains(&k) {
                names.extend(phase.terms.iter().map(|t| format!("{t} beyond")));
            }
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            Law::fit(phase.name, &names, &samples)
        };
        let caches = (0..CACHES).map(|k| 131_072.0 * 2.0_f64.powf(0.5 * k as f64));
        let misfit = |cache: &f64| ITERATED.map(|k| fit(k, *cache).misfit).sum::<f64>();
        let best = caches.min_by(|a, b| misfit(a).total_cmp(&misfit(b)));
        let cache = best.expect("there are sizes to try");
        CostModel {
            laws: (0..PHASES.len()).map(|k| fit(k, cache)).collect(),
            cache,
        }
    }

    /// The seconds of `work` on each of `ranks` ranks, with the messages of an iteration.
    pub fn seconds(&self, work: &Work, ranks: f64, sent: &SentData, network: &Network) -> Modelled {
        let at = |k: usize| self.laws[k].at(&terms(k, self.cache, work));
        let r = work.kernels;
        let sum = |n: f64| any(n) * network.all_reduce(ranks, 8.0 * n);
        let shares = FactorShares::new(r, ranks);
        let shared = any(shares.messages);
        let mut setup = SetupSeconds::from_fn(at);
        // Of the factor what is done one after the other.
        let one_after_other = [shares.rows, r.powf(1.5) * shares.work];
        setup.factor = self.laws[FACTOR].at(&one_after_other);
        // The largest entries of columns and stiffnesses of bodies; the product or, where ranks share the factor, what
        // subtrees leave to the rows above.
        setup.natural += 3.0 * sum(r);
        setup.factor += match shared {
            0.0 => sum(NEAR * r),
            _ => network.messages(shares.messages, 8.0 * LEFT * r),
        };
        // A rank makes the cuts of twice all bodies and of its own. All hear of all neighbours and of the order.
        let cuts = (r + 1.0).log2().min(2.0 + (r / ranks + 1.0).log2());
        setup.order = self.laws[ORDER].at(&[r, r * cuts]);
        setup.order += any(r)
            * any(ranks - 1.0)
            * network.messages(2.0 * ranks.log2(), 8.0 * (NEAR + 1.0) * r);
        // A projection sums all columns, or goes up the tree and down again.
        let summed = if shared > 0.0 { 0.0 } else { r };
        let (projections, way) = (projections(r), 16.0 * shares.way);
        let answered = 2.0 * projections * network.messages(shares.messages, way);
        // A rank has the columns of its own part, of the factor and in its cache.
        let solved = Work {
            kernels: shares.rows,
            ..*work
        };
        let iterated = |k: usize| self.laws[k].at(&terms(k, self.cache, &solved));
        let [local, primal, lifting, natural, copies] =
            std::array::from_fn(|k| iterated(ITERATED.start + k));
        let iteration = IterationSeconds {
            local,
            primal,
            lifting,
            natural,
            exchange: copies + network.messages(sent.messages, sent.bytes) + answered,
            reduction: sent.dots * network.all_reduce(ranks, 8.0) + projections * sum(summed),
        };
        Modelled {
            setup,
            iteration,
            outside: at(ITERATED.end),
        }
    }
}

#[cfg(test)]
#[path = "../../../tests/study/scaling/model.rs"]
mod tests;
