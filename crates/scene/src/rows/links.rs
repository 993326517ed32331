//! The links of one interface: the state of its nodes after all entries.

use super::entry::{both, Entry};
use super::select::{is_end, selected, Parameters};
use crate::body::Body;
use crate::geometry::interface::{BodyInterface, Link};
use crate::model::joints::Extent;
use crate::model::profile::{Limit, Limits, Profile};
use crate::model::steps::Factors;
use crate::quantity::unfit_length;
use base::{Error, Result};
use std::collections::HashMap;

/// The links of one interface while entries are added.
pub(crate) struct Links<'i, 'b, 'e> {
    bodies: &'b [Body],
    interface: &'i mut BodyInterface,
    /// Number of entries that apply to the pair.
    pub entries: usize,
    /// The entry that ties each tied node.
    tied: HashMap<usize, Entry<'e>>,
    limits: Vec<Limit>,
    /// The first contact and its order.
    ordered: Option<(Entry<'e>, [usize; 2])>,
}

impl<'i, 'b, 'e> Links<'i, 'b, 'e> {
    pub fn new(bodies: &'b [Body], interface: &'i mut BodyInterface) -> Self {
        Links {
            bodies,
            interface,
            entries: 0,
            tied: HashMap::new(),
            limits: Vec::new(),
            ordered: None,
        }
    }

    pub fn names(&self) -> [&'b str; 2] {
        self.interface
            .bodies
            .map(|k| self.bodies[k].spec.name.as_str())
    }

    /// Adds the links of `entry` and returns the number of nodes that it selects; `order` has the bodies in its order.
    pub fn add(&mut self, entry: Entry<'e>, order: Option<[usize; 2]>) -> Result<usize> {
        self.entries += 1;
        let nodes = selected(self.bodies, self.interface, &entry)?;
        let Some(gap) = entry.gap else {
            if *entry.extent != Extent::None {
                // The rest of a face that is tied in part is a candidate for contact: [Lee]'s Γ_gl around his Γ_gl^k.
                let shared = self.interface.shared.iter_mut();
                for node in shared.filter(|s| s.link == Link::Free) {
                    node.link = Link::Open;
                }
            }
            for &k in &nodes {
                self.interface.shared[k].link = Link::Tied;
                // If two ties share a node, the one for which it is an end of the range yields to the other.
                let t = self.interface.shared[k].t;
                let place = self.tied.entry(k).or_insert(entry);
                if is_end(place.extent, t) {
                    *place = entry;
                }
            }
            return Ok(nodes.len());
        };
        self.put_in_order(entry, order)?;
        for &k in &nodes {
            let t = self.interface.shared[k].t;
            if let Some(tie) = self.tied.get(&k) {
                if is_end(tie.extent, t) && is_end(entry.extent, t) {
                    // The ranges are adjacent: their common end stays tied.
                    continue;
                }
                let [a, b] = self.names();
                return Err(Error::input(format!(
                    "the contact of {} selects the node at t = {}, \
                     which {} selects too \
                     (ranges that share no more than their ends were expected)",
                    both(a, b),
                    Parameters(t),
                    tie.named()
                ))
                .at(entry.location));
            }
            let value = self.gap(&entry, gap, k)?;
            self.limits.push(Limit {
                node: k,
                value,
                entry: entry.id,
            });
        }
        Ok(nodes.len())
    }

    /// Checks that all contacts of a pair name it in the same order, which is the order of the inequality.
    fn put_in_order(&mut self, entry: Entry<'e>, order: Option<[usize; 2]>) -> Result<()> {
        let order = order.unwrap_or(self.interface.bodies);
        match &self.ordered {
            None => self.ordered = Some((entry, order)),
            Some((other, known)) if *known != order => {
                let [a, b] = order.map(|k| &self.bodies[k].spec.name);
                return Err(Error::input(format!(
                    "the contact names bodies `{a}` and `{b}` in the other order than {} (the second \
                     body lies above the first, one order for a pair was expected)",
                    other.named()
                ))
                .at(entry.location));
            }
            Some(_) => {}
        }
        if order != self.interface.bodies {
            self.interface.order = [1, 0];
        }
        Ok(())
    }

    fn gap(&self, entry: &Entry<'_>, gap: &Profile, k: usize) -> Result<f64> {
        let BodyInterface {
            bodies,
            shared,
            order,
            ..
        } = &*self.interface;
        let node = shared[k];
        let body = &self.bodies[bodies[order[0]]];
        let at = node.nodes[order[0]];
        let value = gap.eval(node.t[0], &body.spec.variables(at));
        let Some(expected) = unfit_length(value) else {
            return Ok(value);
        };
        let ([a, b], at) = (self.names(), body.spec.spot(at));
        Err(Error::input(format!(
            "the gap of {} is {value:e} at {at} where {expected}",
            both(a, b)
        ))
        .at(entry.location))
    }

    /// Marks the nodes in contact.
    pub fn finish(self, last: Factors<'_>) -> Result<()> {
        self.interface.limits = Limits::new(self.limits);
        let BodyInterface { limits, shared, .. } = self.interface;
        for same in limits.all().chunk_by(|a, b| a.node == b.node) {
            if let Some((gap, _)) = last.tightest(same) {
                shared[same[0].node].link = Link::Contact { gap };
            }
        }
        Ok(())
    }
}
