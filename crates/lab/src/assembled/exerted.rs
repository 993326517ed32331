//! Forces of rows that do not hold as equations: given ones, and those of springs.
//!
//! ```text
//!     λ = g + Σ_s c_s κ_s (c_sᵀ j − ϱ_s)        j = B w − gap: a spring s joins few rows by coefficients c_s
//! ```
//!
//! Friction gives the force along a slip, and has a spring across it; soft contact and elastic slip are springs of one
//! row. In the equations they are B_sᵀ κ B_s in the matrix and Bᵀλ at w = 0 in the loads: both stay symmetric.

use super::groups::ActiveGroups;
use super::rows::Inequalities;

/// A spring between the sides of rows.
#[derive(Debug, Clone, PartialEq)]
pub struct RowSpring {
    /// Rows with their coefficients.
    pub rows: Vec<(usize, f64)>,
    /// κ.
    pub stiffness: f64,
    /// ϱ.
    pub rest: f64,
}

impl RowSpring {
    /// c_sᵀ j from the differences of the rows.
    pub fn jump(&self, gaps: &[f64]) -> f64 {
        self.rows.iter().map(|&(r, c)| c * gaps[r]).sum()
    }
}

/// Springs and given multipliers.
#[derive(Debug, Clone, Default)]
pub struct ExertedForces {
    /// The springs.
    pub springs: Vec<RowSpring>,
    /// The given multipliers by row; a shorter list stands for zeros.
    pub given: Vec<f64>,
}

impl ExertedForces {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.springs.is_empty() && self.given.is_empty()
    }

    /// The multipliers where the differences of the rows are `gaps`.
    pub fn multipliers(&self, gaps: &[f64]) -> Vec<f64> {
        let mut out = self.given.clone();
        out.resize(gaps.len(), 0.0);
        for spring in &self.springs {
            let force = spring.stiffness * (spring.jump(gaps) - spring.rest);
            spring.rows.iter().for_each(|&(r, c)| out[r] += c * force);
        }
        out
    }

    /// Bᵀ λ at the unknowns in rows, from w there.
    pub fn forces(&self, rows: &Inequalities, w: &[f64]) -> Vec<f64> {
        if self.is_empty() {
            return vec![0.0; w.len()];
        }
        rows.transposed(&self.multipliers(&rows.gaps(w)))
    }

    /// The entries (k, l, value) of the springs in the matrix of a set, where k and l are the lowest unknowns of their
    /// groups.
    pub fn entries(&self, rows: &Inequalities, groups: &ActiveGroups) -> Vec<(usize, usize, f64)> {
        let mut out = Vec::new();
        for spring in &self.springs {
            let mut form: Vec<(usize, f64)> = Vec::new();
            for &(r, c) in &spring.rows {
                for (end, value) in [(rows.rows[r].plus, c), (rows.rows[r].minus, -c)] {
                    let lead = groups.lead.get(end).copied().flatten();
                    form.extend(lead.map(|lead| (lead, value)));
                }
            }
            for &(k, a) in &form {
                out.extend(form.iter().map(|&(l, b)| (k, l, spring.stiffness * a * b)));
            }
        }
        out
    }

    /// Whether the springs have the same matrix as others, whatever their forces are.
    pub fn is_as_stiff(&self, other: &ExertedForces) -> bool {
        let same =
            |(a, b): (&RowSpring, &RowSpring)| a.rows == b.rows && a.stiffness == b.stiffness;
        self.springs.len() == other.springs.len()
            && self.springs.iter().zip(&other.springs).all(same)
    }

    /// The number of rows in springs that are others than those of `built`, or stiffer or softer by more than this
    /// factor.
    pub fn rows_changed(&self, built: &ExertedForces, factor: f64) -> usize {
        let alike = |a: &RowSpring, b: &RowSpring| {
            let ratio = a.stiffness / b.stiffness;
            let turned = a
                .rows
                .iter()
                .zip(&b.rows)
                .any(|(a, b)| a.0 != b.0 || (a.1 - b.1).abs() > TURNED);
            !turned && ratio < factor && ratio > 1.0 / factor
        };
        let key = |s: &RowSpring| s.rows.first().map_or(0, |r| r.0);
        let known: std::collections::HashMap<usize, &RowSpring> =
            built.springs.iter().map(|s| (key(s), s)).collect();
        let kept = |s: &&RowSpring| known.get(&key(s)).is_some_and(|b| alike(s, b));
        let kept = self.springs.iter().filter(kept).count();
        let most = self.springs.len().max(built.springs.len());
        most - kept
    }
}

/// A spring whose coefficients have changed by more than this has turned.
const TURNED: f64 = 0.2;

#[cfg(test)]
#[path = "../../tests/assembled/exerted.rs"]
mod tests;
