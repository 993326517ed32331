//! The forces of solved rows on the nodes that they join.

use base::Result;
use fetifeti::problem::BodyNode;
use fetifeti::solution::SolvedRow;
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

    /// Calls `f` with the terms of every row that holds, and with the force at each of them. `rows` are those of the
    /// solution, which are in the order of the scene's. In scalar problems the first component of a force is it.
    pub fn each(
        &self,
        rows: &[SolvedRow],
        mut f: impl FnMut(&SolvedRow, &RowTerms, BodyNode, [f64; 3]),
    ) {
        let terms = self.scene.row_terms(&self.owns);
        for (row, all) in rows
            .iter()
            .zip(terms)
            .filter(|(row, _)| row.multiplier != 0.0)
        {
            for &(at, coefficients) in &all.terms {
                f(row, &all, at, coefficients.map(|v| -row.multiplier * v));
            }
        }
    }
}
