//! Which of the nodes where bodies touch are tied: the default, and the entries of [[tie]].

use super::interface::{touching, Interface, Link, Shape, TOLERANCE};
use super::spec::{Extent, Pair, TieSpec};
use super::Body;
use crate::error::{Error, Result};
use std::collections::{HashMap, HashSet};

/// Tolerance of the face parameter t.
const T_TOLERANCE: f64 = 1e-9;

/// All pairs that touch, with their ties.
pub(super) fn find(bodies: &[Body], tied: bool, ties: &[TieSpec]) -> Result<Vec<Interface>> {
    let mut interfaces = touching(bodies)?;
    let entries = Entries::new(bodies, ties)?;
    for interface in &mut interfaces {
        entries.apply(bodies, interface, tied)?;
    }
    entries.check_used(&interfaces)?;
    Ok(interfaces)
}

/// The entries of [[tie]], by pair.
struct Entries<'a> {
    all: Vec<&'a TieSpec>,
    named: HashMap<[usize; 2], Vec<&'a TieSpec>>,
}

impl<'a> Entries<'a> {
    fn new(bodies: &[Body], ties: &'a [TieSpec]) -> Result<Entries<'a>> {
        let index: HashMap<&str, usize> = bodies
            .iter()
            .enumerate()
            .map(|(k, b)| (b.spec.name.as_str(), k))
            .collect();
        let mut entries = Entries {
            all: Vec::new(),
            named: HashMap::new(),
        };
        for tie in ties {
            let (first, second) = match &tie.pair {
                Pair::All => {
                    entries.all.push(tie);
                    continue;
                }
                Pair::Named(first, second) => (first, second),
            };
            let find = |name: &String| {
                index.get(name.as_str()).copied().ok_or_else(|| {
                    Error::Input(format!(
                        "{}a tie names body `{name}`, which the scene does not have (bodies are {})",
                        tie.written,
                        some_names(bodies)
                    ))
                })
            };
            let (a, b) = (find(first)?, find(second)?);
            if a == b {
                return Err(Error::Input(format!(
                    "{}a tie names body `{first}` twice where two bodies were expected",
                    tie.written
                )));
            }
            entries
                .named
                .entry([a.min(b), a.max(b)])
                .or_default()
                .push(tie);
        }
        Ok(entries)
    }

    /// Sets the links of one interface. Entries replace the default and add up.
    fn apply(&self, bodies: &[Body], interface: &mut Interface, tied: bool) -> Result<()> {
        let named = self.named.get(&interface.bodies);
        let mut listed = self
            .all
            .iter()
            .chain(named.into_iter().flatten())
            .peekable();
        if listed.peek().is_none() {
            if tied {
                select(bodies, interface, &Extent::All, "")?;
            }
            return Ok(());
        }
        for tie in listed {
            if tie.extent != Extent::None {
                // Of a face that is tied in part, the rest is a candidate for contact: [Lee]'s Γ_gl around his Γ_gl^k.
                for node in interface.shared.iter_mut().filter(|s| s.link == Link::Free) {
                    node.link = Link::Open;
                }
            }
            let selected = select(bodies, interface, &tie.extent, &tie.written)?;
            if selected == 0 && tie.pair != Pair::All && tie.extent != Extent::None {
                let [a, b] = interface.bodies.map(|k| &bodies[k].spec.name);
                return Err(Error::Input(format!(
                    "{}the tie of bodies `{a}` and `{b}` selects no node of their common face",
                    tie.written
                )));
            }
        }
        Ok(())
    }

    /// Every entry must have found a pair that touches, and an entry for all pairs at least one node.
    fn check_used(&self, interfaces: &[Interface]) -> Result<()> {
        let touching: HashSet<[usize; 2]> = interfaces.iter().map(|i| i.bodies).collect();
        let mut apart: Vec<&TieSpec> = self
            .named
            .iter()
            .filter(|(pair, _)| !touching.contains(*pair))
            .flat_map(|(_, ties)| ties.iter().copied())
            .collect();
        apart.sort_by(|a, b| a.written.cmp(&b.written));
        if let Some(tie) = apart.first() {
            let Pair::Named(a, b) = &tie.pair else {
                unreachable!("only named pairs are in the map")
            };
            return Err(Error::Input(format!(
                "{}a tie joins bodies `{a}` and `{b}`, which do not touch",
                tie.written
            )));
        }
        for tie in &self.all {
            let selects = |i: &Interface| i.shared.iter().any(|s| s.link == Link::Tied);
            if tie.extent != Extent::None && !interfaces.iter().any(selects) {
                return Err(Error::Input(format!(
                    "{}the tie of all bodies selects no node of any common face",
                    tie.written
                )));
            }
        }
        Ok(())
    }
}

/// The first few names, for messages.
fn some_names(bodies: &[Body]) -> String {
    let mut names: Vec<String> = bodies
        .iter()
        .take(6)
        .map(|b| format!("`{}`", b.spec.name))
        .collect();
    if bodies.len() > 6 {
        names.push("…".into());
    }
    names.join(", ")
}

/// Ties the nodes in `extent` and returns how many there are.
fn select(
    bodies: &[Body],
    interface: &mut Interface,
    extent: &Extent,
    written: &str,
) -> Result<usize> {
    if interface.shape == Shape::Corner {
        let tie = *extent == Extent::All;
        if tie {
            interface.shared[0].link = Link::Tied;
        }
        return Ok(usize::from(tie));
    }
    let unmatched = |(t, side, node): (f64, usize, usize)| {
        let has = &bodies[interface.bodies[side]];
        let other = &bodies[interface.bodies[1 - side]];
        let [x, y] = has.mesh().position(has.mesh().place(node));
        // The later of the two bodies is the one that was put beside the other.
        let later = &bodies[interface.bodies[1]].spec.written;
        let place = if written.is_empty() { later } else { written };
        Error::Input(format!(
            "{place}bodies `{}` and `{}` are tied, but node ({x}, {y}) of `{}` (t = {t}) meets no node of `{}` \
             (matching nodes were expected on a tied face)",
            bodies[interface.bodies[0]].spec.name,
            bodies[interface.bodies[1]].spec.name,
            has.spec.name,
            other.spec.name,
        ))
    };
    let range = match extent {
        Extent::None => return Ok(0),
        Extent::All => [0.0, 1.0],
        Extent::Range(range) => *range,
        Extent::Points(points) => {
            for &wanted in points {
                let near = |t: f64| (t - wanted).abs() <= TOLERANCE;
                match interface.shared.iter_mut().find(|s| near(s.t)) {
                    Some(node) => node.link = Link::Tied,
                    None => {
                        return match interface.unmatched.iter().find(|u| near(u.0)) {
                            Some(&u) => Err(unmatched(u)),
                            None => Err(no_node(
                                bodies,
                                interface,
                                format_args!("t = {wanted}"),
                                written,
                            )),
                        }
                    }
                }
            }
            return Ok(points.len());
        }
        Extent::Nodes(nodes) => {
            // Numbers count the nodes of the common face; they make sense only where both bodies have the same.
            if let Some(&u) = interface.unmatched.first() {
                return Err(unmatched(u));
            }
            for &k in nodes {
                match interface.shared.get_mut(k) {
                    Some(node) => node.link = Link::Tied,
                    None => {
                        return Err(no_node(
                            bodies,
                            interface,
                            format_args!("number {k}"),
                            written,
                        ))
                    }
                }
            }
            return Ok(nodes.len());
        }
    };
    let inside = |t: f64| range[0] - T_TOLERANCE <= t && t <= range[1] + T_TOLERANCE;
    if let Some(&u) = interface.unmatched.iter().find(|u| inside(u.0)) {
        return Err(unmatched(u));
    }
    let mut selected = 0;
    for node in interface.shared.iter_mut().filter(|s| inside(s.t)) {
        node.link = Link::Tied;
        selected += 1;
    }
    Ok(selected)
}

fn no_node(
    bodies: &[Body],
    interface: &Interface,
    which: std::fmt::Arguments<'_>,
    written: &str,
) -> Error {
    let [a, b] = interface.bodies.map(|k| &bodies[k].spec.name);
    Error::Input(format!(
        "{written}the tie of bodies `{a}` and `{b}` names the node with {which}, but their common face has {} nodes \
         and none like that",
        interface.shared.len()
    ))
}
