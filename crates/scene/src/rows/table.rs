//! The rows of B_gl for ties, contacts and obstacles, with their labels.

use super::areas::Areas;
use super::rounding::Rounding;
use super::row::Row;
use crate::checked::Scene;
use crate::model::entry::EntryId;
use crate::model::steps::Factors;
use crate::rows::at_node::AtNode;
use base::Result;
use fetifeti::problem::{RowLabel, RowSource};

impl Scene {
    /// The rows of B_gl at points whose lowest subdomain satisfies `owns`, with the right-hand sides of the last load
    /// step. There are rows u_a − u_b = 0 for every tied pair of bodies a < b, open rows at the candidate contact nodes
    /// of faces that are tied in part, rows u_a − u_b ≤ g in contact (a is the first body of the pair), and rows u ≤ g
    /// and −u ≤ −g beside obstacles; then the tangential rows of nodes with friction. Given values are moved to the
    /// right-hand side.
    pub fn solver_rows(&self, owns: &dyn Fn(usize) -> bool) -> Vec<fetifeti::Row> {
        let last = Factors::last(&self.steps);
        let mut areas = Areas::new(self);
        let rounding = Rounding::new(self);
        let joined = |row: &Row| {
            let (terms, c) = (row.terms(&self.bodies), row.right_hand_side(&last));
            let mut out = fetifeti::Row::equality(terms, c)
                .held(row.holds)
                .in_block(row.block)
                .with_rounding(rounding.of(row))
                .with_label(self.label(row, &mut areas));
            out.law = row.law;
            out
        };
        let mut out: Vec<fetifeti::Row> = Vec::new();
        let tangential = self.friction_of(owns).flat_map(|f| &f.1.tangential);
        out.extend(self.rows_of(owns).chain(tangential).map(joined));
        if let Ok(drags) = self.drags(owns, self.n_steps() - 1) {
            out.iter_mut().zip(drags).for_each(|(row, d)| row.gap += d);
        }
        self.soften(owns, &mut out);
        out
    }

    /// The rows that the owner of some subdomains provides, in their order.
    pub(crate) fn rows_of(&self, owns: impl Fn(usize) -> bool) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(move |row| owns(row.subdomain))
    }

    /// The rows that compare means over nodes, as where the nodes of two sides do not match.
    pub fn mortar_rows(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(|row| row.is_mortar())
    }

    /// The right-hand sides of the rows of [`Scene::solver_rows`] at load step `step` (without `[steps]` the only step
    /// is 0).
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) for a step that the scene does not have.
    pub fn gaps(&self, owns: &dyn Fn(usize) -> bool, step: usize) -> Result<Vec<f64>> {
        let factors = self.last_two(step)?;
        let rows = self.rows_of(owns);
        let mut out: Vec<f64> = rows.map(|row| row.right_hand_side(&factors.1)).collect();
        for (normal, friction) in self.friction_of(owns) {
            let drags = friction.drags(&factors, self.entry_of(normal));
            let rows = friction.tangential.iter().zip(drags);
            out.extend(rows.map(|(row, drag)| row.right_hand_side(&factors.1) + drag));
        }
        Ok(out)
    }

    /// How far obstacles drag the nodes of the rows of [`Scene::solver_rows`] at load step `step`, since the step
    /// before: along tangential rows.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) for a step that the scene does not have.
    pub fn drags(&self, owns: &dyn Fn(usize) -> bool, step: usize) -> Result<Vec<f64>> {
        let factors = self.last_two(step)?;
        let mut out = vec![0.0; self.rows_of(owns).count()];
        for (normal, friction) in self.friction_of(owns) {
            out.extend(friction.drags(&factors, self.entry_of(normal)));
        }
        Ok(out)
    }

    /// The factors of the load step before a step, and of the step.
    fn last_two(&self, step: usize) -> Result<(Option<Factors<'_>>, Factors<'_>)> {
        let before = step.checked_sub(1);
        let before = before.map(|s| Factors::of(&self.steps, s)).transpose()?;
        Ok((before, Factors::of(&self.steps, step)?))
    }

    /// The entry of a row in contact.
    fn entry_of(&self, row: usize) -> Option<EntryId> {
        let limit = self.rows[row].limits().first();
        limit.and_then(|l| l.entry)
    }

    /// Whether there is an inequality; the solver then runs an outer loop.
    pub fn has_contact(&self) -> bool {
        self.contact_elsewhere || self.rows.iter().any(|row| row.law.is_inequality())
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

    fn label(&self, row: &Row, areas: &mut Areas<'_>) -> RowLabel {
        let label = RowLabel::new(row.source, row.members);
        let Some(carrier) = row.members[self.carrier(row.source)] else {
            return label;
        };
        let area = self.area(row, areas);
        label
            .at(carrier.position(&self.bodies), self.t(row.source, row.node))
            .along(row.direction, area)
    }
}
