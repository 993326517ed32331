//! What joins the bodies of a deck: *TIE, *CONTACT PAIR, *EQUATION.

use super::bodies::along_coordinates;
use super::numbers::Numbers;
use crate::error::Result;
use crate::mesh::deck::{Adjust, Deck, Overclosure};
use crate::scene::model::joints::{ContactSpec, EquationSpec, Extent, Pair, TieSpec};
use crate::scene::model::profile::Profile;

/// The ties, among them the contact pairs that tie.
pub(super) fn ties(deck: &Deck) -> Vec<TieSpec> {
    let tie = |slave: &str, master: &str, tolerance: Option<f64>, written: String| TieSpec {
        pair: Pair::Surfaces(slave.into(), master.into()),
        sides: None,
        extent: Extent::All,
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

/// The contact pairs that do not tie; soft laws are hard here.
pub(super) fn contacts(deck: &Deck) -> Result<Vec<ContactSpec>> {
    let mut out = Vec::new();
    for pair in &deck.contacts {
        let interaction = &deck.interactions[pair.interaction as usize];
        if matches!(interaction.overclosure, Overclosure::Tied { .. }) {
            continue;
        }
        let adjust = match &pair.adjust {
            Adjust::No => 0.0,
            Adjust::Within(distance) => *distance,
            Adjust::Nodes(_) => {
                return Err(deck.files.error(
                    pair.place,
                    "ADJUST with a node set (a distance was expected)",
                ))
            }
        };
        out.push(ContactSpec {
            pair: Pair::Surfaces(pair.slave.name.clone(), pair.master.name.clone()),
            sides: None,
            extent: Extent::All,
            gap: Profile::constant(pair.clearance.unwrap_or(0.0)),
            distance: None,
            // A clearance replaces the geometric gap, whatever that is.
            adjust: if pair.clearance.is_some() {
                f64::INFINITY
            } else {
                adjust
            },
            ramp: None,
            written: at(deck, pair.place),
        });
    }
    Ok(out)
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
            written: at(deck, equation.place),
        });
    }
    Ok(out)
}

fn at(deck: &Deck, place: crate::mesh::deck::Place) -> String {
    format!("{}: ", deck.files.at(place))
}
