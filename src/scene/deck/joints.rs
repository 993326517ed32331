//! What joins the bodies of a deck: *TIE, *CONTACT PAIR, *EQUATION.

use super::bodies::along_coordinates;
use super::numbers::Numbers;
use crate::error::Result;
use crate::mesh::deck::{Adjust, ContactPair, Deck, Overclosure};
use crate::mesh::Members;
use crate::scene::model::joints::{ContactSpec, EquationSpec, Extent, Pair, TieSpec};
use crate::scene::model::profile::Profile;
use crate::substructures::BodyNode;
use std::collections::BTreeSet;

/// The ties, among them the contact pairs that tie.
pub(super) fn ties(deck: &Deck) -> Vec<TieSpec> {
    let tie = |slave: &str, master: &str, tolerance: Option<f64>, written: String| TieSpec {
        pair: Pair::Surfaces(slave.into(), master.into()),
        sides: None,
        extent: Extent::All,
        multipliers: None,
        adjust: tolerance.unwrap_or(0.0),
        written,
    };
    let ties = deck.ties.iter();
    let mut out: Vec<TieSpec> = ties
        .map(|t| {
            tie(
                &t.slave.name,
                &t.master.name,
                t.tolerance,
                at(deck, t.place),
            )
        })
        .collect();
    for pair in &deck.contacts {
        let interaction = &deck.interactions[pair.interaction as usize];
        if matches!(interaction.overclosure, Overclosure::Tied { .. }) {
            out.push(tie(
                &pair.slave.name,
                &pair.master.name,
                None,
                at(deck, pair.place),
            ));
        }
    }
    out
}

/// The contact pairs that do not tie; soft laws are hard here. The masters of those that are `exchanged` carry the
/// multipliers.
pub(super) fn contacts(
    deck: &Deck,
    numbers: &Numbers,
    exchanged: &[Option<f64>],
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
            pair: Pair::Surfaces(pair.slave.name.clone(), pair.master.name.clone()),
            sides: None,
            extent: Extent::All,
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
            ramp: None,
            written: at(deck, pair.place),
        });
    }
    Ok(out)
}

/// The nodes of the slave that a contact pair moves onto its master: those of a set.
fn adjusted(
    deck: &Deck,
    numbers: &Numbers,
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
pub(super) fn equations(deck: &Deck, numbers: &Numbers) -> Result<Vec<EquationSpec>> {
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
            written: at(deck, equation.place),
        });
    }
    Ok(out)
}

fn at(deck: &Deck, place: crate::mesh::deck::Place) -> String {
    format!("{}: ", deck.files.at(place))
}
