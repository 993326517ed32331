//! Joints between the bodies of a deck: *TIE, *CONTACT PAIR, *EQUATION.

use super::bodies::along_coordinates;
use super::numbers::DeckNumbering;
use crate::model::friction::{ContactLaw, FrictionSpec};
use crate::model::joints::{ContactSpec, EquationSpec, Extent, PairSelector, TieSpec};
use crate::model::profile::Profile;
use base::{Location, Result};
use deck::{Adjust, ContactPair, Deck, Overclosure, SurfaceName, Tie};
use fetifeti::problem::BodyNode;
use mesh::Members;
use std::collections::{BTreeSet, HashSet};

/// The nodes of a slave within a distance of the master, one by one, as CalculiX joins them.
fn singly(distance: f64) -> Extent {
    Extent::Within {
        distance,
        singly: true,
    }
}

/// Gives the surfaces of ties and contact pairs names that no other boundary group has: a *NSET may have that of a
/// *SURFACE.
pub(super) fn distinguish(deck: &mut Deck) {
    let ties = deck.ties.iter().map(|t| [&t.slave, &t.master]);
    let contacts = deck.contacts.iter().map(|c| [&c.slave, &c.master]);
    let joined = ties.chain(contacts).flatten().map(|s| s.group as usize);
    let joined: BTreeSet<usize> = joined.collect();
    let mut names = HashSet::new();
    let others = (0..deck.mesh.groups.len()).filter(|g| !joined.contains(g));
    for g in joined.iter().copied().chain(others) {
        let group = &mut deck.mesh.groups[g];
        if matches!(group.members, Members::Cells { .. }) {
            continue;
        }
        let own = group.name.clone();
        let mut number = 2;
        while names.contains(&group.name) {
            group.name = format!("{own} ({number})");
            number += 1;
        }
        if joined.contains(&g) {
            names.insert(group.name.clone());
        }
    }
}

/// The two surfaces of a tie or a contact pair.
fn surfaces(deck: &Deck, slave: &SurfaceName, master: &SurfaceName) -> PairSelector {
    let [a, b] = [slave, master].map(|s| deck.mesh.groups[s.group as usize].name.clone());
    PairSelector::Surfaces(a, b)
}

/// The ties, among them the contact pairs that tie.
pub(super) fn ties(deck: &Deck) -> Vec<TieSpec> {
    let tie = |pair: PairSelector, tolerance: Option<f64>, location: Location| TieSpec {
        pair,
        sides: None,
        extent: tolerance.map_or(Extent::All, singly),
        multipliers: None,
        adjust: tolerance.unwrap_or(0.0),
        location,
    };
    let ties = deck.ties.iter();
    let of_tie = |t: &Tie| {
        let pair = surfaces(deck, &t.slave, &t.master);
        tie(pair, t.tolerance, at(deck, t.place))
    };
    let mut out: Vec<TieSpec> = ties.map(of_tie).collect();
    for pair in &deck.contacts {
        let interaction = &deck.interactions[pair.interaction as usize];
        if matches!(interaction.overclosure, Overclosure::Tied { .. }) {
            let both = surfaces(deck, &pair.slave, &pair.master);
            out.push(tie(both, None, at(deck, pair.place)));
        }
    }
    out
}

/// The contact pairs that do not tie, with their laws in a step. The masters of those that are `exchanged` carry the
/// multipliers.
pub(super) fn contacts(
    deck: &Deck,
    numbers: &DeckNumbering,
    exchanged: &[Option<f64>],
    step: usize,
) -> Result<Vec<ContactSpec>> {
    let mut out = Vec::new();
    for (pair, exchanged) in deck.contacts.iter().zip(exchanged) {
        let interaction = &deck.interactions[pair.interaction as usize];
        if matches!(interaction.overclosure, Overclosure::Tied { .. }) {
            continue;
        }
        let (adjust, adjusted) = match &pair.adjust {
            Adjust::No => (0.0, Vec::new()),
            Adjust::Within(distance) => (*distance, Vec::new()),
            Adjust::Nodes(nodes) => (0.0, adjusted(deck, numbers, pair, nodes)?),
        };
        out.push(ContactSpec {
            pair: surfaces(deck, &pair.slave, &pair.master),
            sides: None,
            // Nodes of a slave of nodes may form no faces.
            extent: if pair.slave.nodes {
                singly(f64::INFINITY)
            } else {
                Extent::All
            },
            gap: Profile::constant(pair.clearance.unwrap_or(0.0)),
            distance: None,
            multipliers: exchanged.map(|_| 1),
            // A clearance replaces the geometric gap, whatever that is.
            adjust: if pair.clearance.is_some() {
                f64::INFINITY
            } else {
                adjust
            },
            adjusted,
            opposed: None,
            law: law(deck, pair, step)?,
            ramp: None,
            location: at(deck, pair.place),
        });
    }
    Ok(out)
}

/// The law of a contact pair in a step; EXPONENTIAL and TABULAR pressures are hard here.
fn law(deck: &Deck, pair: &ContactPair, step: usize) -> Result<ContactLaw> {
    let at = pair.interaction as usize;
    let friction = deck.steps[step].friction.get(at).and_then(Option::as_ref);
    let slope = match deck.interactions[at].overclosure {
        Overclosure::Linear { slope } => Some(slope),
        _ => None,
    };
    let stick = friction.and_then(|f| f.stick_slope);
    let limit = friction.and_then(|f| f.limit);
    // Forces of plane bodies are those of their whole thickness.
    let thickness = match [slope, stick, limit] {
        [None, None, None] => 1.0,
        _ => thickness(deck, pair)?,
    };
    let stress = |value: f64| Profile::constant(value * thickness);
    Ok(ContactLaw {
        friction: friction.map(|f| FrictionSpec::Coulomb {
            coefficient: Profile::constant(f.coefficient),
            limit: limit.map(stress),
        }),
        stiffness: slope.map(stress),
        stick_stiffness: stick.map(stress),
    })
}

/// The thickness of the elements at the slave of a contact pair; 1 in space.
fn thickness(deck: &Deck, pair: &ContactPair) -> Result<f64> {
    if deck.dim() == 3 {
        return Ok(1.0);
    }
    let of_cell = |c: usize| deck.sections[deck.cell_section[c] as usize].thickness;
    let cells = &deck.mesh.cells;
    let all: Vec<f64> = match &deck.mesh.groups[pair.slave.group as usize].members {
        Members::Sides(sides) => sides.iter().map(|side| of_cell(side.0 as usize)).collect(),
        Members::Nodes(nodes) => {
            let nodes: HashSet<u32> = nodes.iter().copied().collect();
            let own = |c: &usize| cells.nodes(*c).iter().any(|k| nodes.contains(k));
            (0..cells.len()).filter(own).map(of_cell).collect()
        }
        Members::Cells { .. } => Vec::new(),
    };
    let first = all.first().copied().unwrap_or(1.0);
    match all.iter().find(|&&t| t != first) {
        None => Ok(first),
        Some(other) => Err(deck.files.error(
            pair.place,
            format!(
                "the slave surface {} has elements of thickness {first} and {other} (one was expected beside soft \
                 contact or friction with a stick slope)",
                pair.slave.name
            ),
        )),
    }
}

/// The nodes of the slave that a contact pair moves onto its master: those of a set.
fn adjusted(
    deck: &Deck,
    numbers: &DeckNumbering,
    pair: &ContactPair,
    set: &[u32],
) -> Result<Vec<BodyNode>> {
    let mesh = &deck.mesh;
    let slave: BTreeSet<u32> = match &mesh.groups[pair.slave.group as usize].members {
        Members::Nodes(nodes) => nodes.iter().copied().collect(),
        Members::Sides(sides) => {
            let nodes = |&(c, side): &(u32, u8)| mesh.cells.side_nodes(c as usize, side.into());
            sides.iter().flat_map(nodes).collect()
        }
        Members::Cells { .. } => BTreeSet::new(),
    };
    let both: Vec<u32> = set.iter().copied().filter(|k| slave.contains(k)).collect();
    if both.is_empty() {
        let name = &pair.slave.name;
        return Err(deck.files.error(
            pair.place,
            format!("the node set of ADJUST has no node of the slave surface {name} (one at least was expected)"),
        ));
    }
    Ok(both.into_iter().filter_map(|k| numbers.node(k)).collect())
}

/// The equations between displacements.
pub(super) fn equations(deck: &Deck, numbers: &DeckNumbering) -> Result<Vec<EquationSpec>> {
    let mut out = Vec::new();
    for equation in &deck.equations {
        let mut terms = Vec::new();
        for term in &equation.terms {
            let at = (term.node, term.dof);
            let Some(parts) = along_coordinates(deck, numbers, at, term.factor) else {
                return Err(deck.files.error(
                    equation.place,
                    format!(
                        "an equation with node {}, which no element has",
                        deck.mesh.node_ids[term.node as usize]
                    ),
                ));
            };
            terms.extend(parts);
        }
        out.push(EquationSpec {
            terms,
            value: 0.0,
            resolution: deck.factor_resolution,
            support: false,
            location: at(deck, equation.place),
        });
    }
    Ok(out)
}

pub(super) fn at(deck: &Deck, place: deck::DeckLine) -> Location {
    deck.files.location(place)
}
