//! Contradictory gaps: whether all rows can hold together.
//!
//! Rows of different blocks share no dof, and u may take any values at the dofs of a block. B_E u = c_E, B_I u ≤ c_I
//! therefore has a solution if and only if every block has one. By Farkas' lemma a block has a solution unless some λ
//! with λ_I ≥ 0 has Bᵀλ = 0 and cᵀλ < 0.

use crate::feti::operators::dual::Dual;
use crate::linalg::dense::Dense;
use crate::linalg::nnls::nnls;
use crate::linalg::sorted::distinct;
use crate::substructures::Substructures;
use crate::{Error, Result};

/// A block is contradictory if NNLS comes this close to (Bᵀλ, cᵀλ) = (0, −1).
const CONTRADICTION: f64 = 1e-8;

/// Returns an error that names the bodies and the place of the first contradiction. Collective.
pub fn check(problem: &Substructures, dual: &Dual) -> Result<()> {
    dual.stiffness.session.agree(check_mine(problem, dual))
}

fn check_mine(problem: &Substructures, dual: &Dual) -> Result<()> {
    let jump = &dual.stiffness.jump;
    for block in &jump.blocks {
        let candidate = |r: &usize| jump.is_candidate(block.rows.start + r);
        let mut rows: Vec<usize> = (0..block.rows.len()).filter(candidate).collect();
        let gap = |r: usize| jump.gap[block.rows.start + r];
        let equation = |r: usize| !jump.inequality[block.rows.start + r];
        // Rows without interference are satisfied by u = 0.
        if rows
            .iter()
            .all(|&r| gap(r) >= 0.0 && (gap(r) == 0.0 || !equation(r)))
        {
            continue;
        }
        // Independent rows can be satisfied whatever their gaps are.
        let on: Vec<bool> = (0..block.rows.len()).map(|r| candidate(&r)).collect();
        let Some((members, b)) = block.dependent(&on) else {
            continue;
        };
        let at: Vec<usize> = (0..members.len()).filter(|&i| on[members[i]]).collect();
        rows = at.iter().map(|&i| members[i]).collect();
        let n = b.cols;
        let largest = rows.iter().fold(0.0f64, |a, &r| a.max(gap(r).abs()));
        if largest == 0.0 {
            continue;
        }
        let mut a = Dense::zeros(n + 1, rows.len());
        for (k, &r) in rows.iter().enumerate() {
            (0..n).for_each(|j| a.set(j, k, b.get(at[k], j)));
            a.set(n, k, gap(r) / largest);
        }
        let mut wanted = vec![0.0; n + 1];
        wanted[n] = -1.0;
        let free: Vec<bool> = rows.iter().map(|&r| equation(r)).collect();
        let (_, rest) = nnls(&a, &wanted, &free);
        if rest.iter().all(|v| v.abs() < CONTRADICTION) {
            let name = |&b: &u32| format!("\"{}\"", problem.body_names[b as usize]);
            let bodies = distinct(block.bodies.iter().map(name));
            let place = block
                .place(problem, &rows)
                .map_or(String::new(), |[x, y, z]| {
                    if z == 0.0 {
                        format!(" at ({x}, {y})")
                    } else {
                        format!(" at ({x}, {y}, {z})")
                    }
                });
            return Err(Error::input(format!(
                "the gaps of {} {}{place} contradict each other: \
                 no displacement satisfies all {} conditions there, expected gaps that leave room",
                if bodies.len() == 1 { "body" } else { "bodies" },
                bodies.join(", "),
                rows.len()
            )));
        }
    }
    Ok(())
}
