//! The laws of the nodes of a scene, as the problem of the method has them.

use super::areas::Areas;
use super::at_node::AtNode;
use super::laws::{NodeFriction, NodeLaw};
use super::row::Row;
use crate::checked::Scene;
use base::{Error, Result};
use fetifeti::problem::FrictionNode;
use std::collections::BTreeMap;

impl Scene {
    /// Whether it has friction here.
    pub fn has_friction(&self) -> bool {
        self.laws.iter().any(|law| law.friction.is_some())
    }

    /// Whether it has friction or soft contact here.
    pub fn has_laws(&self) -> bool {
        !self.laws.is_empty()
    }

    /// The laws of nodes whose rows the owner of some subdomains provides.
    fn laws_of<'s>(
        &'s self,
        owns: &'s dyn Fn(usize) -> bool,
    ) -> impl Iterator<Item = &'s NodeLaw> + 's {
        let owned = move |law: &&NodeLaw| owns(self.rows[law.normal].subdomain);
        self.laws.iter().filter(owned)
    }

    /// The nodes with friction whose rows the owner of some subdomains provides, with their normal rows.
    pub(crate) fn friction_of<'s>(
        &'s self,
        owns: &'s dyn Fn(usize) -> bool,
    ) -> impl Iterator<Item = (usize, &'s NodeFriction)> + 's {
        let laws = self.laws_of(owns);
        laws.filter_map(|law| Some((law.normal, law.friction.as_ref()?)))
    }

    /// The area to which the stresses at a row in contact belong; 0 where there are none.
    pub(super) fn area(&self, row: &Row, areas: &mut Areas<'_>) -> f64 {
        match &row.combination {
            Some(c) if row.law.is_decided() && self.has_pressure() => c.area,
            Some(_) => 0.0,
            None => {
                let carrier = row.members[self.carrier(row.source)];
                carrier.map_or(0.0, |c| areas.at(row.source, c))
            }
        }
    }

    /// Gives the rows of [`Scene::solver_rows`] their compliances.
    pub(super) fn soften(&self, owns: &dyn Fn(usize) -> bool, rows: &mut [fetifeti::Row]) {
        if self.laws.is_empty() {
            return;
        }
        let mut areas = Areas::new(self);
        let place = self.places(owns);
        let mut next = place.len();
        for law in self.laws_of(owns) {
            let area = self.area(&self.rows[law.normal], &mut areas);
            rows[place[&law.normal]].compliance = law.compliance(area);
            let Some(friction) = &law.friction else {
                continue;
            };
            for row in &mut rows[next..next + friction.tangential.len()] {
                row.compliance = friction.compliance(area);
            }
            next += friction.tangential.len();
        }
    }

    /// Whether all nodes whose law needs an area have one.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) for a node that has none.
    pub(crate) fn check_areas(&self, owns: &dyn Fn(usize) -> bool) -> Result<()> {
        let mut areas = Areas::new(self);
        for law in self.laws_of(owns).filter(|law| law.needs_area()) {
            let row = &self.rows[law.normal];
            if self.area(row, &mut areas) > 0.0 {
                continue;
            }
            let node = row.members[0].expect("a contact has a first node");
            let body = &self.bodies[node.body].spec;
            return Err(Error::input(format!(
                "the soft contact of body `{}` has no area at {}, expected faces there that lie in the contact as a \
                 whole",
                body.name,
                node.spot(&self.bodies)
            ))
            .at(&body.location));
        }
        Ok(())
    }

    /// The places of the rows of some subdomains among [`Scene::solver_rows`].
    fn places(&self, owns: &dyn Fn(usize) -> bool) -> BTreeMap<usize, usize> {
        let rows = self.rows.iter().enumerate();
        let mine = rows.filter(|(_, row)| owns(row.subdomain)).map(|(k, _)| k);
        mine.enumerate().map(|(at, k)| (k, at)).collect()
    }

    /// Friction at the nodes of the rows that the owner of some subdomains provides, in terms of their places among
    /// [`Scene::solver_rows`].
    pub fn friction_nodes(&self, owns: &dyn Fn(usize) -> bool) -> Vec<FrictionNode> {
        let mut areas = Areas::new(self);
        let place = self.places(owns);
        let mut next = place.len();
        let node = |(normal, friction): (usize, &NodeFriction)| {
            let tangential = next..next + friction.tangential.len();
            next = tangential.end;
            let bound = friction.bound(self.area(&self.rows[normal], &mut areas));
            FrictionNode::new(place[&normal], tangential.collect(), bound)
        };
        self.friction_of(owns).map(node).collect()
    }
}
