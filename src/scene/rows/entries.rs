//! The joints between touching bodies: the default, and the entries of [[tie]] and [[contact]].

use super::entry::{some_names, Contact, Entry};
use super::links::Links;
use super::surfaces::{shortest, NEAR};
use crate::error::{Error, Result};
use crate::scene::body::Body;
use crate::scene::geometry::facing::opposite;
use crate::scene::geometry::interface::{Interface, Link, Shape};
use crate::scene::geometry::matching::{apart, Matching, Mismatch};
use crate::scene::geometry::touching::touching;
use crate::scene::geometry::{mortar, overlap};
use crate::scene::model::joints::{ContactSpec, Extent, Pair, TieSpec};
use crate::scene::model::profile::Profile;
use crate::scene::model::spec::{ByDefault, SceneSpec};
use crate::scene::model::steps::{Factors, Steps};
use crate::substructures::BodyNode;
use std::collections::{HashMap, HashSet};

/// All pairs that touch, with their ties and contacts.
pub(crate) fn find(
    bodies: &[Body],
    mut matching: Matching<'_>,
    spec: &SceneSpec,
    steps: &Option<Steps>,
) -> Result<Vec<Interface>> {
    let mut interfaces = touching(bodies)?;
    unmatched(bodies, &mut matching, spec, &mut interfaces);
    facing(bodies, matching, spec, &mut interfaces)?;
    let (ties, contacts) = (&spec.ties, &spec.contacts);
    let mut entries = Entries::new(bodies, ties, contacts)?;
    let zero = Profile::constant(0.0);
    let default = default(spec, &zero);
    let mut weak = Vec::new();
    for (k, interface) in interfaces.iter_mut().enumerate() {
        entries.apply(bodies, interface, default.as_ref(), Factors::last(steps))?;
        if interface.shape == Shape::Corner && !entries.tie_names(interface.bodies) {
            weak.push(k);
        }
    }
    entries.check_used(&interfaces)?;
    release_corners(&mut interfaces, &weak);
    Ok(interfaces)
}

/// Common faces of boxes whose nodes do not match become interfaces with mortar rows where entries mean all of them or
/// a range; single nodes have to match.
fn unmatched(
    bodies: &[Body],
    matching: &mut Matching<'_>,
    spec: &SceneSpec,
    interfaces: &mut [Interface],
) {
    let whole = |e: &Extent| matches!(e, Extent::All | Extent::Range(_));
    let ties = spec.ties.iter();
    let ties = ties.map(|t| (&t.pair, t.multipliers, &t.extent, t.sides));
    let contacts = spec.contacts.iter();
    let contacts = contacts.map(|c| (&c.pair, c.multipliers, &c.extent, c.sides));
    // The entries that name no sides, by number: those of all pairs, and those of each pair of names.
    let mut of_all = Vec::new();
    let mut of_names: HashMap<[&str; 2], Vec<_>> = HashMap::new();
    for (number, (pair, which, extent, sides)) in ties.chain(contacts).enumerate() {
        let entry = (number, pair, which, extent);
        match pair {
            _ if sides.is_some() => {}
            Pair::All => of_all.push(entry),
            Pair::Named(a, b) => of_names.entry(in_order(a, b)).or_default().push(entry),
            Pair::Surfaces(..) => {}
        }
    }
    for interface in interfaces {
        let names = interface.bodies.map(|k| &bodies[k].spec.name);
        let [a, b] = names;
        // Which body the entry says, in the order of the pair; `None`: the entry is of another pair.
        let meant = |pair: &Pair, which: Option<usize>| match pair {
            Pair::All => Some(which.unwrap_or(0)),
            Pair::Named(x, y) if x == a && y == b => Some(which.unwrap_or(0)),
            Pair::Named(x, y) if x == b && y == a => Some(1 - which.unwrap_or(0)),
            _ => None,
        };
        let mut which = None;
        let (mut single, mut contact) = (false, false);
        let named = of_names.get(&in_order(a, b)).into_iter().flatten();
        let mut entries: Vec<_> = of_all.iter().chain(named).collect();
        entries.sort_by_key(|entry| entry.0);
        for &&(number, pair, of_entry, extent) in &entries {
            let Some(found) = meant(pair, of_entry) else {
                continue;
            };
            single |= !whole(extent) && *extent != Extent::None;
            contact |= number >= spec.ties.len();
            if which.is_none() || *pair != Pair::All {
                which = Some(found);
            }
        }
        if single || (which.is_none() && spec.default == ByDefault::Free) {
            continue;
        }
        let (pair, sides) = (interface.bodies, interface.sides);
        contact |= which.is_none() && spec.default == ByDefault::Contact;
        let reach = match contact && mortar::is_for_contact(bodies, interface) {
            true => Some(near(matching, interface)),
            false => loose(bodies, matching, interface),
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
fn loose(bodies: &[Body], matching: &mut Matching<'_>, interface: &Interface) -> Option<f64> {
    if !interface.unmatched.is_empty() {
        return (interface.shape == Shape::Face).then_some(f64::INFINITY);
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
fn near(matching: &mut Matching<'_>, interface: &Interface) -> f64 {
    let mut edge = |k: usize| {
        let surface = matching.surface(interface.bodies[k], interface.sides[k]);
        shortest(&surface.edges)
    };
    NEAR * edge(0).min(edge(1))
}

/// Interfaces of facing sides that an entry names; they replace the interface of the touching pair.
fn facing(
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

/// Joins interfaces of bodies that have moved as the contacts of `spec` say. A contact that selects none of their nodes
/// any more has none.
pub(crate) fn rejoin(
    bodies: &[Body],
    interfaces: &mut [Interface],
    spec: &SceneSpec,
    steps: &Option<Steps>,
) -> Result<()> {
    let mut entries = Entries::new(bodies, &spec.ties, &spec.contacts)?;
    entries.moved = true;
    let zero = Profile::constant(0.0);
    let default = default(spec, &zero);
    for interface in interfaces {
        entries.apply(bodies, interface, default.as_ref(), Factors::last(steps))?;
    }
    Ok(())
}

/// The joint of bodies of which no entry speaks, with the gap 0.
fn default<'a>(spec: &SceneSpec, zero: &'a Profile) -> Option<Entry<'a>> {
    let default = Entry {
        pair: &Pair::All,
        extent: &Extent::All,
        written: "",
        contact: (spec.default == ByDefault::Contact).then_some(Contact {
            gap: zero,
            number: None,
        }),
        own: None,
    };
    (spec.default != ByDefault::Free).then_some(default)
}

/// Removes unwanted corner ties. The corner pairs in `weak` are tied only because an entry ties all pairs. If one of
/// the two nodes is in contact elsewhere, the tie would close that contact and is removed.
fn release_corners(interfaces: &mut [Interface], weak: &[usize]) {
    let mut in_contact: HashSet<(usize, usize)> = HashSet::new();
    for i in interfaces.iter() {
        for s in i.shared.iter().filter(|s| s.link.is_contact()) {
            in_contact.extend([0, 1].map(|k| (i.bodies[k], s.nodes[k])));
        }
    }
    for &k in weak {
        let Interface { bodies, shared, .. } = &mut interfaces[k];
        for s in shared.iter_mut().filter(|s| s.link == Link::Tied) {
            if [0, 1]
                .iter()
                .any(|&m| in_contact.contains(&(bodies[m], s.nodes[m])))
            {
                s.link = Link::Free;
            }
        }
    }
}

/// The entries by pair.
struct Entries<'a> {
    /// Entries for all pairs, each with a flag: it has selected a node, or another entry overrides it.
    all: Vec<(Entry<'a>, bool)>,
    /// Entries for single pairs, each with the pair's order in the file.
    named: HashMap<[usize; 2], Vec<(Entry<'a>, [usize; 2])>>,
    /// Whether bodies have moved, so that entries may select nothing.
    moved: bool,
}

impl<'a> Entries<'a> {
    fn new(
        bodies: &[Body],
        ties: &'a [TieSpec],
        contacts: &'a [ContactSpec],
    ) -> Result<Entries<'a>> {
        let index: HashMap<&str, usize> = bodies
            .iter()
            .enumerate()
            .map(|(k, b)| (b.spec.name.as_str(), k))
            .collect();
        let mut entries = Entries {
            all: Vec::new(),
            named: HashMap::new(),
            moved: false,
        };
        let contacts = contacts.iter().enumerate();
        let contacts = contacts.map(|(number, spec)| Entry::contact(ties.len(), number, spec));
        let ties = ties.iter().enumerate().map(|(k, spec)| Entry::tie(k, spec));
        for entry in ties.chain(contacts) {
            let (first, second) = match entry.pair {
                Pair::All => {
                    entries.all.push((entry, false));
                    continue;
                }
                Pair::Named(first, second) => (first, second),
                // Surfaces have been replaced by bodies and sides before.
                Pair::Surfaces(..) => continue,
            };
            let find = |name: &String| {
                index.get(name.as_str()).copied().ok_or_else(|| {
                    Error::Input(format!(
                        "{}a {} names body `{name}`, which the scene does not have (bodies are {})",
                        entry.written,
                        entry.what(),
                        some_names(bodies)
                    ))
                })
            };
            let (a, b) = (find(first)?, find(second)?);
            if a == b {
                return Err(Error::Input(format!(
                    "{}a {} names body `{first}` twice where two bodies were expected",
                    entry.written,
                    entry.what()
                )));
            }
            let pair = [a.min(b), a.max(b)];
            let list: &mut Vec<_> = entries.named.entry(pair).or_default();
            list.push((entry, [a, b]));
        }
        Ok(entries)
    }

    /// Whether a tie names the pair.
    fn tie_names(&self, pair: [usize; 2]) -> bool {
        let named = self.named.get(&pair).into_iter().flatten();
        named.into_iter().any(|(e, _)| e.contact.is_none())
    }

    /// Sets the links of one interface. Entries replace the default and add up. Entries that name the pair override
    /// contacts of all pairs; a contact that names the pair overrides ties of all pairs.
    fn apply(
        &mut self,
        bodies: &[Body],
        interface: &mut Interface,
        default: Option<&Entry<'a>>,
        last: Factors<'_>,
    ) -> Result<()> {
        let named = self.named.get(&interface.bodies).into_iter().flatten();
        let named = named.filter(|(e, _)| e.own.is_none() || e.own == interface.entry);
        let named: Vec<(Entry<'_>, [usize; 2])> = named.copied().collect();
        let contact_named = named.iter().any(|(e, _)| e.contact.is_some());
        let mut links = Links::new(bodies, interface);
        let speaks = |e: &Entry<'_>| match e.contact {
            None => !contact_named,
            Some(_) => named.is_empty(),
        };
        // Ties come first: contacts need to know which nodes are tied.
        for contact in [false, true] {
            for (entry, used) in &mut self.all {
                if entry.contact.is_some() == contact {
                    // An entry that is overridden everywhere is no mistake.
                    *used |= !speaks(entry) || links.add(*entry, None)? > 0;
                }
            }
            for (entry, order) in &named {
                if entry.contact.is_some() == contact {
                    let selected = links.add(*entry, Some(*order))?;
                    if selected == 0 && *entry.extent != Extent::None && !self.moved {
                        let [a, b] = links.names();
                        return Err(Error::Input(format!(
                            "{}the {} of bodies `{a}` and `{b}` selects no node of their common face",
                            entry.written,
                            entry.what()
                        )));
                    }
                }
            }
        }
        if let (0, Some(default)) = (links.entries, default) {
            links.add(*default, None)?;
        }
        links.finish(last)
    }

    /// Checks that every entry found a pair that touches, and that an entry for all pairs selects at least one node.
    fn check_used(&self, interfaces: &[Interface]) -> Result<()> {
        let touching: HashSet<[usize; 2]> = interfaces.iter().map(|i| i.bodies).collect();
        let mut apart: Vec<&Entry<'_>> = self
            .named
            .iter()
            .filter(|(pair, _)| !touching.contains(*pair))
            .flat_map(|(_, list)| list.iter().map(|(entry, _)| entry))
            .collect();
        apart.sort_by(|a, b| a.written.cmp(b.written));
        if let Some(entry) = apart.first() {
            let Pair::Named(a, b) = entry.pair else {
                unreachable!("only named pairs are in the map")
            };
            return Err(Error::Input(format!(
                "{}a {} joins bodies `{a}` and `{b}`, which do not touch",
                entry.written,
                entry.what()
            )));
        }
        for (entry, used) in &self.all {
            if *entry.extent != Extent::None && !used {
                return Err(Error::Input(format!(
                    "{}the {} of all bodies selects no node of any common face",
                    entry.written,
                    entry.what()
                )));
            }
        }
        Ok(())
    }
}
