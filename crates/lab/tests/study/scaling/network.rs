//! Unit tests of `crates/lab/src/study/scaling/network.rs`.

use super::*;

#[test]
fn alpha_and_beta_are_recovered() {
    let known = Network {
        alpha: 2e-6,
        beta: 1e-10,
        gamma: 3e-10,
    };
    let timing = |n: &usize| Timing {
        ranks: 2,
        bytes: 8 * n,
        seconds: known.messages(1.0, 8.0 * *n as f64),
    };
    let reduction = |n: &usize| Timing {
        seconds: known.all_reduce(2.0, 8.0 * *n as f64),
        ..timing(n)
    };
    let [messages, reductions]: [Vec<Timing>; 2] = [
        LENGTHS.iter().map(timing).collect(),
        LENGTHS.iter().map(reduction).collect(),
    ];
    let measured = MeasuredNetwork::new(messages, reductions);
    assert!((measured.network.gamma / known.gamma - 1.0).abs() < 1e-8);
    assert!((measured.network.alpha / known.alpha - 1.0).abs() < 1e-8);
    assert!((measured.network.beta / known.beta - 1.0).abs() < 1e-8);
    assert!(measured.largest_deviation < 1e-8);
}

#[test]
fn all_reduces_grow_with_the_logarithm_of_the_ranks() {
    let net = Network {
        alpha: 1e-6,
        beta: 1e-10,
        gamma: 1e-10,
    };
    assert_eq!(net.all_reduce(1.0, 8.0), 0.0);
    assert_eq!(net.all_reduce(2.0, 0.0), 1e-6);
    assert!((net.all_reduce(1000.0, 0.0) / 10e-6 - 1.0).abs() < 1e-12);
    // A long all-reduce moves every byte twice and adds it once, for any number of ranks.
    let long = [64.0, 65536.0].map(|ranks| net.all_reduce(ranks, 1e8));
    assert!(
        long.iter().all(|t| (t / 3e-2 - 1.0).abs() < 0.02),
        "{long:?}"
    );
}
