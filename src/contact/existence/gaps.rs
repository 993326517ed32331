//! Contradictory gaps: whether all rows can hold together.
//!
//! Rows of different blocks share no dof, and u may take any values at the dofs of a block. B_E u = c_E, B_I u ≤ c_I
//! therefore has a solution if and only if every block has one. By Farkas' lemma a block has a solution unless some λ
//! with λ_I ≥ 0 has Bᵀλ = 0 and cᵀλ < 0.

use crate::feti::jump::blocks::Block;
use crate::feti::operators::dual::Dual;
use crate::substructures::Problem;
use crate::{Error, Result};
use base::linalg::dense::Dense;
use base::linalg::nnls::nnls;
use base::linalg::sorted::distinct;

/// Returns an error that names the bodies and the place of the first contradiction on this rank, for NNLS that comes as
/// near as `near`.
pub fn check(problem: &Problem, dual: &Dual, near: f64) -> Result<()> {
    let jump = &dual.stiffness.jump;
    for block in &jump.blocks {
        // A node with friction may slip: its tangential rows contradict nothing.
        let candidate = |r: &usize| {
            let r = block.rows.start + r;
            jump.is_candidate(r) && !jump.law[r].is_friction()
        };
        let rows = || (0..block.rows.len()).filter(candidate);
        let gap = |r: usize| jump.gap[block.rows.start + r];
        let equation = |r: usize| !jump.law[block.rows.start + r].is_inequality();
        // Rows without interference are satisfied by u = 0.
        if rows().all(|r| gap(r) >= 0.0 && (gap(r) == 0.0 || !equation(r))) {
            continue;
        }
        // Independent rows can be satisfied whatever their gaps are.
        let on: Vec<bool> = (0..block.rows.len()).map(|r| candidate(&r)).collect();
        for (members, b) in block.dependent_sets(&on) {
            let at: Vec<usize> = (0..members.len()).filter(|&i| on[members[i]]).collect();
            let gaps: Vec<f64> = at.iter().map(|&i| gap(members[i])).collect();
            let free: Vec<bool> = at.iter().map(|&i| equation(members[i])).collect();
            let column = |j: usize, k: usize| b.get(at[k], j);
            if contradicts(b.cols, column, (&gaps, &free), near) {
                let rows: Vec<usize> = at.iter().map(|&i| members[i]).collect();
                return Err(contradiction(problem, block, &rows));
            }
        }
    }
    Ok(())
}

/// Whether some λ ≥ 0, free on equations, has Bᵀλ = 0 and cᵀλ < 0. `bt` gives the entries of Bᵀ, which has `n` rows.
fn contradicts(
    n: usize,
    bt: impl Fn(usize, usize) -> f64,
    (c, free): (&[f64], &[bool]),
    near: f64,
) -> bool {
    let largest = c.iter().fold(0.0f64, |a, c| a.max(c.abs()));
    if largest == 0.0 {
        return false;
    }
    let a = Dense::from_fn(n + 1, c.len(), |j, k| match j {
        j if j == n => c[k] / largest,
        j => bt(j, k),
    });
    let mut wanted = vec![0.0; n + 1];
    wanted[n] = -1.0;
    let (_, rest) = nnls(&a, &wanted, free);
    rest.iter().all(|v| v.abs() < near)
}

/// The sentence about these rows of a block.
fn contradiction(problem: &Problem, block: &Block, rows: &[usize]) -> Error {
    let name = |&b: &u32| format!("\"{}\"", problem.body_names[b as usize]);
    let bodies = distinct(block.bodies().iter().map(name));
    let place = match block.place(problem, rows) {
        None => String::new(),
        Some([x, y, 0.0]) => format!(" at ({x}, {y})"),
        Some([x, y, z]) => format!(" at ({x}, {y}, {z})"),
    };
    Error::input(format!(
        "the gaps of {} {}{place} contradict each other: \
         no displacement satisfies all {} conditions there, expected gaps that leave room",
        if bodies.len() == 1 { "body" } else { "bodies" },
        bodies.join(", "),
        rows.len()
    ))
    .at(problem.location(&block.bodies()))
}
