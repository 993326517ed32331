//! Anderson mixing: the next bounds of friction from those of the last steps.
//!
//! ```text
//!     f_k = Φ(g_k) − g_k,    γ = argmin |f_k − ΔF γ|,    g_{k+1} = Φ(g_k) − (ΔG + ΔF) γ
//! ```
//!
//! Φ is a step of the loop. While the states of the nodes stay it is affine, and mixing is GMRES on it.

use base::linalg::dense::Dense;
use base::linalg::semidefinite::Semidefinite;
use mpi::topology::SimpleCommunicator;
use parallel::exchange::sum_all;
use std::collections::VecDeque;

/// Differences of the last steps: those of g and of f.
#[derive(Debug, Default)]
pub struct Mixing {
    /// g and f of the last step.
    last: Option<[Vec<f64>; 2]>,
    differences: VecDeque<[Vec<f64>; 2]>,
}

impl Mixing {
    /// Forgets all steps: Φ is another map.
    pub fn restart(&mut self) {
        *self = Mixing::default();
    }

    /// The g of the next step from that of a step and Φ(g), on the nodes of this rank; `depth` steps before it count.
    /// Collective.
    pub fn mix(
        &mut self,
        comm: &SimpleCommunicator,
        depth: usize,
        g: Vec<f64>,
        mapped: &[f64],
    ) -> Vec<f64> {
        let f = less(mapped, &g);
        if let Some([g_last, f_last]) = &self.last {
            self.differences
                .push_back([less(&g, g_last), less(&f, f_last)]);
            if self.differences.len() > depth {
                self.differences.pop_front();
            }
        }
        let mut out = mapped.to_vec();
        for (gamma, [dg, df]) in self.weights(comm, &f).iter().zip(&self.differences) {
            for (out, (dg, df)) in out.iter_mut().zip(dg.iter().zip(df)) {
                *out -= gamma * (dg + df);
            }
        }
        self.last = Some([g, f]);
        out
    }

    /// γ.
    fn weights(&self, comm: &SimpleCommunicator, f: &[f64]) -> Vec<f64> {
        let n = self.differences.len();
        let rows = self.differences.iter().map(|d| &d[1]);
        let mut sums: Vec<f64> = Vec::with_capacity(n * (n + 1));
        for row in rows.clone() {
            sums.extend(rows.clone().map(|other| dot(row, other)));
            sums.push(dot(row, f));
        }
        sum_all(comm, &mut sums);
        let at = |i: usize, j: usize| sums[i * (n + 1) + j];
        // Differences get smaller from step to step: of unit length they count alike.
        let length: Vec<f64> = (0..n).map(|i| at(i, i).sqrt()).collect();
        let unit = |i: usize, value: f64| match length[i] {
            l if l > 0.0 => value / l,
            _ => 0.0,
        };
        let mut gram = Dense::zeros(n, n);
        for i in 0..n {
            (0..n).for_each(|j| gram.set(i, j, unit(j, unit(i, at(i, j)))));
        }
        let mut gamma: Vec<f64> = (0..n).map(|i| unit(i, at(i, n))).collect();
        Semidefinite::above(&gram, DEPENDENT).solve(&mut gamma);
        gamma.iter().enumerate().map(|(i, v)| unit(i, *v)).collect()
    }
}

/// Differences whose angle to the others has a square sine below this say nothing new.
const DEPENDENT: f64 = 1e-6;

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn less(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

#[cfg(test)]
#[path = "../../../tests/inside/contact/friction/mixing.rs"]
mod tests;
