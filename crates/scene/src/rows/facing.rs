//! The interfaces of sides that an entry of [[tie]] or [[contact]] names.

use crate::body::Body;
use crate::geometry::facing::opposite;
use crate::geometry::interface::BodyInterface;
use crate::geometry::matching::{apart, Mismatch, NodeMatching};
use crate::geometry::single::{has_lonely_nodes, ReachedNodes};
use crate::geometry::{mortar, overlap};
use crate::model::entry::EntryId;
use crate::model::joints::{Extent, PairSelector};
use crate::model::spec::SceneSpec;
use base::{Error, Location, Result};
use fetifeti::problem::BodyNode;
use std::collections::{HashMap, HashSet};

/// Interfaces of facing sides that an entry names; they replace the interface of the touching pair. Of ties with a
/// tolerance the nodes that lie farther away are returned.
pub(super) fn facing(
    bodies: &[Body],
    mut matching: NodeMatching<'_>,
    spec: &SceneSpec,
    interfaces: &mut Vec<BodyInterface>,
) -> Result<Vec<(EntryId, Vec<BodyNode>)>> {
    let ties = spec.ties.iter().enumerate();
    let ties = ties.map(|(k, t)| SideEntry {
        id: EntryId::Tie(k),
        sides: t.sides,
        pair: &t.pair,
        which: t.multipliers.unwrap_or(0),
        adjust: (t.adjust, &[]),
        distance: None,
        extent: &t.extent,
        location: &t.location,
    });
    let contacts = spec.contacts.iter().enumerate();
    let contacts = contacts.map(|(k, c)| SideEntry {
        id: EntryId::Contact(k),
        sides: c.sides,
        pair: &c.pair,
        which: c.multipliers.unwrap_or(0),
        adjust: (c.adjust, &c.adjusted),
        distance: c.distance,
        extent: &c.extent,
        location: &c.location,
    });
    let mut numbers = HashMap::new();
    for (k, body) in bodies.iter().enumerate() {
        numbers.entry(body.spec.name.as_str()).or_insert(k);
    }
    let mut far = Vec::new();
    for entry in ties.chain(contacts) {
        let (Some(sides), PairSelector::Named(first, second)) = (entry.sides, entry.pair) else {
            continue;
        };
        let find = |name: &String| numbers.get(name.as_str()).copied();
        let (Some(a), Some(b)) = (find(first), find(second)) else {
            // The check of entries that name bodies reports this error.
            continue;
        };
        if a == b && sides[0] == sides[1] {
            let side = bodies[a].mesh().side_name(sides[0]);
            return entry.error(&format!(
                "the side `{side}` of body `{first}` is named twice (two of its sides were expected)"
            ));
        }
        // The first body of the entry carries the multipliers, unless it says something else.
        let (pair, sides, which) = if a <= b {
            ([a, b], sides, entry.which)
        } else {
            ([b, a], [sides[1], sides[0]], 1 - entry.which)
        };
        let is_contact = matches!(entry.id, EntryId::Contact(_));
        let matched = entry.matched(bodies, &mut matching, pair, sides);
        let mut interface = match *entry.extent {
            Extent::Within { distance, .. } if !is_contact => {
                let reached = ReachedNodes::new(bodies, &spec.form, (pair, sides), which, distance);
                let of = |&node: &usize| BodyNode {
                    body: pair[which],
                    node,
                };
                far.push((entry.id, reached.far.iter().map(of).collect()));
                entry.within(
                    bodies,
                    &mut matching,
                    spec,
                    (pair, sides, which),
                    (matched, reached),
                )?
            }
            // Nodes of no face have nothing to integrate over.
            Extent::Within { .. } if has_lonely_nodes(&bodies[pair[which]].spec, sides[which]) => {
                let touching =
                    ReachedNodes::touching(bodies, &spec.form, (pair, sides), which, entry.reach());
                let found = touching.interface(bodies, &spec.form, (pair, sides), which);
                match found {
                    Some(found) => found,
                    None => return entry.error(&apart(bodies, pair, sides)),
                }
            }
            _ => entry.whole(
                bodies,
                &mut matching,
                spec,
                (pair, sides, which),
                (matched, is_contact),
            )?,
        };
        let (within, adjusted) = entry.adjust;
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
            return entry.error(&why);
        }
        interface.entry = Some(entry.id);
        interfaces.push(interface);
    }
    let of_entries = interfaces.iter().filter(|i| i.entry.is_some());
    let named: HashSet<[usize; 2]> = of_entries.map(|i| i.bodies).collect();
    interfaces.retain(|i| i.entry.is_some() || !named.contains(&i.bodies));
    interfaces.sort_by_key(|i| i.bodies);
    Ok(far)
}

/// An entry that may name sides.
struct SideEntry<'s> {
    id: EntryId,
    sides: Option<[usize; 2]>,
    pair: &'s PairSelector,
    /// Which of its two bodies carries the multipliers.
    which: usize,
    /// Gaps up to this length count as touching, and those of these nodes of the first body.
    adjust: (f64, &'s [BodyNode]),
    distance: Option<f64>,
    extent: &'s Extent,
    location: &'s Location,
}

/// Two bodies in increasing order, a side of each, and which of the two carries the multipliers.
type OrientedSides = ([usize; 2], [usize; 2], usize);

/// The interface of nodes that lie opposite each other, or why there is none.
type Matched = std::result::Result<BodyInterface, String>;

impl SideEntry<'_> {
    fn error<T>(&self, why: &str) -> Result<T> {
        Err(Error::input(why).at(self.location))
    }

    /// How far apart the sides may be.
    fn reach(&self) -> f64 {
        self.distance.unwrap_or(f64::INFINITY)
    }

    /// The nodes of both sides that lie opposite each other.
    fn matched(
        &self,
        bodies: &[Body],
        matching: &mut NodeMatching<'_>,
        pair: [usize; 2],
        sides: [usize; 2],
    ) -> Matched {
        // Sides of boxes that the user names meet as a whole; those that are found, as far as they are near.
        let grids = pair.map(|k| bodies[k].mesh().grid());
        match (grids, self.distance) {
            ([Some(x), Some(y)], None) => match opposite(bodies, [x, y], pair, sides) {
                Some(interface) => Ok(interface),
                None => {
                    let PairSelector::Named(a, b) = self.pair else {
                        unreachable!("who names sides names bodies")
                    };
                    let who = if a == b {
                        format!("body `{a}`")
                    } else {
                        format!("bodies `{a}` and `{b}`")
                    };
                    Err(format!("the sides of {who} do not face each other"))
                }
            },
            _ => match matching.find(pair, sides, self.reach()) {
                Ok(found) => Ok(found.clone()),
                Err(Mismatch::Apart(why)) => Err(why),
                // Whether nodes match does not matter to mortar rows: without those the sides do not meet.
                Err(Mismatch::Lonely) => Err(apart(bodies, pair, sides)),
            },
        }
    }

    /// The interface of all that lies opposite.
    fn whole(
        &self,
        bodies: &[Body],
        matching: &mut NodeMatching<'_>,
        spec: &SceneSpec,
        (pair, sides, which): OrientedSides,
        (matched, is_contact): (Matched, bool),
    ) -> Result<BodyInterface> {
        let other = match matched {
            Ok(found) if !is_contact || !mortar::is_for_contact(bodies, &found) => {
                return Ok(found)
            }
            other => other,
        };
        // Several entries may have the same sides.
        let found = matching.mortar(&spec.form, (pair, sides), which, self.reach());
        // Without a common part of faces, nodes that match stay what they are.
        found
            .clone()
            .map_or(other, Ok)
            .or_else(|why| self.error(&why))
    }

    /// The interface of the nodes within the tolerance: those that have a node opposite, or the sides as a whole where
    /// nothing lies farther away, or node by node.
    fn within(
        &self,
        bodies: &[Body],
        matching: &mut NodeMatching<'_>,
        spec: &SceneSpec,
        (pair, sides, which): OrientedSides,
        (matched, reached): (Matched, ReachedNodes),
    ) -> Result<BodyInterface> {
        let held = reached.nodes();
        if let Ok(mut found) = matched {
            let meant = |i: &BodyInterface| {
                i.shared
                    .iter()
                    .filter(|s| held.contains(&s.nodes[which]))
                    .count()
            };
            if !held.is_empty() && meant(&found) == held.len() {
                found.keep(|shared| held.contains(&shared.nodes[which]));
                return Ok(found);
            }
        }
        let mut found = None;
        let (tolerance, singly) = match *self.extent {
            Extent::Within { distance, singly } => (distance, singly),
            _ => (f64::INFINITY, false),
        };
        if !singly && reached.far.is_empty() && !reached.alone {
            found.clone_from(matching.mortar(&spec.form, (pair, sides), which, f64::INFINITY));
        }
        let found = found.or_else(|| reached.interface(bodies, &spec.form, (pair, sides), which));
        found.map_or_else(
            || {
                let of = |k: usize| {
                    let spec = &bodies[pair[k]].spec;
                    format!("side `{}` of `{}`", spec.mesh.side_name(sides[k]), spec.name)
                };
                self.error(&format!(
                    "no node of {} lies within {tolerance} of {}, so the tie joins nothing (a larger position \
                     tolerance was expected)",
                    of(which),
                    of(1 - which)
                ))
            },
            Ok,
        )
    }
}
