//! Active rows as equations. Unknowns that active rows join form a group; every unknown of a group is the group's
//! unknown plus an offset.
//!
//! ```text
//!     u = T v + u₀,   Tᵀ K T v = Tᵀ (f − K u₀)        T: one column per group, none for a group that hangs on ground
//!     Bᵀ λ = f − K u                                  the shortest λ, group by group
//! ```

use super::potentials::Potentials;
use super::rows::Inequalities;
use base::linalg::dense::Dense;
use base::linalg::nnls::nnls;
use base::linalg::semidefinite::Semidefinite;

/// Gaps that differ by less than this, relative to the largest, are equal.
const SAME: f64 = 1e-12;

/// Forces on a group balance if less than this is left, relative to their norm.
const BALANCED: f64 = 1e-10;

/// The groups of one active set.
#[derive(Debug, Clone)]
pub struct ActiveGroups {
    /// For every unknown of [`Inequalities::unknowns`] the lowest unknown of its group; `None` where the group is tied
    /// to ground.
    pub lead: Vec<Option<usize>>,
    /// u minus u at the group's lowest unknown; u itself in a group that is tied to ground.
    pub offset: Vec<f64>,
    /// Rows that hold as equations: the active ones, and those implied by them.
    pub holds: Vec<bool>,
}

impl ActiveGroups {
    /// Joins the unknowns of the active rows that do not give way, in the order of `priority`. A row that contradicts
    /// those before it is taken out of `active`.
    pub fn new(rows: &Inequalities, active: &mut [bool], priority: &[usize]) -> ActiveGroups {
        let largest = rows.rows.iter().fold(0.0f64, |a, r| a.max(r.gap.abs()));
        let n = rows.ground();
        let mut sets = Potentials::new(n + 1);
        for &r in priority {
            let row = &rows.rows[r];
            if active[r] && rows.softness(r) == 0.0 {
                let misses = sets.join(row.plus, row.minus, row.gap);
                active[r] = misses.is_none_or(|by| by.abs() <= SAME * largest);
            }
        }
        let ground = sets.find(n);
        let mut first: Vec<Option<(usize, f64)>> = vec![None; n + 1];
        let (mut lead, mut offset) = (Vec::with_capacity(n), Vec::with_capacity(n));
        for k in 0..n {
            let (root, u) = sets.find(k);
            if root == ground.0 {
                lead.push(None);
                offset.push(u - ground.1);
            } else {
                let (one, its) = *first[root].get_or_insert((k, u));
                lead.push(Some(one));
                offset.push(u - its);
            }
        }
        let mut follows = |r: &super::rows::GapInequality| {
            let ((a, u_a), (b, u_b)) = (sets.find(r.plus), sets.find(r.minus));
            a == b && r.plus != r.minus && (u_a - u_b - r.gap).abs() <= SAME * largest
        };
        ActiveGroups {
            lead,
            offset,
            holds: rows.rows.iter().map(&mut follows).collect(),
        }
    }

    /// Whether unknown `k` is the lowest one of a group that is not tied to ground.
    pub fn is_free(&self, k: usize) -> bool {
        self.lead[k] == Some(k)
    }

    /// Tᵀ x at the unknowns in rows: the sum over each group, stored at its lowest unknown.
    pub fn fold(&self, x: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; x.len()];
        for (lead, x) in self.lead.iter().zip(x) {
            if let Some(lead) = lead {
                out[*lead] += x;
            }
        }
        out
    }

    /// T v + u₀ at the unknowns in rows.
    pub fn spread(&self, v: &[f64]) -> Vec<f64> {
        let both = self.lead.iter().zip(&self.offset);
        both.map(|(lead, offset)| lead.map_or(0.0, |k| v[k]) + offset)
            .collect()
    }

    /// The v that minimises the weighted distance of T v + u₀ from u.
    pub fn nearest(&self, u: &[f64], weight: &[f64]) -> Vec<f64> {
        let apart = u.iter().zip(&self.offset).zip(weight);
        let sum = self.fold(&apart.map(|((u, o), w)| w * (u - o)).collect::<Vec<_>>());
        let total = self.fold(weight);
        let quotient = |(s, t): (&f64, &f64)| if *t > 0.0 { s / t } else { 0.0 };
        sum.iter().zip(&total).map(quotient).collect()
    }
}

/// Which multipliers of rows that depend on each other are wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MultiplierSigns {
    /// The shortest.
    Any,
    /// Multipliers that do not pull, where there are such.
    Pushing,
}

/// The active rows, those that unknowns connect together.
pub(super) fn components(rows: &Inequalities, active: &[bool]) -> Vec<Vec<usize>> {
    // Ground transmits no force: groups that are tied to it stay separate.
    let mut sets = Potentials::new(rows.ground());
    let on = || (0..rows.len()).filter(|&k| active[k]);
    for row in on().map(|k| rows.rows[k]) {
        if row.plus.max(row.minus) < rows.ground() {
            sets.join(row.plus, row.minus, 0.0);
        }
    }
    let mut of_set: std::collections::BTreeMap<usize, Vec<usize>> = Default::default();
    for k in on() {
        let end = rows.rows[k].plus.min(rows.rows[k].minus);
        of_set.entry(sets.find(end).0).or_default().push(k);
    }
    of_set.into_values().collect()
}

/// The active rows that depend on each other, with all that unknowns connect with them: their multipliers are not the
/// only ones.
pub fn unclear(rows: &Inequalities, active: &[bool]) -> Vec<bool> {
    let mut out = vec![false; rows.len()];
    for members in components(rows, active) {
        let mut sets = Potentials::new(rows.ground() + 1);
        let mut closes = |&r: &usize| {
            let row = rows.rows[r];
            sets.join(row.plus, row.minus, 0.0).is_some()
        };
        if members.iter().any(&mut closes) {
            members.iter().for_each(|&r| out[r] = true);
        }
    }
    out
}

/// The multipliers of smallest norm of the active rows that satisfy Bᵀ λ = r, or come nearest to it; zero on the other
/// rows. `r` is given at the unknowns in rows.
pub fn multipliers(
    rows: &Inequalities,
    active: &[bool],
    r: &[f64],
    signs: MultiplierSigns,
) -> Vec<f64> {
    let ground = rows.ground();
    let mut lambda = vec![0.0; rows.len()];
    for members in &components(rows, active) {
        let ends = members
            .iter()
            .flat_map(|&k| [rows.rows[k].plus, rows.rows[k].minus]);
        let mut unknowns: Vec<usize> = ends.clone().filter(|&e| e < ground).collect();
        unknowns.sort_unstable();
        unknowns.dedup();
        let floats = ends.clone().all(|e| e < ground);
        let place = |e: usize| unknowns.binary_search(&e).ok();
        // λ = B w with Bᵀ B w = r. The rows cannot carry a net force on the whole group, so it is subtracted from r.
        let n = unknowns.len();
        let mut laplacian = Dense::zeros(n, n);
        for row in members.iter().map(|&k| rows.rows[k]) {
            let places = [place(row.plus), place(row.minus)];
            for (i, a) in places.iter().enumerate() {
                for (j, b) in places.iter().enumerate() {
                    if let (Some(a), Some(b)) = (*a, *b) {
                        let sign = if i == j { 1.0 } else { -1.0 };
                        laplacian.set(a, b, laplacian.get(a, b) + sign);
                    }
                }
            }
        }
        let mut w: Vec<f64> = unknowns.iter().map(|&e| r[e]).collect();
        if floats {
            let mean = w.iter().sum::<f64>() / n as f64;
            w.iter_mut().for_each(|w| *w -= mean);
        }
        let forces = w.clone();
        Semidefinite::new(&laplacian).solve(&mut w);
        let at = |e: usize| place(e).map_or(0.0, |k| w[k]);
        for &k in members {
            lambda[k] = at(rows.rows[k].plus) - at(rows.rows[k].minus);
        }
        if signs == MultiplierSigns::Pushing && members.iter().any(|&k| lambda[k] < 0.0) {
            let to = |k: usize, j: usize| {
                let of = |end: usize| f64::from(place(end) == Some(k));
                of(rows.rows[members[j]].plus) - of(rows.rows[members[j]].minus)
            };
            let transpose = Dense::from_fn(n, members.len(), to);
            let (x, rest) = nnls(&transpose, &forces, &vec![false; members.len()]);
            let norm = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
            if norm(&rest) <= BALANCED * norm(&forces) {
                members.iter().zip(x).for_each(|(&k, x)| lambda[k] = x);
            }
        }
    }
    lambda
}

#[cfg(test)]
#[path = "../../tests/assembled/groups.rs"]
mod tests;
