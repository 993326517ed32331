//! Rows that close cycles, as those of a cross point do: multipliers around a cycle are no forces.
//!
//! ```text
//!     min cᵀλ'    over    Bᵀλ' = Bᵀλ,   λ' ≥ 0
//! ```
//!
//! Where gaps around a cycle do not fit, some row of it must leave. Forces do not tell which one, cᵀλ does. Updates of
//! multipliers move λ around cycles only by what springs give way; here the minimum is found at once.

use super::groups::{components, multipliers, MultiplierSigns};
use super::rows::{GapInequality, Inequalities};

/// The slope of cᵀλ around cycles is zero below this, relative to the gaps.
const LEVEL: f64 = 1e-12;

/// Moves multipliers ≥ 0 to where cᵀλ is least among those with the same forces. Where it has no minimum, no
/// displacement satisfies the rows of the cycle, and its multipliers stay.
pub(super) fn descend_around_cycles(rows: &Inequalities, lambda: &mut [f64]) {
    // A row leaves in each pass.
    for _ in 0..lambda.len() {
        let active: Vec<bool> = lambda.iter().map(|l| *l > 0.0).collect();
        let mut loads = vec![0.0; rows.ground()];
        for row in rows.list(&active).into_iter().map(|r| &rows.rows[r]) {
            let GapInequality { plus, minus, gap } = *row;
            for (end, sign) in [(plus, 1.0), (minus, -1.0)] {
                if let Some(load) = loads.get_mut(end) {
                    *load += sign * gap;
                }
            }
        }
        // The part of c that is B w for some w. The rest is orthogonal to it, and against the rest cᵀλ falls.
        let fits = multipliers(rows, &active, &loads, MultiplierSigns::Any);
        let along = |r: usize| fits[r] - rows.rows[r].gap;
        let mut moved = false;
        for members in components(rows, &active) {
            let most = |f: &dyn Fn(usize) -> f64| {
                let sizes = members.iter().map(|&r| f(r).abs());
                sizes.fold(0.0, f64::max)
            };
            let level = LEVEL * most(&|r| rows.rows[r].gap);
            if most(&along) <= level {
                continue;
            }
            let ratio = |r: usize| lambda[r] / -along(r);
            let falling = members.iter().copied().filter(|&r| along(r) < -level);
            let first = falling.min_by(|&a, &b| ratio(a).total_cmp(&ratio(b)));
            let Some(first) = first else { continue };
            let step = ratio(first);
            for &r in &members {
                lambda[r] = (lambda[r] + step * along(r)).max(0.0);
            }
            lambda[first] = 0.0;
            moved = true;
        }
        if !moved {
            return;
        }
    }
}

#[cfg(test)]
#[path = "../../tests/assembled/cycles.rs"]
mod tests;
