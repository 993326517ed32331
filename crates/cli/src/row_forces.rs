//! The forces of solved rows on the nodes that they join.

use base::Result;
use fetifeti::problem::BodyNode;
use fetifeti::solution::SolvedRow;
use fetifeti::Solution;
use petsc::Session;
use scene::{distribution, RowTerms, Scene};

/// The rows of a scene that this rank provides.
pub(super) struct RowForces<'a> {
    scene: &'a Scene,
    owns: Box<dyn Fn(usize) -> bool + 'a>,
}

impl<'a> RowForces<'a> {
    /// The rows of this rank.
    pub fn new(session: &Session, scene: &'a Scene) -> Result<RowForces<'a>> {
        Ok(RowForces {
            scene,
            owns: Box::new(distribution::owner(session, scene)?),
        })
    }

    /// Calls `f` with the terms of every row with a force, tangential rows included, and with the force at each of
    /// them. In scalar problems the first component of a force is it.
    pub fn each(
        &self,
        solution: &Solution,
        mut f: impl FnMut(&SolvedRow, &RowTerms, BodyNode, [f64; 3]),
    ) {
        let rows = solution.rows().iter();
        let tangential = solution.tangential_rows().iter();
        let rows = rows.zip(self.scene.row_terms(&self.owns));
        let tangential = tangential.zip(self.scene.tangential_terms(&self.owns));
        for (row, all) in { rows.chain(tangential) }.filter(|(row, _)| row.multiplier != 0.0) {
            for &(at, coefficients) in &all.terms {
                f(row, &all, at, coefficients.map(|v| -row.multiplier * v));
            }
        }
    }
}
