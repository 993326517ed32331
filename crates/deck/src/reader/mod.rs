//! From cards to a deck, in the order in which CalculiX takes them: nodes, elements, sets, surfaces, systems of
//! coordinates, materials, interactions, amplitudes, ties, contact pairs, then the rest as it stands. So names may be
//! used before they are defined, except that sets contain only sets before them.

mod base;
mod contact;
mod elastic;
mod gaps;
mod heat;
mod held;
mod ids;
mod interactions;
mod loads;
mod materials;
mod named;
mod nodes;
mod output;
mod params;
mod rows;
mod sets;
mod steps;

pub(super) use base::DeckReader;

use super::cards::{Card, Cards};
use super::deck_line::Note;
use super::keywords::{verdict, KeywordTreatment};
use super::model::Deck;
use super::numbers::clip;
use ::base::Result;
use mesh::MeshFile;

impl<'a> DeckReader<'a> {
    /// The mesh of the deck; the rest is not looked at.
    pub fn mesh(mut self) -> Result<MeshFile> {
        self.check_keywords()?;
        self.read_mesh()?;
        Ok(self.deck.mesh)
    }

    /// The deck.
    pub fn deck(mut self) -> Result<Deck> {
        self.check_keywords()?;
        self.read_mesh()?;
        self.check_plane()?;
        let surfaces = self.surface_groups();
        self.each(&["TRANSFORM"], Self::transform)?;
        self.order_transforms()?;
        self.each(&["ORIENTATION"], Self::orientation)?;
        self.read_materials()?;
        self.read_interactions()?;
        self.each(&["AMPLITUDE"], Self::amplitude)?;
        self.each(&["TIE"], |r, c| r.tie(c, &surfaces))?;
        self.each(&["CONTACTPAIR"], |r, c| r.contact_pair(c, &surfaces))?;
        self.each(&["CLEARANCE"], Self::clearance)?;
        self.deck.cell_section = vec![u32::MAX; self.deck.mesh.cells.len()];
        for card in &self.cards.cards {
            self.rest(card)?;
        }
        self.finish_gaps()?;
        self.end()?;
        self.deck.files = self.files.clone();
        Ok(self.deck)
    }

    /// Reads a card that takes effect where it stands.
    fn rest(&mut self, card: &'a Card) -> Result<()> {
        match card.keyword.as_str() {
            "SOLIDSECTION" => self.solid_section(card),
            "EQUATION" => self.equation(card),
            "MPC" => self.mpc(card),
            "INITIALCONDITIONS" => self.initial_conditions(card),
            "RESTART" => self.restart(card),
            "STEP" => self.step(card),
            "STATIC" => self.static_step(card),
            "CHANGEFRICTION" => self.change_friction(card),
            "FRICTION" => self.friction_in_step(card),
            "ENDSTEP" => self.end_step(card),
            "BOUNDARY" => self.boundary(card),
            "CLOAD" => self.cload(card),
            "DLOAD" | "DSLOAD" => self.dload(card),
            "TEMPERATURE" => self.temperature(card),
            "NODEPRINT" => self.node_print(card),
            "NODEFILE" | "NODEOUTPUT" | "ELFILE" | "ELEMENTOUTPUT" => self.field_request(card),
            _ => Ok(()),
        }
    }

    /// Refuses the first keyword that is not supported, and lists those that are ignored.
    fn check_keywords(&mut self) -> Result<()> {
        for card in &self.cards.cards {
            let refused = |name: &str, reason| {
                let message = format!("*{name}: {reason}");
                Err(self.files.error(card.place, message))
            };
            match verdict(&card.keyword) {
                Some((name, KeywordTreatment::RefusedMesh(reason))) => {
                    return refused(name, reason)
                }
                _ if !self.whole => {}
                Some((name, KeywordTreatment::Refused(reason))) => return refused(name, reason),
                Some((name, KeywordTreatment::Ignored(reason))) => self.deck.ignored.push(Note {
                    keyword: format!("*{name}"),
                    place: card.place,
                    reason: reason.to_string(),
                }),
                Some(_) => {}
                None => {
                    let name = clip(&card.keyword);
                    return refused(&name, "this keyword is unknown");
                }
            }
        }
        Ok(())
    }

    fn read_mesh(&mut self) -> Result<()> {
        self.deck.mesh.name = self.files.0[0].clone();
        self.each(&["NODE"], Self::node)?;
        self.deck.mesh.resolution = self.digits.resolution().max(self.cards.resolution);
        self.nodes.sort();
        self.each(&["ELEMENT"], Self::element)?;
        self.cells.sort();
        self.each(&["NSET"], Self::nset)?;
        self.each(&["ELSET"], Self::elset)?;
        self.each(&["SURFACE"], Self::surface)?;
        self.make_groups();
        Ok(())
    }

    /// Reads the cards that have one of `keywords`, in order.
    fn each(
        &mut self,
        keywords: &[&str],
        mut read: impl FnMut(&mut Self, &'a Card) -> Result<()>,
    ) -> Result<()> {
        let cards: &'a Cards = self.cards;
        for card in &cards.cards {
            if keywords.contains(&card.keyword.as_str()) {
                read(self, card)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
#[path = "../../tests/reader/mod.rs"]
mod tests;
