//! The rows of B_gl for ties, contacts and obstacles, with their labels.

use super::areas::Areas;
use super::equations::Equation;
use super::mortar_row::MortarRow;
use super::points::{InterfacePoint, PointRow};
use super::rounding::Rounding;
use crate::checked::Scene;
use crate::model::steps::Factors;
use crate::rows::at_node::AtNode;
use base::Result;
use fetifeti::problem::{RowLabel, RowSource};
use fetifeti::Row;

/// An inequality, or an equation.
fn made(inequality: bool, terms: Vec<(u64, f64)>, right_hand_side: f64) -> Row {
    if inequality {
        Row::inequality(terms, right_hand_side)
    } else {
        Row::equality(terms, right_hand_side)
    }
}

impl Scene {
    /// The rows of B_gl at points whose lowest subdomain satisfies `owns`, with the right-hand sides of the last load
    /// step. There are rows u_a − u_b = 0 for every tied pair of bodies a < b, open rows at the candidate contact nodes
    /// of faces that are tied in part, rows u_a − u_b ≤ g in contact (a is the first body of the pair), and rows u ≤ g
    /// and −u ≤ −g beside obstacles. Given values are moved to the right-hand side.
    pub fn rows(&self, owns: &dyn Fn(usize) -> bool) -> Vec<Row> {
        let last = Factors::last(&self.steps);
        let mut areas = Areas::new(self);
        let rounding = Rounding::new(self);
        let row = |(point, row): (&InterfacePoint, &PointRow)| {
            let side = |m: usize| point.members[m].along(&self.bodies, row.direction).terms;
            let [a, b] = row.members.map(|m| m.map(side).unwrap_or_default());
            let minus = b.into_iter().map(|(dof, n)| (dof, -n));
            let terms: Vec<(u64, f64)> = a.into_iter().chain(minus).collect();
            let members = row.members.iter().flatten();
            made(row.inequality.is_some(), terms, row.right_hand_side(&last))
                .held(row.holds)
                .in_block(point.block)
                .with_rounding(rounding.of(members.map(|&m| point.members[m].body)))
                .with_label(self.label(point, row, &mut areas))
        };
        let equation = |(k, e): (usize, &Equation)| {
            Row::equality(e.terms.clone(), e.value - last.dirichlet() * e.given)
                .in_block(e.block)
                .with_rounding(rounding.of_equation(e))
                .with_label(RowLabel::new(RowSource::Equation(k), [None; 2]))
        };
        let mortar = |m: &MortarRow| {
            made(
                m.inequality.is_some(),
                m.terms.clone(),
                m.right_hand_side(&last),
            )
            .in_block(m.block)
            .with_rounding(rounding.of(m.members.iter().flatten().map(|member| member.body)))
            .with_label(self.mortar_label(m))
        };
        let mut out: Vec<Row> = self.each_row(owns).map(row).collect();
        out.extend(self.own_equations(owns).map(equation));
        out.extend(self.own_mortar(owns).map(mortar));
        out
    }

    /// The equations beside ties, with their numbers.
    pub(super) fn own_equations<'s>(
        &'s self,
        owns: &'s dyn Fn(usize) -> bool,
    ) -> impl Iterator<Item = (usize, &'s Equation)> {
        let all = self.equations.iter().enumerate();
        all.filter(move |(_, e)| owns(e.subdomain))
    }

    /// The rows between sides whose nodes do not match.
    pub(super) fn own_mortar<'s>(
        &'s self,
        owns: &'s dyn Fn(usize) -> bool,
    ) -> impl Iterator<Item = &'s MortarRow> {
        self.mortar.iter().filter(move |m| owns(m.subdomain))
    }

    /// The right-hand sides of the rows of [`Scene::rows`] at load step `step` (without `[steps]` the only step is 0).
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) for a step that the scene does not have.
    pub fn gaps(&self, owns: &dyn Fn(usize) -> bool, step: usize) -> Result<Vec<f64>> {
        let factors = Factors::of(&self.steps, step)?;
        let rows = self.each_row(owns);
        let mut out: Vec<f64> = rows.map(|(_, row)| row.right_hand_side(&factors)).collect();
        let equations = self.own_equations(owns);
        out.extend(equations.map(|(_, e)| e.value - factors.dirichlet() * e.given));
        out.extend(self.own_mortar(owns).map(|m| m.right_hand_side(&factors)));
        Ok(out)
    }

    /// Whether there is an inequality; the solver then runs an outer loop.
    pub fn has_contact(&self) -> bool {
        self.contact_elsewhere
            || self.mortar.iter().any(|m| m.inequality.is_some())
            || self
                .each_row(|_| true)
                .any(|(_, row)| row.inequality.is_some())
    }

    /// The rows in order: by point, pairs before obstacles.
    pub(crate) fn each_row(
        &self,
        owns: impl Fn(usize) -> bool,
    ) -> impl Iterator<Item = (&InterfacePoint, &PointRow)> {
        let points = self.points.iter().filter(move |p| owns(p.subdomain));
        points.flat_map(|point| point.rows.iter().map(move |row| (point, row)))
    }

    fn mortar_label(&self, row: &MortarRow) -> RowLabel {
        let carrier = row.members[self.carrier(row.source)];
        let carrier = carrier.expect("the node with the multiplier is a member");
        let area = if row.inequality.is_some() && self.has_pressure() {
            row.area
        } else {
            0.0
        };
        RowLabel::new(row.source, row.members)
            .at(carrier.position(&self.bodies), self.t(row.source, row.node))
            .along(row.direction, area)
    }

    /// The number of the member that carries the multiplier of rows from a source: the first, where nodes match.
    pub fn carrier(&self, source: RowSource) -> usize {
        let RowSource::Interface(k) = source else {
            return 0;
        };
        let interface = &self.interfaces[k];
        let own = interface.mortar.as_ref().map(|m| m.multipliers);
        usize::from(own.is_some_and(|own| own != interface.order[0]))
    }

    /// The parameters of a node of the interface or obstacle of a row.
    fn t(&self, source: RowSource, node: usize) -> [f64; 2] {
        match source {
            RowSource::Interface(k) => self.interfaces[k].shared[node].t,
            RowSource::Obstacle(k) => self.obstacles[k].t(node),
            RowSource::Equation(_) => [0.0; 2],
        }
    }

    fn label(&self, point: &InterfacePoint, row: &PointRow, areas: &mut Areas<'_>) -> RowLabel {
        let members = row.members.map(|m| m.map(|m| point.members[m]));
        let first = members[0].expect("every row has a first member");
        RowLabel::new(row.source, members)
            .at(first.position(&self.bodies), self.t(row.source, row.node))
            .along(row.direction, areas.at(row.source, first))
    }
}
