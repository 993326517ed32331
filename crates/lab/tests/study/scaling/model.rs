//! Unit tests of `crates/lab/src/study/scaling/model.rs`.

use super::super::{ScalingProblem, ScalingSeries};
use super::*;
use base::linalg::csr::Csr;
use cholesky::deal::deal;
use cholesky::dissection::nested_dissection;
use cholesky::symbolic::Front;
use cholesky::symbolic::Symbolic;
use fetifeti::solution::{Communication, PerIteration};

/// Seconds per term of an iteration on the subdomains, as chosen for the tests.
const KNOWN: [f64; 6] = [4e-7, 3e-10, 2e-8, 0.0, 2e-9, 0.0];
const CACHE: f64 = 131_072.0 * 16.0;

/// A run of `n` bodies whose seconds follow these laws.
fn point(n: f64, subdomains: f64) -> ScalingPoint {
    let work = Work {
        subdomains: n * subdomains,
        unknowns: 81.0 * n * subdomains,
        interface_squares: (700.0 + 13.0 * subdomains) * n * subdomains,
        interface_cubes: 4e4 * n * subdomains,
        multipliers: 15.0 * n * subdomains.sqrt(),
        ghosts: 90.0 * n * subdomains,
        kernels: n - 1.0,
        ..Work::default()
    };
    let local = terms(7, CACHE, &work);
    let local = local.iter().zip(KNOWN).map(|(x, c)| c * x).sum();
    ScalingPoint {
        series: ScalingSeries::Bodies,
        problem: ScalingProblem::Tied,
        ranks: 1,
        oversubscribed: false,
        fitted: true,
        bodies: n as usize,
        floating_bodies: n as usize - 1,
        subdomains: (n * subdomains) as usize,
        elements: 8,
        multipliers: 0,
        iterations: 10,
        steps: 1,
        kappa: None,
        setup: SetupSeconds {
            factor: 5e-9 * work.kernels.powf(1.5),
            order: 1e-8 * work.kernels * n.log2(),
            ..SetupSeconds::default()
        },
        iteration: IterationSeconds {
            local,
            ..IterationSeconds::default()
        },
        outside: 0.0,
        total: [0.0; 2],
        memory_mb: [0.0; 2],
        work,
        communication: Communication {
            messages: PerIteration {
                sum: 20.0,
                max: 10.0,
            },
            bytes: PerIteration {
                sum: 2000.0,
                max: 1000.0,
            },
            reductions: 7.0,
            reduced_bytes: 56.0,
        },
        model: Modelled::default(),
        setup_deviation: 0.0,
        iteration_deviation: 0.0,
    }
}

fn points() -> Vec<ScalingPoint> {
    let bodies = [2.0, 8.0, 32.0, 128.0, 512.0];
    let all = bodies
        .iter()
        .flat_map(|&n| [1.0, 4.0, 16.0].map(|s| point(n, s)));
    all.collect()
}

#[test]
fn known_costs_and_the_size_of_the_cache_are_recovered() {
    let model = CostModel::fit(&points());
    assert!((model.cache / CACHE - 1.0).abs() < 1e-12, "{}", model.cache);
    for (found, known) in model.laws[7].seconds.iter().zip(KNOWN) {
        assert!(
            (found - known).abs() < 1e-6 * KNOWN[0].min(known + 1e-14),
            "{found} {known}"
        );
    }
    let factor = &model.laws[4];
    assert!((factor.seconds[1] / 5e-9 - 1.0).abs() < 1e-6, "{factor:?}");
    let order = &model.laws[5];
    assert!((order.seconds[1] / 1e-8 - 1.0).abs() < 1e-6, "{order:?}");
}

#[test]
fn messages_come_on_top() {
    let (model, one) = (CostModel::fit(&points()), point(8.0, 4.0));
    let net = Network {
        alpha: 1e-6,
        beta: 1e-9,
        gamma: 0.0,
    };
    let at = |ranks: f64| model.seconds(&one.work, ranks, &SentData::of(&one), &net);
    let (alone, many) = (at(1.0), at(1024.0));
    assert!((many.iteration.exchange - (10e-6 + 1e-6)).abs() < 1e-12);
    // Three inner products of CG and four projections with r = 7, ten steps each.
    let reduction = 3.0 * 10.0 * (1e-6 + 8e-9) + 4.0 * 10.0 * (1e-6 + 56e-9);
    assert!((many.iteration.reduction - reduction).abs() < 1e-12);
    assert_eq!(alone.iteration.reduction, 0.0);
    assert_eq!(many.iteration.local, alone.iteration.local);
    // An all-reduce of 9 r numbers in the set-up: few motions are factored by every rank.
    let more = many.setup.factor - alone.setup.factor;
    assert!((more - net.all_reduce(1024.0, 8.0 * 63.0)).abs() < 1e-15);
    let total = many.setup.sum() + 5.0 * many.iteration.sum() + many.outside;
    assert_eq!(many.total(5.0), total);
}

/// The modelled shares are those that ranks have: a square of bodies, each coupled with its eight neighbours.
#[test]
fn shares_are_those_of_the_factor() {
    let n = 100usize;
    let at = |i: usize, j: usize| (i * n + j) as u32;
    let mut entries = Vec::new();
    for (i, j) in (0..n * n).map(|k| (k / n, k % n)) {
        for p in i.saturating_sub(1)..(i + 2).min(n) {
            for q in j.saturating_sub(1)..(j + 2).min(n) {
                entries.push((at(i, j), at(p, q), 1.0));
            }
        }
    }
    let graph = Csr::from_triplets(n * n, &entries);
    let all: Vec<u32> = (0..(n * n) as u32).collect();
    let sets = nested_dissection(&graph, &all, None);
    let symbolic = Symbolic::with_supernodes(&graph, &[], &sets);
    for ranks in [4, 100, 10_000] {
        let way = longest_way(&symbolic, ranks);
        let modelled = FactorShares::new((n * n) as f64, ranks as f64);
        let within = |found: f64, modelled: f64| (0.5..2.0).contains(&(found / modelled));
        assert!(
            within(way.rows, modelled.rows)
                && within(way.messages, modelled.messages)
                && within(way.flops / symbolic.flops(), modelled.work),
            "{ranks} ranks: {way:?} of {} operations, modelled {modelled:?}",
            symbolic.flops()
        );
    }
}

/// The work that is done one after the other when so many ranks share a factor: the largest over the ways from the
/// subtrees to the root, each counted by itself.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Way {
    /// Rows.
    rows: f64,
    /// Multiplications and additions.
    flops: f64,
    /// Messages.
    messages: f64,
}

/// The longest way with so many ranks.
fn longest_way(symbolic: &Symbolic, ranks: usize) -> Way {
    let fronts = &symbolic.fronts;
    let shares = deal(fronts, ranks, &[]);
    let most = |a: Way, b: Way| Way {
        rows: a.rows.max(b.rows),
        flops: a.flops.max(b.flops),
        messages: a.messages.max(b.messages),
    };
    // What comes before a front, and what each rank has done.
    let mut before = vec![Way::default(); fronts.len()];
    let mut done = vec![Way::default(); ranks];
    for above in [false, true] {
        let these = |f: &(usize, &Front)| shares[f.0].above == above;
        for (f, front) in fronts.iter().enumerate().filter(these) {
            let rank = shares[f].rank as usize;
            let mut way = most(done[rank], before[f]);
            way.rows += front.width() as f64;
            way.flops += front.flops();
            way.messages = before[f].messages;
            done[rank] = Way {
                messages: 0.0,
                ..way
            };
            if let Some(t) = front.parent {
                way.messages += f64::from(u8::from(shares[t].rank != shares[f].rank));
                before[t] = most(before[t], way);
            } else {
                before[f].messages = way.messages;
            }
        }
    }
    before.into_iter().chain(done).fold(Way::default(), most)
}
