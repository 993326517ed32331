//! Rows of one node that depend on each other: at a cross point with different gaps not all of them can hold.
//!
//! ```text
//!     λ ← λ − t N Nᵀ c,      Bᵀ N = 0,      λ ≥ 0 on inequalities
//! ```
//!
//! Multipliers N are no forces: displacements do not tell them. The dual energy does, by −cᵀλ. An update of the
//! multipliers moves them along N by what the springs give way, so that it takes many updates until the row that must
//! leave has left. Here they go all the way at once, node by node.

use crate::feti::jump::operator::Jump;
use crate::feti::operators::springs::forceless;
use crate::substructures::Law;
use base::linalg::dense::Dense;

/// Moves the multipliers of all blocks of dependent rows downhill in cᵀλ, until rows with multipliers do not contradict
/// each other. Forces Bᵀλ stay. cᵀN counts as zero below `rounding`, relative to its terms.
pub fn ratio_test_descent(jump: &Jump, lambda: &mut [f64], rounding: f64) {
    for block in jump.blocks.iter().filter(|b| b.rows.len() > 1) {
        let on: Vec<bool> = block
            .rows
            .clone()
            .map(|r| jump.law[r].bears(lambda[r]))
            .collect();
        let Some((rows, b)) = block.dependent(&on) else {
            continue;
        };
        let rows: Vec<usize> = rows.iter().map(|r| block.rows.start + r).collect();
        let law: Vec<Law> = rows.iter().map(|&r| jump.law[r]).collect();
        let c: Vec<f64> = rows.iter().map(|&r| jump.gap[r]).collect();
        let mut own: Vec<f64> = rows.iter().map(|&r| lambda[r]).collect();
        ratio_test_descent_at_node(&b, &law, &c, &mut own, rounding);
        rows.iter().zip(own).for_each(|(&r, l)| lambda[r] = l);
    }
}

/// Moves the multipliers of the rows `b` of one node downhill in cᵀλ, until rows with multipliers do not contradict
/// each other. Forces Bᵀλ stay.
fn ratio_test_descent_at_node(
    b: &Dense,
    law: &[Law],
    c: &[f64],
    lambda: &mut [f64],
    rounding: f64,
) {
    // A row leaves in each pass.
    for _ in 0..lambda.len() {
        let on = |&r: &usize| law[r].bears(lambda[r]);
        let rows: Vec<usize> = (0..lambda.len()).filter(on).collect();
        if rows.len() < 2 {
            return;
        }
        let n = forceless(b, &rows);
        // The steepest descent of cᵀλ: −N Nᵀ c.
        let mut along = vec![0.0; rows.len()];
        let mut level: f64 = 0.0;
        for k in 0..n.cols {
            let column = n.col(k);
            let slope: f64 = rows.iter().zip(column).map(|(&r, v)| c[r] * v).sum();
            let terms: f64 = rows
                .iter()
                .zip(column)
                .map(|(&r, v)| (c[r] * v).abs())
                .sum();
            if slope.abs() > rounding * terms {
                level = level.max(slope.abs());
                along
                    .iter_mut()
                    .zip(column)
                    .for_each(|(a, v)| *a -= slope * v);
            }
        }
        if level == 0.0 {
            return;
        }
        let falls = |i: &usize| law[rows[*i]].is_inequality() && along[*i] < -1e-10 * level;
        let ratio = |i: usize| lambda[rows[i]] / -along[i];
        let first = (0..rows.len())
            .filter(falls)
            .min_by(|&i, &j| ratio(i).total_cmp(&ratio(j)));
        // Without an end the gaps contradict each other: the certificate has the word.
        let Some(first) = first else { return };
        let step = ratio(first);
        for (i, &r) in rows.iter().enumerate() {
            lambda[r] += step * along[i];
            lambda[r] = law[r].project(lambda[r]);
        }
        lambda[rows[first]] = 0.0;
    }
}

#[cfg(test)]
#[path = "../../../tests/inside/contact/repairs/dependent.rs"]
mod tests;
