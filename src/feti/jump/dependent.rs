//! Rows that depend on each other: right-hand sides that they can satisfy together, and rows that follow from others.

use super::blocks::Block;
use super::scaling;
use crate::substructures::Law;
use base::linalg::dense::Dense;
use base::linalg::nnls::nnls;

/// Other multipliers of rows that depend on each other.
pub struct Others {
    /// All rows of the block that may depend on each other.
    pub rows: Vec<usize>,
    /// (row, multiplier) of those that hold, admissible by their laws.
    pub multipliers: Vec<(usize, f64)>,
    /// The largest force that they lack.
    pub rest: f64,
}

impl Block {
    /// The admissible multipliers whose forces are nearest to those of `lambda` on the rows in `on`
    /// that may depend on each other. All slices have an entry per row of the block. `None` if no row depends on
    /// others.
    pub fn others(&self, on: &[bool], law: &[Law], lambda: &[f64]) -> Option<Others> {
        let (rows, part) = self.dependent(on)?;
        let at: Vec<usize> = (0..rows.len()).filter(|&i| on[rows[i]]).collect();
        let b = Dense::from_fn(part.cols, at.len(), |j, i| part.get(at[i], j));
        let held: Vec<usize> = at.iter().map(|&i| rows[i]).collect();
        let own: Vec<f64> = held.iter().map(|&r| lambda[r]).collect();
        let mut forces = vec![0.0; part.cols];
        b.add_mul(&own, &mut forces);
        let free: Vec<bool> = held.iter().map(|&r| !law[r].is_inequality()).collect();
        let (values, rest) = nnls(&b, &forces, &free);
        Some(Others {
            rows,
            multipliers: held.into_iter().zip(values).collect(),
            rest: rest.iter().fold(0.0, |a, v| a.max(v.abs())),
        })
    }
}

impl Block {
    /// The rows in `later` that depend on those in `on` and on earlier ones in `later` that are `rigid`. Each is given
    /// with the part of its length outside their span up to which it depends on them. `on` and `rigid` have an entry
    /// per row of the block; none of the `later` rows is on.
    pub fn followers(&self, on: &[bool], later: &[(usize, f64)], rigid: &[bool]) -> Vec<usize> {
        let mut all = on.to_vec();
        later.iter().for_each(|r| all[r.0] = true);
        let Some((rows, b)) = self.dependent(&all) else {
            return Vec::new();
        };
        let place = |r: usize| rows.binary_search(&r).ok();
        let first = (0..rows.len()).filter(|&i| on[rows[i]]).map(|i| (i, 0.0));
        let then = later
            .iter()
            .filter_map(|&(r, near)| Some((place(r)?, near)));
        let mut span: Vec<Vec<f64>> = Vec::new();
        let mut out = Vec::new();
        for (i, near) in first.chain(then) {
            let mut row: Vec<f64> = (0..b.cols).map(|j| b.get(i, j)).collect();
            let size = norm(&row);
            for _ in 0..2 {
                for q in &span {
                    let along: f64 = q.iter().zip(&row).map(|(q, v)| q * v).sum();
                    row.iter_mut().zip(q).for_each(|(v, q)| *v -= along * q);
                }
            }
            let rest = norm(&row);
            let r = rows[i];
            if !on[r] && rest <= near * size {
                out.push(r);
            } else if rigid[r] && rest > f64::EPSILON * size {
                row.iter_mut().for_each(|v| *v /= rest);
                span.push(row);
            }
        }
        out
    }
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// B B⁺ c over the active rows of B, the nearest right-hand side that they can satisfy together; `c` on the others.
pub fn consistent(b: &Dense, active: &[bool], c: &[f64]) -> Vec<f64> {
    let mut out = c.to_vec();
    let rows: Vec<usize> = (0..active.len()).filter(|&r| active[r]).collect();
    let largest = rows.iter().fold(0.0f64, |a, &r| a.max(c[r].abs()));
    if rows.len() < 2 || largest == 0.0 {
        return out;
    }
    let b = faer::Mat::from_fn(rows.len(), b.cols, |i, j| b.get(rows[i], j));
    let range = scaling::range(&b);
    if range.ncols() == rows.len() {
        return out;
    }
    let mut near = vec![0.0; rows.len()];
    for l in 0..range.ncols() {
        let along: f64 = (0..rows.len()).map(|i| range[(i, l)] * c[rows[i]]).sum();
        near.iter_mut()
            .enumerate()
            .for_each(|(i, n)| *n += along * range[(i, l)]);
    }
    rows.iter().zip(&near).for_each(|(&r, n)| out[r] = *n);
    keep(active, c, &mut out);
    out
}

/// Puts back `c` where `near` differs by rounding, which means that both are the same.
pub fn keep(active: &[bool], c: &[f64], near: &mut [f64]) {
    let active = || (0..c.len()).filter(|&r| active[r]);
    let largest = active().fold(0.0f64, |a, r| a.max(c[r].abs()));
    for r in active() {
        if (near[r] - c[r]).abs() <= 1e-12 * largest {
            near[r] = c[r];
        }
    }
}

/// Rows of B that follow from the active ones: they depend on them, and their right-hand side `c` is the same
/// combination.
pub fn implied(b: &Dense, active: &[bool], c: &[f64]) -> Vec<usize> {
    let mut held = active.to_vec();
    let mut out = Vec::new();
    let rank = |on: &[bool]| {
        let rows: Vec<usize> = (0..on.len()).filter(|&r| on[r]).collect();
        let b = faer::Mat::from_fn(rows.len(), b.cols, |i, j| b.get(rows[i], j));
        if rows.is_empty() {
            0
        } else {
            scaling::range(&b).ncols()
        }
    };
    let known = rank(active);
    for r in (0..active.len()).filter(|&r| !active[r]) {
        held[r] = true;
        let follows = known > 0 && rank(&held) == known;
        if follows && consistent(b, &held, c) == c {
            out.push(r);
        }
        held[r] = false;
    }
    out
}

#[cfg(test)]
#[path = "../../../tests/inside/feti/jump/dependent.rs"]
mod tests;
