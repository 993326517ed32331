//! The joints between touching bodies: the default, and the entries of [[tie]] and [[contact]].

use super::entry::{both, some_names, Entry};
use super::facing::facing;
use super::left_out::LeftOut;
use super::links::Links;
use super::origin::SideOrigin;
use super::unmatched::unmatched;
use crate::body::Body;
use crate::geometry::interface::{BodyInterface, InterfaceShape, Link};
use crate::geometry::matching::NodeMatching;
use crate::geometry::touching::touching;
use crate::model::joints::{ContactSpec, Extent, PairSelector, TieSpec};
use crate::model::profile::Profile;
use crate::model::spec::{ByDefault, SceneSpec};
use crate::model::steps::{Factors, Steps};
use crate::rows::{left_out, opposed};
use base::{Error, Result};
use std::collections::{HashMap, HashSet};

/// All pairs that touch, with their ties and contacts, and sentences on what the entries that name surfaces leave out.
pub(crate) fn find_interfaces(
    bodies: &[Body],
    mut matching: NodeMatching<'_>,
    (spec, origins): (&SceneSpec, &[SideOrigin]),
    steps: &Option<Steps>,
) -> Result<(Vec<BodyInterface>, LeftOut)> {
    let mut interfaces = touching(bodies)?;
    unmatched(bodies, &mut matching, spec, &mut interfaces);
    let far = facing(bodies, matching, spec, &mut interfaces)?;
    let left_out = left_out::sentences(bodies, origins, &interfaces, &far);
    opposed::add(bodies, spec, &mut interfaces);
    let (ties, contacts) = (&spec.ties, &spec.contacts);
    let mut entries = Entries::new(bodies, ties, contacts)?;
    let zero = Profile::constant(0.0);
    let default = default(spec, &zero);
    let mut weak = Vec::new();
    for (k, interface) in interfaces.iter_mut().enumerate() {
        entries.apply(bodies, interface, default.as_ref(), Factors::last(steps))?;
        let tied = |i: &BodyInterface| i.shared.iter().any(|s| s.link == Link::Tied);
        let is_corner = interface.shape == InterfaceShape::Corner;
        if is_corner && tied(interface) && !entries.tie_names(interface.bodies) {
            weak.push(k);
        }
    }
    entries.check_used(&interfaces)?;
    release_corners(&mut interfaces, &weak);
    Ok((interfaces, left_out))
}

/// Joins interfaces of bodies that have moved as the contacts of `spec` say. A contact that selects none of their nodes
/// any more has none.
pub(crate) fn rejoin(
    bodies: &[Body],
    interfaces: &mut [BodyInterface],
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
        pair: &PairSelector::All,
        extent: &Extent::All,
        location: None,
        gap: (spec.default == ByDefault::Contact).then_some(zero),
        id: None,
        names_sides: false,
    };
    (spec.default != ByDefault::Free).then_some(default)
}

/// Removes unwanted corner ties. The corner pairs in `weak` are tied only because an entry ties all pairs. If one of
/// the two nodes is in contact elsewhere, the tie would close that contact and is removed.
fn release_corners(interfaces: &mut [BodyInterface], weak: &[usize]) {
    if weak.is_empty() {
        return;
    }
    let mut in_contact: HashSet<(usize, usize)> = HashSet::new();
    for i in interfaces.iter() {
        for s in i.shared.iter().filter(|s| s.link.is_contact()) {
            in_contact.extend([0, 1].map(|k| (i.bodies[k], s.nodes[k])));
        }
    }
    for &k in weak {
        let BodyInterface { bodies, shared, .. } = &mut interfaces[k];
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
        let contacts = contacts.map(|(number, spec)| Entry::contact(number, spec));
        let ties = ties.iter().enumerate().map(|(k, spec)| Entry::tie(k, spec));
        for entry in ties.chain(contacts) {
            let (first, second) = match entry.pair {
                PairSelector::All => {
                    entries.all.push((entry, false));
                    continue;
                }
                PairSelector::Named(first, second) => (first, second),
                // Surfaces have been replaced by bodies and sides before.
                PairSelector::Surfaces(..) => continue,
            };
            let find = |name: &String| {
                index.get(name.as_str()).copied().ok_or_else(|| {
                    Error::input(format!(
                        "a {} names body `{name}`, which the scene does not have (bodies are {})",
                        entry.what(),
                        some_names(bodies)
                    ))
                    .at(entry.location)
                })
            };
            let (a, b) = (find(first)?, find(second)?);
            if a == b && !entry.names_sides {
                return Err(Error::input(format!(
                    "a {} names body `{first}` twice where two bodies were expected (or `sides`, two sides of it)",
                    entry.what()
                ))
                .at(entry.location));
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
        named.into_iter().any(|(e, _)| !e.is_contact())
    }

    /// Sets the links of one interface. Entries replace the default and add up. Entries that name the pair override
    /// contacts of all pairs; a contact that names the pair overrides ties of all pairs.
    fn apply(
        &mut self,
        bodies: &[Body],
        interface: &mut BodyInterface,
        default: Option<&Entry<'a>>,
        last: Factors<'_>,
    ) -> Result<()> {
        let named = self.named.get(&interface.bodies).into_iter().flatten();
        let named = named.filter(|(e, _)| !e.names_sides || e.id == interface.entry);
        let named: Vec<(Entry<'_>, [usize; 2])> = named.copied().collect();
        let contact_named = named.iter().any(|(e, _)| e.is_contact());
        let mut links = Links::new(bodies, interface);
        let speaks = |e: &Entry<'_>| {
            if e.is_contact() {
                named.is_empty()
            } else {
                !contact_named
            }
        };
        // Ties come first: contacts need to know which nodes are tied.
        for contact in [false, true] {
            for (entry, used) in &mut self.all {
                if entry.is_contact() == contact {
                    // An entry that is overridden everywhere is no mistake.
                    *used |= !speaks(entry) || links.add(*entry, None)? > 0;
                }
            }
            for (entry, order) in &named {
                if entry.is_contact() == contact {
                    let selected = links.add(*entry, Some(*order))?;
                    if selected == 0 && *entry.extent != Extent::None && !self.moved {
                        let [a, b] = links.names();
                        return Err(Error::input(format!(
                            "the {} of {} selects no node of their common face",
                            entry.what(),
                            both(a, b)
                        ))
                        .at(entry.location));
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
    fn check_used(&self, interfaces: &[BodyInterface]) -> Result<()> {
        let touching: HashSet<[usize; 2]> = interfaces.iter().map(|i| i.bodies).collect();
        let mut apart: Vec<&Entry<'_>> = self
            .named
            .iter()
            .filter(|(pair, _)| !touching.contains(*pair))
            .flat_map(|(_, list)| list.iter().map(|(entry, _)| entry))
            .collect();
        apart.sort_by(|a, b| a.location.cmp(&b.location));
        if let Some(entry) = apart.first() {
            let PairSelector::Named(a, b) = entry.pair else {
                unreachable!("only named pairs are in the map")
            };
            return Err(Error::input(format!(
                "a {} joins bodies `{a}` and `{b}`, which do not touch",
                entry.what()
            ))
            .at(entry.location));
        }
        for (entry, used) in &self.all {
            if *entry.extent != Extent::None && !used {
                return Err(Error::input(format!(
                    "the {} of all bodies selects no node of any common face",
                    entry.what()
                ))
                .at(entry.location));
            }
        }
        Ok(())
    }
}
