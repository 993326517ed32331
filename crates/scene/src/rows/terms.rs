//! The terms of a row: all nodes that it joins with their coefficients, also those of given values. The forces of its
//! multiplier act there, each at its own node.

use super::equations::Equation;
use super::mortar_row::MortarRow;
use super::points::{InterfacePoint, PointRow};
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
    /// The terms of the rows of [`Scene::rows`], in their order. The force of a multiplier λ on a term is −λ times the
    /// coefficients.
    pub fn row_terms<'s>(
        &'s self,
        owns: &'s dyn Fn(usize) -> bool,
    ) -> impl Iterator<Item = RowTerms> + 's {
        let at_points = self.each_row(owns).map(|(p, row)| self.at_point(p, row));
        let equations = self.own_equations(owns);
        let equations = equations.map(|(_, e)| self.of_equation(e));
        let mortar = self.own_mortar(owns).map(|m| self.of_mortar(m));
        at_points.chain(equations).chain(mortar)
    }

    fn at_point(&self, point: &InterfacePoint, row: &PointRow) -> RowTerms {
        let along = self.components_of(row.direction);
        let members = row.members.into_iter().zip([1.0, -1.0]);
        let term =
            |(m, sign): (Option<usize>, f64)| Some((point.members[m?], along.map(|n| sign * n)));
        RowTerms {
            terms: members.filter_map(term).collect(),
            support: false,
        }
    }

    fn of_mortar(&self, row: &MortarRow) -> RowTerms {
        let along = self.components_of(row.direction);
        let sides = row.members.into_iter().zip(&row.weights).zip([1.0, -1.0]);
        let terms = sides.flat_map(|((member, weights), sign)| {
            let body = member.map(|m| m.body);
            weights.iter().filter_map(move |&(node, weight)| {
                let node = BodyNode { body: body?, node };
                Some((node, along.map(|n| sign * weight * n)))
            })
        });
        RowTerms {
            terms: terms.collect(),
            support: false,
        }
    }

    fn of_equation(&self, equation: &Equation) -> RowTerms {
        let all = equation.terms.iter().chain(&equation.held);
        let term = |&(of_body, factor): &(u64, f64)| {
            let after = self.bodies.partition_point(|b| b.first_dof <= of_body);
            let body = &self.bodies[after - 1];
            let dof = (of_body - body.first_dof) as usize;
            let mut coefficients = [0.0; 3];
            coefficients[dof % body.components] = factor;
            let node = dof / body.components;
            let body = after - 1;
            (BodyNode { body, node }, coefficients)
        };
        RowTerms {
            terms: all.map(term).collect(),
            support: equation.support,
        }
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
