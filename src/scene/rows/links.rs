//! The links of one interface: what its nodes are after every entry has had its say.

use super::entry::{Contact, Entry};
use super::select::{is_end, selected, Parameters};
use crate::error::{Error, Result};
use crate::scene::body::Body;
use crate::scene::geometry::interface::{Interface, Link};
use crate::scene::model::expr::Variables;
use crate::scene::model::profile::{Limit, Limits};
use crate::scene::model::spec::Extent;
use crate::scene::model::steps::Factors;
use std::collections::HashMap;

/// The links of one interface as entry after entry sets them.
pub(crate) struct Links<'i, 'b, 'e> {
    bodies: &'b [Body],
    interface: &'i mut Interface,
    /// Entries that spoke of the pair.
    pub entries: usize,
    /// The entry that ties each node that is tied.
    tied: HashMap<usize, Entry<'e>>,
    limits: Vec<Limit>,
    /// The first contact and its order.
    ordered: Option<(Entry<'e>, [usize; 2])>,
}

impl<'i, 'b, 'e> Links<'i, 'b, 'e> {
    pub fn new(bodies: &'b [Body], interface: &'i mut Interface) -> Self {
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

    /// Adds what `entry` says and returns how many nodes it selects; `order`: the bodies as it names them.
    pub fn add(&mut self, entry: Entry<'e>, order: Option<[usize; 2]>) -> Result<usize> {
        self.entries += 1;
        let nodes = selected(self.bodies, self.interface, &entry)?;
        let Some(contact) = entry.contact else {
            if *entry.extent != Extent::None {
                // Of a face that is tied in part, the rest is a candidate for contact: [Lee]'s Γ_gl around his Γ_gl^k.
                let shared = self.interface.shared.iter_mut();
                for node in shared.filter(|s| s.link == Link::Free) {
                    node.link = Link::Open;
                }
            }
            for &k in &nodes {
                self.interface.shared[k].link = Link::Tied;
                // Where two ties share a node, the end of both ranges is the weaker claim.
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
                    // Two ranges side by side: their common end is tied.
                    continue;
                }
                let [a, b] = self.names();
                return Err(Error::Input(format!(
                    "{}the contact of bodies `{a}` and `{b}` selects the node at t = {}, which the tie of {} selects too \
                     (ranges that share no more than their ends were expected)",
                    entry.written,
                    Parameters(t),
                    tie.line()
                )));
            }
            let value = self.gap(&entry, contact, k)?;
            self.limits.push(Limit {
                node: k,
                value,
                entry: contact.number,
            });
        }
        Ok(nodes.len())
    }

    /// All contacts of a pair must name it in the same order: the order is that of the inequality.
    fn put_in_order(&mut self, entry: Entry<'e>, order: Option<[usize; 2]>) -> Result<()> {
        let order = order.unwrap_or(self.interface.bodies);
        match &self.ordered {
            None => self.ordered = Some((entry, order)),
            Some((other, known)) if *known != order => {
                let [a, b] = order.map(|k| &self.bodies[k].spec.name);
                return Err(Error::Input(format!(
                    "{}the contact names bodies `{a}` and `{b}` in the other order than the contact of {} \
                     (the second body lies above the first, one order for a pair was expected)",
                    entry.written,
                    other.line()
                )));
            }
            Some(_) => {}
        }
        if order != self.interface.bodies {
            self.interface.order = [1, 0];
        }
        Ok(())
    }

    fn gap(&self, entry: &Entry<'_>, contact: Contact<'_>, k: usize) -> Result<f64> {
        let Interface {
            bodies,
            shared,
            order,
            ..
        } = &*self.interface;
        let node = shared[k];
        let body = &self.bodies[bodies[order[0]]];
        let place = body.mesh().place(node.nodes[order[0]]);
        let at = Variables {
            point: body.spec.position(place),
            body: body.spec.place,
            subdomain: [0; 3],
        };
        let value = contact.gap.eval(node.t[0], &at);
        if value.is_finite() {
            return Ok(value);
        }
        let ([a, b], at) = (self.names(), body.spec.spot(place));
        Err(Error::Input(format!(
            "{}the gap of bodies `{a}` and `{b}` is {value} at {at} where a finite number was expected",
            entry.written
        )))
    }

    /// Marks the nodes in contact.
    pub fn finish(self, last: Factors<'_>) -> Result<()> {
        self.interface.limits = Limits::new(self.limits);
        let Interface { limits, shared, .. } = self.interface;
        for same in limits.all().chunk_by(|a, b| a.node == b.node) {
            if let Some((gap, _)) = last.tightest(same) {
                shared[same[0].node].link = Link::Contact { gap };
            }
        }
        Ok(())
    }
}
