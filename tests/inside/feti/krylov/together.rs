//! Unit tests of `src/feti/krylov/together.rs`.

use super::*;

/// Whether CG for a diagonal matrix with these entries sees an eigenvalue above `tau`, after each step.
fn seen(eigenvalues: &[f64], tau: f64) -> Vec<bool> {
    let n = eigenvalues.len();
    let mut r = vec![1.0; n];
    let mut p = vec![0.0; n];
    let (mut rho, mut spectrum) = (0.0, LargestEigenvalue::default());
    let step = |_| {
        let now: f64 = r.iter().map(|r| r * r).sum();
        let beta = if rho > 0.0 { now / rho } else { 0.0 };
        spectrum.beta = beta;
        rho = now;
        p.iter_mut().zip(&r).for_each(|(p, r)| *p = r + beta * *p);
        let curvature: f64 = p.iter().zip(eigenvalues).map(|(p, l)| l * p * p).sum();
        let alpha = rho / curvature;
        spectrum.add(alpha, tau);
        for ((r, p), l) in r.iter_mut().zip(&p).zip(eigenvalues) {
            *r -= alpha * l * p;
        }
        spectrum.beyond
    };
    (0..n).map(step).collect()
}

#[test]
fn eigenvalues_above_a_limit_are_seen_and_others_are_not() {
    let eigenvalues = [1.0, 1.4, 2.0, 3.1, 4.0, 7.5, 20.0];
    // Ritz values grow from step to step and end at the eigenvalues.
    for tau in [1.5, 5.0, 15.0, 19.9] {
        let seen = seen(&eigenvalues, tau);
        assert!(seen[eigenvalues.len() - 1], "{tau}: {seen:?}");
        assert!(seen.windows(2).all(|s| s[0] <= s[1]), "{tau}: {seen:?}");
    }
    assert!(!seen(&eigenvalues, 20.1).contains(&true));
    assert!(!seen(&eigenvalues, 19.9)[0]);
}
