//! Rows of B_gl as a solve leaves them, in the order in which the problem has them.

use super::{FetiFeti, Solution};
use crate::substructures::SolvedRow;

impl FetiFeti {
    /// The rows that this rank provides, in its order: body, node, normal, gap, multiplier, pressure, state.
    pub fn rows(&self, solution: &Solution) -> Vec<SolvedRow> {
        let dual = self.dual();
        let jump = &dual.stiffness.jump;
        let multipliers = jump.in_given_order(&solution.lambda);
        let excess = jump.in_given_order(&solution.gaps);
        let holds = jump.in_given_order(&solution.active);
        let values = multipliers.into_iter().zip(excess).zip(holds);
        let rows = self.problem().rows.iter().zip(values);
        rows.map(|(row, ((multiplier, excess), holds))| {
            SolvedRow::new(row, multiplier, excess, holds)
        })
        .collect()
    }
}
