//! A row of a scene: its law, what it joins, and its right-hand side at every load step.
//!
//! Pairs of nodes ([`points`](super::points)), nodes beside obstacles ([`bounds`](super::bounds)), sides whose nodes do
//! not match ([`mortar`](super::mortar)), rigid surfaces ([`facing_surfaces`](super::facing_surfaces)) and equations
//! ([`equations`](super::equations)) make rows. Whatever comes after reads rows alone, and does not ask who made them.

use std::borrow::Cow;

use super::at_node::AtNode;
use crate::body::Body;
use crate::model::profile::Limit;
use crate::model::steps::Factors;
use fetifeti::problem::{BodyNode, Law, RowSource};

/// A row Σ coefficient · u = c (tie) or ≤ c (contact), along a direction.
///
/// Nearly all rows of a scene of many bodies join one node with another, or with an obstacle. They are small (136
/// bytes): their terms follow from their members, and are computed when they are asked for ([`Row::terms`]), which is
/// once for the rows of a rank. Those of two nodes in space would take as much again. What only some rows have lies in
/// boxes.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Which multipliers it may have.
    pub law: Law,
    /// Whether it holds initially. A tie that does not hold marks candidate contact nodes; of two bounds at one node
    /// only the lower one can hold.
    pub holds: bool,
    /// The interface, obstacle or equation that it comes from.
    pub source: RowSource,
    /// Index into the `shared` of that interface, or the node of the body beside the obstacle.
    pub node: usize,
    /// Its nodes in the order of the inequality; of a tie the lower body first. Beside an obstacle there is one, and in
    /// an equation none. Where nodes do not match they are the one with the multiplier and the nearest opposite it.
    pub members: [Option<BodyNode>; 2],
    /// The unit vector along which u is taken: a component, or the normal out of the first body.
    pub direction: [f64; 3],
    /// Its block: rows with a degree of freedom in common have the same.
    pub block: u64,
    /// The subdomain of lowest index that has a degree of freedom of the block; the rank that owns it provides the row.
    pub subdomain: usize,
    /// Its right-hand side; `None`: 0.
    pub bound: Option<Box<Bound>>,
    /// Its terms; `None`: those of its members.
    pub combination: Option<Box<Combination>>,
}

/// The right-hand side of a row: of an inequality the tightest of its limits and the initial distance, of an equation
/// its value, in both less the given values.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Bound {
    /// The limits of all entries that select the node; none of an equation.
    pub limits: Vec<Limit>,
    /// The initial distance, or the value of an equation.
    pub value: f64,
    /// The given values of u along the direction on both sides, without the factors of load steps. An equation has one.
    pub given: [f64; 2],
}

/// The terms of a row that joins other nodes than its members.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Combination {
    /// (body dof, coefficient) of the free degrees of freedom.
    pub terms: Vec<(u64, f64)>,
    /// (body dof, coefficient) of those that are given, in an equation.
    pub held: Vec<(u64, f64)>,
    /// The mean of u over nodes of each side that the row compares, in the order of the members: node and weight. An
    /// equation compares none.
    pub weights: [Vec<(usize, f64)>; 2],
    /// D_p: a multiplier divided by it is a pressure.
    pub area: f64,
    /// One unit in the last digit of the coefficients; 0 where they are exact.
    pub resolution: f64,
    /// Whether it is a given displacement along an oblique axis: its forces are reactions.
    pub support: bool,
}

impl Row {
    /// The tie u = 0 of its members along a direction, which holds, in a block that a subdomain provides.
    pub(super) fn tie(
        source: RowSource,
        node: usize,
        members: [Option<BodyNode>; 2],
        direction: [f64; 3],
        (block, subdomain): (u64, usize),
    ) -> Row {
        Row {
            law: Law::Tie,
            holds: true,
            source,
            node,
            members,
            direction,
            block,
            subdomain,
            bound: None,
            combination: None,
        }
    }

    /// This row in contact: here, and nowhere else, a row gets the law of contacts and obstacles.
    pub(super) fn in_contact(self, bound: Bound) -> Row {
        Row {
            law: Law::Unilateral,
            bound: Some(Box::new(bound)),
            ..self
        }
    }

    /// This tie with the right-hand side `value`, of which the given values are taken.
    pub(super) fn equal_to(self, value: f64, given: [f64; 2]) -> Row {
        let bound = Bound {
            limits: Vec::new(),
            value,
            given,
        };
        Row {
            bound: Some(Box::new(bound)),
            ..self
        }
    }

    /// This row between other nodes than its members.
    pub(super) fn with_terms(self, combination: Combination) -> Row {
        Row {
            combination: Some(Box::new(combination)),
            ..self
        }
    }

    /// Whether it comes from an obstacle.
    pub fn is_beside_obstacle(&self) -> bool {
        matches!(self.source, RowSource::Obstacle(_))
    }

    /// Whether it compares means over nodes, as where the nodes of two sides do not match.
    pub fn is_mortar(&self) -> bool {
        self.combination.is_some() && self.members[0].is_some()
    }

    /// (body dof, coefficient) of the free degrees of freedom.
    pub fn terms(&self, bodies: &[Body]) -> Cow<'_, [(u64, f64)]> {
        if let Some(combination) = &self.combination {
            return Cow::Borrowed(&combination.terms);
        }
        let mut out = Vec::new();
        for (member, sign) in self.members.into_iter().zip([1.0, -1.0]) {
            let Some(member) = member else { continue };
            let along = member.along(bodies, self.direction);
            out.extend(along.terms.into_iter().map(|(dof, n)| (dof, sign * n)));
        }
        Cow::Owned(out)
    }

    /// The nodes on a side, each with its weight in the mean that the row compares.
    pub fn side(&self, side: usize) -> impl Iterator<Item = (BodyNode, f64)> + '_ {
        let member = self.members[side];
        let means = self.combination.as_ref().map(|c| &c.weights[side]);
        let alone = member.filter(|_| means.is_none());
        let of_mean = member.zip(means).into_iter().flat_map(|(member, means)| {
            let body = member.body;
            let nodes = means.iter();
            nodes.map(move |&(node, weight)| (BodyNode { body, node }, weight))
        });
        alone.map(|node| (node, 1.0)).into_iter().chain(of_mean)
    }

    /// The limits of an inequality.
    pub fn limits(&self) -> &[Limit] {
        self.bound.as_ref().map_or(&[], |b| &b.limits)
    }

    /// The right-hand side c at a load step.
    pub(crate) fn right_hand_side(&self, factors: &Factors<'_>) -> f64 {
        let Some(bound) = &self.bound else {
            return 0.0;
        };
        let [a, b] = bound.given;
        if !self.law.is_inequality() {
            return bound.value - (a - b) * factors.dirichlet();
        }
        // The row is u_a ≤ g + u_b, or −u_b ≤ g − u_a.
        let mut g = bound.gap(factors) - a * factors.dirichlet();
        if self.members[1].is_some() {
            g += b * factors.dirichlet();
        }
        g
    }
}

impl Bound {
    /// The gap of an inequality at a load step, whatever u is given.
    pub(crate) fn gap(&self, factors: &Factors<'_>) -> f64 {
        factors.bound(&self.limits).0 + self.value
    }
}
