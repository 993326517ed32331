//! Where the mesh of a deck is torn: a note, no error.
//!
//! A deck says by itself what is joined: CalculiX takes two nodes at one place for two nodes, as at a crack, and decks
//! may join some nodes of a tear by equations. A scene has no equations: in its mesh a tear is a mistake.

use std::collections::{BTreeMap, HashSet};

use super::bodies::Extracted;
use super::numbers::DeckNumbering;
use deck::Deck;
use mesh::{defects, of_both_sides, Defect};

/// A sentence for each kind of defect in the bodies of a deck.
pub(super) fn notes(deck: &Deck, numbers: &DeckNumbering, meshes: &[Extracted]) -> Vec<String> {
    let mut joined = vec![HashSet::new(); numbers.parts.len()];
    let terms = deck.equations.iter().flat_map(|e| &e.terms);
    for at in terms.filter_map(|term| numbers.node(term.node)) {
        joined[at.body].insert(at.node as u32);
    }
    // By what was expected, which each kind has of its own.
    let mut found: BTreeMap<&str, Defect> = BTreeMap::new();
    let ties = deck.ties.iter().map(|t| [&t.slave, &t.master]);
    let contacts = deck.contacts.iter().map(|c| [&c.slave, &c.master]);
    let joints: Vec<[&str; 2]> = ties
        .chain(contacts)
        .map(|both| both.map(|surface| surface.name.as_str()))
        .collect();
    for (mesh, joined) in meshes.iter().zip(&mut joined) {
        // A mesh that cannot be extracted gets its sentence when the scene is made.
        let Ok(mesh) = mesh else {
            continue;
        };
        joined.extend(of_both_sides(mesh, joints.iter().copied()));
        for defect in defects(mesh, joined) {
            let known = found.get_mut(defect.expected);
            match known {
                Some(known) => known.places += defect.places,
                None => drop(found.insert(defect.expected, defect)),
            }
        }
    }
    let note = |defect: &Defect| {
        let more = match defect.places {
            1 => String::new(),
            n => format!(" (one of {n} such places)"),
        };
        let (file, first) = (&deck.mesh.name, &defect.first);
        format!("{file}: {first}{more}; solved as it is, as CalculiX does")
    };
    found.values().map(note).collect()
}
