//! The interfaces of sides that an entry of [[tie]] or [[contact]] names.

use crate::error::{Error, Result};
use crate::scene::body::Body;
use crate::scene::geometry::facing::opposite;
use crate::scene::geometry::interface::Interface;
use crate::scene::geometry::matching::{apart, Matching, Mismatch};
use crate::scene::geometry::{mortar, overlap};
use crate::scene::model::joints::Pair;
use crate::scene::model::spec::SceneSpec;
use crate::substructures::BodyNode;
use std::collections::{HashMap, HashSet};

/// Interfaces of facing sides that an entry names; they replace the interface of the touching pair.
pub(super) fn facing(
    bodies: &[Body],
    mut matching: Matching<'_>,
    spec: &SceneSpec,
    interfaces: &mut Vec<Interface>,
) -> Result<()> {
    let ties = spec.ties.iter();
    let ties = ties.map(|t| {
        (
            t.sides,
            &t.pair,
            t.multipliers,
            (t.adjust, &[][..]),
            None,
            &t.written,
        )
    });
    let contacts = spec.contacts.iter();
    let contacts = contacts.map(|c| {
        let adjust = (c.adjust, &c.adjusted[..]);
        (
            c.sides,
            &c.pair,
            c.multipliers,
            adjust,
            c.distance,
            &c.written,
        )
    });
    let mut numbers = HashMap::new();
    for (k, body) in bodies.iter().enumerate() {
        numbers.entry(body.spec.name.as_str()).or_insert(k);
    }
    for (number, (sides, pair, which, adjust, distance, written)) in
        ties.chain(contacts).enumerate()
    {
        let (Some(sides), Pair::Named(first, second)) = (sides, pair) else {
            continue;
        };
        let find = |name: &String| numbers.get(name.as_str()).copied();
        let (Some(a), Some(b)) = (find(first), find(second)) else {
            // The check of entries that name bodies reports this error.
            continue;
        };
        let (pair, sides) = match a < b {
            true => ([a, b], sides),
            false => ([b, a], [sides[1], sides[0]]),
        };
        // Sides of boxes that the user names meet as a whole; those that are found, as far as they are near.
        let grids = pair.map(|k| bodies[k].mesh().grid());
        let reach = distance.unwrap_or(f64::INFINITY);
        let matched = match (grids, distance) {
            ([Some(x), Some(y)], None) => match opposite(bodies, [x, y], pair, sides) {
                Some(interface) => Ok(interface),
                None => Err(format!(
                    "the sides of bodies `{first}` and `{second}` do not face each other"
                )),
            },
            _ => match matching.find(pair, sides, reach) {
                Ok(found) => Ok(found.clone()),
                Err(Mismatch::Apart(why)) => Err(why),
                // Whether nodes match does not matter to mortar rows: without those the sides do not meet.
                Err(Mismatch::Lonely) => Err(apart(bodies, pair, sides)),
            },
        };
        let is_contact = number >= spec.ties.len();
        let nodal = match &matched {
            Ok(found) => !is_contact || !mortar::is_for_contact(bodies, found),
            Err(_) => false,
        };
        let mut interface = match matched {
            Ok(interface) if nodal => interface,
            // The first body of the entry carries the multipliers, unless it says something else.
            other => {
                let which = which.unwrap_or(0);
                let which = if a < b { which } else { 1 - which };
                // Several entries may have the same sides.
                let found = matching
                    .mortar(&spec.form, (pair, sides), which, reach)
                    .clone();
                // Without a common part of faces, nodes that match stay what they are.
                found
                    .map_or(other, Ok)
                    .map_err(|why| Error::Input(format!("{written}{why}")))?
            }
        };
        let (within, adjusted) = adjust;
        let adjusted: HashSet<&BodyNode> = adjusted.iter().collect();
        // The first body of the entry is the second of the pair if its number is higher.
        let first = usize::from(pair[0] != a);
        let shared = interface.shared.iter().map(|s| s.nodes[first]);
        for (i, (distance, node)) in interface.distances.iter_mut().zip(shared).enumerate() {
            if distance.abs() <= within || adjusted.contains(&BodyNode { body: a, node }) {
                interface.adjusted.insert(i, 0.0 - *distance);
                *distance = 0.0;
            }
        }
        if let Some(why) = overlap::too_large(bodies, &interface) {
            return Err(Error::Input(format!("{written}{why}")));
        }
        interface.entry = Some(number);
        interfaces.push(interface);
    }
    let of_entries = interfaces.iter().filter(|i| i.entry.is_some());
    let named: HashSet<[usize; 2]> = of_entries.map(|i| i.bodies).collect();
    interfaces.retain(|i| i.entry.is_some() || !named.contains(&i.bodies));
    interfaces.sort_by_key(|i| i.bodies);
    Ok(())
}
