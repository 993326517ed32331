//! Costs as sums of terms with coefficients ≥ 0, by least squares.

use serde::{Deserialize, Serialize};

use base::linalg::dense::Dense;
use base::linalg::nnls::nnls;

/// Clocks and caches make small measurements uncertain. A measurement is therefore weighted relative to itself plus
/// this part of the largest measurement.
const SMALL: f64 = 0.01;

/// Seconds of a phase as Σ coefficient · term.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Law {
    /// The phase.
    pub phase: String,
    /// Names of its terms.
    pub terms: Vec<String>,
    /// Seconds per unit of each term, none of them negative.
    pub seconds: Vec<f64>,
    /// Number of measurements that the law is fitted to.
    pub points: usize,
    /// Median of |fitted − measured| / measured.
    pub median_deviation: f64,
    /// Largest of these deviations.
    pub largest_deviation: f64,
    /// The sum of squares that the fit minimises.
    pub misfit: f64,
    /// (measured, fitted) of every measurement.
    pub residuals: Vec<(f64, f64)>,
}

impl Law {
    /// Fits a phase; `samples` are (terms, seconds). Samples in which all terms are zero are left out: the phase does
    /// not occur in them.
    pub fn fit(phase: &str, terms: &[&str], samples: &[(Vec<f64>, f64)]) -> Law {
        let there = |s: &&(Vec<f64>, f64)| s.1 > 0.0 && s.0.iter().any(|x| *x > 0.0);
        let samples: Vec<&(Vec<f64>, f64)> = samples.iter().filter(there).collect();
        let largest = samples.iter().fold(0.0, |a: f64, s| a.max(s.1));
        let (m, n) = (samples.len(), terms.len());
        let mut a = Dense::zeros(m, n);
        let mut b = vec![0.0; m];
        for (i, (x, y)) in samples.iter().map(|s| (&s.0, s.1)).enumerate() {
            let weight = 1.0 / (y + SMALL * largest);
            b[i] = weight * y;
            for (j, x) in x.iter().enumerate() {
                a.set(i, j, weight * x);
            }
        }
        // Columns are scaled to equal length: r³ and 1 are eleven decades apart.
        let length = |j: usize| a.col(j).iter().map(|x| x * x).sum::<f64>().sqrt();
        let sizes: Vec<f64> = (0..n).map(length).collect();
        for (j, size) in sizes.iter().enumerate().filter(|s| *s.1 > 0.0) {
            a.col_mut(j).iter_mut().for_each(|x| *x /= size);
        }
        let mut law = Law {
            phase: phase.into(),
            terms: terms.iter().map(|t| t.to_string()).collect(),
            seconds: vec![0.0; n],
            points: m,
            ..Law::default()
        };
        if m == 0 {
            return law;
        }
        let (x, rest) = nnls(&a, &b, &vec![false; n]);
        law.misfit = rest.iter().map(|r| r * r).sum();
        let unscaled = x.iter().zip(&sizes);
        law.seconds = unscaled
            .map(|(x, s)| if *s > 0.0 { x / s } else { 0.0 })
            .collect();
        law.residuals = samples.iter().map(|s| (s.1, law.at(&s.0))).collect();
        let of = |(y, fitted): &(f64, f64)| (fitted - y).abs() / y;
        let mut off: Vec<f64> = law.residuals.iter().map(of).collect();
        off.sort_by(f64::total_cmp);
        law.median_deviation = off[off.len() / 2];
        law.largest_deviation = off[off.len() - 1];
        law
    }

    /// The seconds of the phase for these terms.
    pub fn at(&self, terms: &[f64]) -> f64 {
        self.seconds.iter().zip(terms).map(|(c, x)| c * x).sum()
    }
}

#[cfg(test)]
#[path = "../../../tests/study/scaling/fit.rs"]
mod tests;
