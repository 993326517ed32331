//! A row of many terms between two sides, or between a side and a rigid surface.

use super::points::Inequality;
use crate::model::steps::Factors;
use fetifeti::problem::{BodyNode, RowSource};

/// A row between two sides: Σ coefficient · u = 0 (tie) or ≤ g (contact), along a direction. The second side may be a
/// rigid surface.
#[derive(Debug, Clone, PartialEq)]
pub struct MortarRow {
    /// The interface or obstacle.
    pub source: RowSource,
    /// Index into the `shared` of that interface, or the node of the body beside the obstacle.
    pub node: usize,
    /// The node with the multiplier and the nearest one of the other side, in the order of the inequality; beside an
    /// obstacle the node alone.
    pub members: [Option<BodyNode>; 2],
    /// The unit vector along which u is taken: a component, or the normal out of the first body of the inequality.
    pub direction: [f64; 3],
    /// (body dof, coefficient) of the free degrees of freedom.
    pub terms: Vec<(u64, f64)>,
    /// Σ coefficient · u of the given values, without the factors of load steps.
    pub given: f64,
    /// The data of an inequality; `None`: an equality.
    pub inequality: Option<Box<Inequality>>,
    /// D_p: a multiplier divided by it is a pressure.
    pub area: f64,
    /// The mean of u over nodes of each side that the row compares, in the order of `members`: node and weight.
    pub weights: [Vec<(usize, f64)>; 2],
    /// Its block: rows with a degree of freedom in common have the same.
    pub block: u64,
    /// The subdomain of lowest index that has a degree of freedom of the block.
    pub subdomain: usize,
}

impl MortarRow {
    /// Whether it comes from an obstacle.
    pub fn is_beside_obstacle(&self) -> bool {
        matches!(self.source, RowSource::Obstacle(_))
    }

    /// The right-hand side c at a load step.
    pub(crate) fn right_hand_side(&self, factors: &Factors<'_>) -> f64 {
        match &self.inequality {
            None => 0.0 - self.given * factors.dirichlet(),
            Some(inequality) => inequality.right_hand_side(factors, self.members[1].is_some()),
        }
    }
}
