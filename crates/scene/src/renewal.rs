//! Contacts that are renewed at each load step: normals, pairing and gaps where the last step has left the bodies.
//!
//! With the displacements u₀ of the last step and the normals n, the pairing and the distance d of the bodies there,
//! the next step asks for n·(Δu_1 − Δu_2) ≤ d, and as rows are about the displacements u = u₀ + Δu from the undeformed
//! bodies,
//!
//! ```text
//!     n·(u_1 − u_2) ≤ d + n·(u₀_1 − u₀_2) = n·(X_2 − X_1)
//! ```
//!
//! with the undeformed positions X. Ties keep the pairing that they have. An obstacle that moves by m f(t) is looked at
//! where the last step has left it; its rows have X_2 where it was given, and m f at the end of the step besides. What
//! `adjust` closes at the start is kept as a way of the node: it adds the part along the present normal to the gap.

use std::collections::HashMap;

use super::body::Body;
use super::geometry::interface::{BodyInterface, InterfaceShape, Link};
use super::geometry::matching::NodeMatching;
use super::geometry::mortar::is_for_contact;
use super::model::entry::EntryId;
use super::model::joints::{ContactSpec, Extent, PairSelector};
use super::model::profile::Profile;
use super::model::spec::SceneSpec;
use super::model::steps::{Factors, Steps};
use super::rows::all::{Joined, SceneRows};
use super::rows::obstacles::{Adjusted, Obstacle, Standing};
use super::rows::row::Row;
use super::rows::{entries, obstacles, surfaces};
use base::linalg::vec3::dot;
use base::{Error, Result};
use elements::form::Form;
use fetifeti::problem::{BodyNode, RowSource};

/// The data from which contacts are renewed.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Renewal {
    /// The scene without its bodies, before surfaces in it were replaced by bodies and sides.
    written: SceneSpec,
    /// The interfaces that stay as they are: ties, faces that are tied in part, corners.
    kept: Vec<BodyInterface>,
    /// Their rows, where nodes do not match.
    rows: Vec<Row>,
    /// The sides of bodies that touched to begin with, and which of them carries multipliers.
    touching: Vec<([usize; 2], [usize; 2], usize)>,
    /// The adjustments that `adjust` made to begin with: the way from a node that carries a multiplier, by the other
    /// body and the node, to the place at which it would touch; and, in `beside`, the same beside obstacles.
    adjusted: HashMap<(usize, BodyNode), [f64; 3]>,
    beside: Adjusted,
}

impl Renewal {
    /// The data from which the contacts of a scene are renewed; `spec` has bodies and sides in place of surfaces.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) for contacts that cannot be renewed.
    pub fn new(
        written: SceneSpec,
        spec: &SceneSpec,
        bodies: &[Body],
        interfaces: &[BodyInterface],
        obstacles: &[Obstacle],
        rows: &[Row],
    ) -> Result<Renewal> {
        check(spec)?;
        let mut out = Renewal {
            written,
            kept: Vec::new(),
            rows: Vec::new(),
            touching: Vec::new(),
            adjusted: HashMap::new(),
            beside: obstacles::adjusted(obstacles),
        };
        let mut place = vec![None; interfaces.len()];
        for (k, interface) in interfaces.iter().enumerate() {
            if !is_renewed(interface) {
                place[k] = Some(out.kept.len());
                out.kept.push(interface.clone());
            } else if interface.entry.is_none() {
                let mortar = interface.mortar.as_ref().map(|m| m.multipliers);
                let which = mortar.or_else(|| carrier(spec, bodies, interface.bodies));
                let both = (interface.bodies, interface.sides);
                out.touching.push((both.0, both.1, which.unwrap_or(0)));
            } else if let Some(own) = of_entry(spec, bodies, interface) {
                let other = interface.bodies[1 - own];
                out.adjusted
                    .extend(interface.adjusted.iter().map(|(&i, &by)| {
                        let carrier = BodyNode {
                            body: interface.bodies[own],
                            node: interface.shared[i].nodes[own],
                        };
                        // Adding to the distance is going away from the other body.
                        let normal = outward(interface, i, own);
                        ((other, carrier), normal.map(|n| 0.0 - n * by))
                    }));
            }
        }
        for row in rows.iter().filter(|row| row.is_mortar()) {
            let RowSource::Interface(k) = row.source else {
                continue;
            };
            if let Some(interface) = place[k] {
                let owner = |m: BodyNode| {
                    let body = &bodies[m.body];
                    body.first_subdomain + body.mesh().owner(m.node)
                };
                let owners = row.members.iter().flatten().map(|m| owner(*m));
                out.rows.push(Row {
                    source: RowSource::Interface(interface),
                    block: row
                        .terms(bodies)
                        .iter()
                        .map(|t| t.0)
                        .min()
                        .unwrap_or_default(),
                    subdomain: owners.min().unwrap_or_default(),
                    ..row.clone()
                });
            }
        }
        Ok(out)
    }
}

/// Whether the interface has contact alone, on a face.
pub(super) fn is_renewed(interface: &BodyInterface) -> bool {
    let tied = |link: Link| matches!(link, Link::Tied | Link::Open);
    let face = interface.shape == InterfaceShape::Face && interface.has_contact();
    face && !interface.shared.iter().any(|s| tied(s.link))
}

/// The body with the multipliers of an interface that an entry names, 0 or 1: where nodes match, that of the entry.
fn of_entry(spec: &SceneSpec, bodies: &[Body], interface: &BodyInterface) -> Option<usize> {
    if let Some(mortar) = &interface.mortar {
        return Some(mortar.multipliers);
    }
    let Some(EntryId::Contact(number)) = interface.entry else {
        return None;
    };
    let contact = &spec.contacts[number];
    let PairSelector::Named(first, _) = &contact.pair else {
        return None;
    };
    let which = contact.multipliers.unwrap_or(0);
    if bodies[interface.bodies[0]].spec.name == *first {
        Some(which)
    } else {
        Some(1 - which)
    }
}

/// The normal at a shared node, out of one of the bodies.
fn outward(interface: &BodyInterface, shared: usize, body: usize) -> [f64; 3] {
    let normal = interface.normals[shared];
    match body {
        0 => normal,
        _ => normal.map(|n| 0.0 - n),
    }
}

/// The body of a pair that a contact says to carry multipliers, 0 or 1.
fn carrier(spec: &SceneSpec, bodies: &[Body], pair: [usize; 2]) -> Option<usize> {
    let [a, b] = pair.map(|k| &bodies[k].spec.name);
    spec.contacts.iter().find_map(|c| match &c.pair {
        PairSelector::Named(x, y) if x == a && y == b => c.multipliers,
        PairSelector::Named(x, y) if x == b && y == a => c.multipliers.map(|k| 1 - k),
        _ => None,
    })
}

/// Whether contacts go on having a meaning once bodies have moved.
pub(super) fn may_renew(form: &Form, contacts: &[ContactSpec]) -> bool {
    form.is_elastic() && !contacts.iter().any(is_of_common_face)
}

/// Whether a contact is about places along the common face of two bodies.
fn is_of_common_face(contact: &ContactSpec) -> bool {
    let whole = matches!(contact.extent, Extent::All | Extent::None);
    contact.sides.is_none() && (!whole || matches!(contact.gap, Profile::Table(_)))
}

/// Refuses what has no meaning once bodies have moved.
fn check(spec: &SceneSpec) -> Result<()> {
    let steps = spec.steps.as_ref().map(|s| &s.location);
    if !spec.form.is_elastic() {
        return Err(Error::input(
            "`update` in [steps] of a scalar scene, in which nothing moves (elasticity was expected)",
        )
        .at(steps));
    }
    match spec.contacts.iter().find(|c| is_of_common_face(c)) {
        Some(contact) => Err(Error::input(
            "a part of a common face, or a gap along it, for a contact that `update` in [steps] renews: the common \
             face changes when bodies slide (`sides` were expected: places are then those along a side)",
        )
        .at(&contact.location)),
        None => Ok(()),
    }
}

impl Renewal {
    /// The contacts and obstacles of bodies that have moved, and the rows of load step `step`.
    ///
    /// # Errors
    /// [`ErrorKind::Input`](base::ErrorKind::Input) where given values contradict an inequality.
    pub fn on(
        &self,
        bodies: &mut [Body],
        steps: &mut Option<Steps>,
        step: usize,
    ) -> Result<(Vec<BodyInterface>, Vec<Obstacle>, SceneRows)> {
        let mut spec = self.written.clone();
        let mut matching = NodeMatching::new(bodies);
        surfaces::expand_contacts(bodies, &mut matching, &mut spec);
        let mut found = sides(bodies, &mut matching, &spec, self);
        drop(matching);
        if let Some(steps) = steps {
            steps.renumber(&spec);
        }
        entries::rejoin(bodies, &mut found, &spec, steps)?;
        // The obstacles stand where the last step has left them.
        let factors = Factors::of(steps, step.saturating_sub(1))?;
        let standing = Standing::after(factors, &self.beside);
        let mut interfaces = self.kept.clone();
        interfaces.extend(found);
        let mut obstacles =
            obstacles::find_obstacles(bodies, &spec.obstacles, &spec.form, standing)?;
        let joined = Joined {
            spec: &spec,
            interfaces: &mut interfaces,
            obstacles: &obstacles,
            known: self.rows.clone(),
            owns: &|_| true,
        };
        let rows = joined.rows(bodies, steps, Some(step))?;
        obstacles.iter_mut().for_each(Obstacle::finish);
        Ok((interfaces, obstacles, rows))
    }
}

impl Renewal {
    /// Nodes that were adjusted at the start stay so; body number `which` of the pair carries the multipliers.
    fn adjust(&self, interface: &mut BodyInterface, which: usize) {
        if self.adjusted.is_empty() {
            return;
        }
        let other = interface.bodies[1 - which];
        let body = interface.bodies[which];
        for i in 0..interface.shared.len() {
            let node = interface.shared[i].nodes[which];
            let Some(way) = self.adjusted.get(&(other, BodyNode { body, node })) else {
                continue;
            };
            let by = 0.0 - dot(*way, outward(interface, i, which));
            interface.distances[i] += by;
            interface.adjusted.insert(i, by);
        }
    }
}

/// The interfaces of sides in contact, where bodies are now: nodes opposite each other, or mortar integrals.
fn sides(
    bodies: &[Body],
    matching: &mut NodeMatching<'_>,
    spec: &SceneSpec,
    renewal: &Renewal,
) -> Vec<BodyInterface> {
    let mut out = Vec::new();
    let mut meet = |pair, sides, which, reach, entry: Option<EntryId>| {
        let nodal = matching.find(pair, sides, reach).ok().cloned();
        let found = match nodal {
            Some(found) if !is_for_contact(bodies, &found) => Some(found),
            other => {
                let both = (pair, sides);
                let found = matching.mortar(&spec.form, both, which, reach).take();
                found.or(other)
            }
        };
        if let Some(mut found) = found {
            found.entry = entry;
            renewal.adjust(&mut found, which);
            out.push(found);
        }
    };
    for &(pair, sides, which) in &renewal.touching {
        meet(pair, sides, which, f64::INFINITY, None);
    }
    let body = |name: &String| bodies.iter().position(|b| b.spec.name == *name);
    for (number, contact) in spec.contacts.iter().enumerate() {
        let (Some(sides), PairSelector::Named(first, second)) = (contact.sides, &contact.pair)
        else {
            continue;
        };
        let (Some(a), Some(b)) = (body(first), body(second)) else {
            continue;
        };
        let which = contact.multipliers.unwrap_or(0);
        let (pair, sides, which) = if a <= b {
            ([a, b], sides, which)
        } else {
            ([b, a], [sides[1], sides[0]], 1 - which)
        };
        let reach = contact.distance.unwrap_or(f64::INFINITY);
        meet(pair, sides, which, reach, Some(EntryId::Contact(number)));
    }
    out
}
