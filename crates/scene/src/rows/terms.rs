//! The terms of a row: all nodes that it joins with their coefficients, also those of given values. The forces of its
//! multiplier act there, each at its own node.

use super::row::Row;
use crate::checked::Scene;
use fetifeti::problem::BodyNode;

/// A node of a body, with the coefficients of its displacement by component.
pub type RowTerm = (BodyNode, [f64; 3]);

/// All terms of a row. A body may have several at one node.
#[derive(Debug, Clone, PartialEq)]
pub struct RowTerms {
    /// The terms.
    pub terms: Vec<RowTerm>,
    /// Whether it is a given displacement along an oblique axis: its forces are reactions.
    pub support: bool,
}

impl Scene {
    /// The terms of the rows of [`Scene::solver_rows`] but the tangential ones, in their order. The force of a
    /// multiplier λ on a term is −λ times the coefficients.
    pub fn row_terms<'s>(
        &'s self,
        owns: &'s dyn Fn(usize) -> bool,
    ) -> impl Iterator<Item = RowTerms> + 's {
        self.rows_of(owns).map(|row| self.all_terms(row))
    }

    /// The terms of the tangential rows of [`Scene::solver_rows`], in their order.
    pub fn tangential_terms<'s>(
        &'s self,
        owns: &'s dyn Fn(usize) -> bool,
    ) -> impl Iterator<Item = RowTerms> + 's {
        let rows = self.friction_of(owns).flat_map(|f| &f.1.tangential);
        rows.map(|row| self.all_terms(row))
    }

    fn all_terms(&self, row: &Row) -> RowTerms {
        let along = self.components_of(row.direction);
        let mut terms: Vec<RowTerm> = Vec::new();
        for (side, sign) in [(0, 1.0), (1, -1.0)] {
            let nodes = row.side(side);
            terms.extend(nodes.map(|(node, weight)| (node, along.map(|n| sign * weight * n))));
        }
        let combination = row.combination.as_ref();
        // An equation has no sides.
        if let Some(all) = combination.filter(|_| row.members[0].is_none()) {
            terms.extend(all.terms.iter().chain(&all.held).map(|t| self.at_dof(*t)));
        }
        RowTerms {
            terms,
            support: combination.is_some_and(|c| c.support),
        }
    }

    fn at_dof(&self, (of_body, factor): (u64, f64)) -> RowTerm {
        let after = self.bodies.partition_point(|b| b.first_dof <= of_body);
        let body = &self.bodies[after - 1];
        let dof = (of_body - body.first_dof) as usize;
        let mut coefficients = [0.0; 3];
        coefficients[dof % body.components] = factor;
        let node = dof / body.components;
        let body = after - 1;
        (BodyNode { body, node }, coefficients)
    }

    /// A direction without the components that the scene does not have.
    fn components_of(&self, direction: [f64; 3]) -> [f64; 3] {
        let c = self.components();
        std::array::from_fn(|d| if d < c { direction[d] } else { 0.0 })
    }
}

#[cfg(test)]
#[path = "../../tests/rows/terms.rs"]
mod tests;
