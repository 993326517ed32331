//! The nodes with friction of a scene, as the problem of the method has them.

use super::areas::Areas;
use super::friction::NodeFriction;
use crate::checked::Scene;
use fetifeti::problem::FrictionNode;
use std::collections::BTreeMap;

impl Scene {
    /// Whether it has friction here.
    pub fn has_friction(&self) -> bool {
        !self.friction.is_empty()
    }

    /// The nodes with friction whose rows the owner of some subdomains provides.
    pub(crate) fn friction_of<'s>(
        &'s self,
        owns: &'s dyn Fn(usize) -> bool,
    ) -> impl Iterator<Item = &'s NodeFriction> + 's {
        let owned = move |f: &&NodeFriction| owns(self.rows[f.normal].subdomain);
        self.friction.iter().filter(owned)
    }

    /// Friction at the nodes of the rows that the owner of some subdomains provides, in terms of their places among
    /// [`Scene::solver_rows`].
    pub fn friction_nodes(&self, owns: &dyn Fn(usize) -> bool) -> Vec<FrictionNode> {
        let mut areas = Areas::new(self);
        let rows = self.rows.iter().enumerate();
        let mine = rows.filter(|(_, row)| owns(row.subdomain)).map(|(k, _)| k);
        let place: BTreeMap<usize, usize> = mine.enumerate().map(|(at, k)| (k, at)).collect();
        let mut next = place.len();
        let node = |f: &NodeFriction| {
            let row = &self.rows[f.normal];
            let carrier = row.members[self.carrier(row.source)];
            let area = carrier.map_or(0.0, |c| areas.at(row.source, c));
            let tangential = next..next + f.tangential.len();
            next = tangential.end;
            FrictionNode::new(place[&f.normal], tangential.collect(), f.bound(area))
        };
        self.friction_of(owns).map(node).collect()
    }
}
