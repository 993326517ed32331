//! Unit tests of `crates/lab/src/study/scaling/fit.rs`.

use super::*;

const KNOWN: [f64; 3] = [2e-5, 3e-9, 7e-12];

/// Samples with the terms 1, n² and n³ for n from 1 to 4096, and their cost times `noise` of the sample.
fn samples(noise: impl Fn(usize) -> f64) -> Vec<(Vec<f64>, f64)> {
    let one = |k: usize| {
        let n = 2.0_f64.powi(k as i32);
        let x = vec![1.0, n * n, n * n * n];
        let y: f64 = x.iter().zip(KNOWN).map(|(x, c)| x * c).sum();
        (x, y * noise(k))
    };
    (0..13).map(one).collect()
}

#[test]
fn known_coefficients_are_recovered() {
    let law = Law::fit("test", &["1", "n^2", "n^3"], &samples(|_| 1.0));
    for (found, known) in law.seconds.iter().zip(KNOWN) {
        assert!((found / known - 1.0).abs() < 1e-8, "{found} for {known}");
    }
    assert_eq!(law.points, 13);
    assert!(law.largest_deviation < 1e-8);
}

#[test]
fn noise_shows_in_the_deviations_and_coefficients_stay_positive() {
    let law = Law::fit(
        "test",
        &["1", "n^2", "n^3"],
        &samples(|k| [0.9, 1.1][k % 2]),
    );
    assert!((law.seconds[2] / KNOWN[2] - 1.0).abs() < 0.2, "{law:?}");
    assert!(
        law.largest_deviation > 0.05 && law.median_deviation < 0.3,
        "{law:?}"
    );
    // A term that falls does not get a negative coefficient.
    let falling: Vec<_> = (1..9)
        .map(|n| (vec![1.0, n as f64], 10.0 - n as f64))
        .collect();
    let law = Law::fit("falling", &["1", "n"], &falling);
    assert!(law.seconds[0] > 0.0 && law.seconds[1] == 0.0, "{law:?}");
}

#[test]
fn what_is_not_there_costs_nothing() {
    let mut all = samples(|_| 1.0);
    all.push((vec![0.0; 3], 1.0));
    let law = Law::fit("test", &["1", "n^2", "n^3"], &all);
    assert_eq!(law.points, 13);
    assert_eq!(law.at(&[0.0; 3]), 0.0);
    assert_eq!(Law::fit("none", &["1"], &[]).at(&[1.0]), 0.0);
}
