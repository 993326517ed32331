//! Common faces of which the nodes do not match, and no entry names the sides.

use super::surfaces::{shortest, NEAR};
use crate::body::Body;
use crate::geometry::interface::{BodyInterface, InterfaceShape};
use crate::geometry::matching::{Mismatch, NodeMatching};
use crate::geometry::mortar;
use crate::model::entry::EntryId;
use crate::model::joints::{Extent, PairSelector};
use crate::model::spec::{ByDefault, SceneSpec};
use std::collections::HashMap;

/// Common faces of boxes whose nodes do not match become interfaces with mortar rows where entries mean all of them or
/// a range; single nodes have to match.
pub(super) fn unmatched(
    bodies: &[Body],
    matching: &mut NodeMatching<'_>,
    spec: &SceneSpec,
    interfaces: &mut [BodyInterface],
) {
    let whole = |e: &Extent| matches!(e, Extent::All | Extent::Range(_));
    let ties = (0..).map(EntryId::Tie).zip(&spec.ties);
    let ties = ties.map(|(id, t)| (id, &t.pair, t.multipliers, &t.extent, t.sides));
    let contacts = (0..).map(EntryId::Contact).zip(&spec.contacts);
    let contacts = contacts.map(|(id, c)| (id, &c.pair, c.multipliers, &c.extent, c.sides));
    // The entries that name no sides: those of all pairs, and those of each pair of names.
    let mut of_all = Vec::new();
    let mut of_names: HashMap<[&str; 2], Vec<_>> = HashMap::new();
    for (id, pair, which, extent, sides) in ties.chain(contacts) {
        let entry = (id, pair, which, extent);
        match pair {
            _ if sides.is_some() => {}
            PairSelector::All => of_all.push(entry),
            PairSelector::Named(a, b) => of_names.entry(in_order(a, b)).or_default().push(entry),
            PairSelector::Surfaces(..) => {}
        }
    }
    for interface in interfaces {
        let names = interface.bodies.map(|k| &bodies[k].spec.name);
        let [a, b] = names;
        // Which body the entry says, in the order of the pair; `None`: the entry is of another pair.
        let meant = |pair: &PairSelector, which: Option<usize>| match pair {
            PairSelector::All => Some(which.unwrap_or(0)),
            PairSelector::Named(x, y) if x == a && y == b => Some(which.unwrap_or(0)),
            PairSelector::Named(x, y) if x == b && y == a => Some(1 - which.unwrap_or(0)),
            _ => None,
        };
        let mut which = None;
        let (mut single, mut contact) = (false, false);
        let named = of_names.get(&in_order(a, b)).into_iter().flatten();
        let mut entries: Vec<_> = of_all.iter().chain(named).collect();
        entries.sort_by_key(|entry| entry.0);
        for &&(id, pair, of_entry, extent) in &entries {
            let Some(found) = meant(pair, of_entry) else {
                continue;
            };
            single |= !whole(extent) && *extent != Extent::None;
            contact |= matches!(id, EntryId::Contact(_));
            if which.is_none() || *pair != PairSelector::All {
                which = Some(found);
            }
        }
        if single || (which.is_none() && spec.default == ByDefault::Free) {
            continue;
        }
        let (pair, sides) = (interface.bodies, interface.sides);
        contact |= which.is_none() && spec.default == ByDefault::Contact;
        let reach = if contact && mortar::is_for_contact(bodies, interface) {
            Some(near(matching, interface))
        } else {
            loose(bodies, matching, interface)
        };
        let Some(reach) = reach else {
            continue;
        };
        let which = which.unwrap_or(0);
        if let Some(found) = mortar::interface(bodies, &spec.form, pair, sides, which, reach) {
            *interface = found;
        }
    }
}

/// Two names in their order.
fn in_order<'a>(a: &'a str, b: &'a str) -> [&'a str; 2] {
    [a.min(b), a.max(b)]
}

/// How far apart the sides of a common face with nodes that do not match may be; `None` for other interfaces.
fn loose(
    bodies: &[Body],
    matching: &mut NodeMatching<'_>,
    interface: &BodyInterface,
) -> Option<f64> {
    if !interface.unmatched.is_empty() {
        return (interface.shape == InterfaceShape::Face).then_some(f64::INFINITY);
    }
    let (pair, sides) = (interface.bodies, interface.sides);
    let unbent = |k: usize| bodies[k].mesh().grid().is_some() && bodies[k].spec.is_straight();
    if pair.iter().all(|&k| unbent(k)) {
        return None;
    }
    // Curved sides with different meshes are different polygons. What seems to be a corner may be a face of which no
    // cell has all nodes in common with the other body.
    let reach = near(matching, interface);
    let found = matching.find(pair, sides, reach);
    matches!(found, Err(Mismatch::Lonely)).then_some(reach)
}

/// How far apart sides may be that touch: a part of their shortest edge.
fn near(matching: &mut NodeMatching<'_>, interface: &BodyInterface) -> f64 {
    let mut edge = |k: usize| {
        let surface = matching.surface(interface.bodies[k], interface.sides[k]);
        shortest(&surface.edges)
    };
    NEAR * edge(0).min(edge(1))
}
