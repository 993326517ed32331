//! *MATERIAL with its *DENSITY, *SOLID SECTION, *INITIAL CONDITIONS.

use super::base::DeckReader;
use super::gaps;
use super::named::increasing;
use super::params::Params;

use crate::cards::Card;
use crate::deck_line::Note;
use crate::element::ElementModel;
use crate::keywords::{verdict, KeywordTreatment};
use crate::model::{DeckMaterial, Section};
use crate::numbers::clip;
use base::Result;

impl<'a> DeckReader<'a> {
    /// Reads the materials: a property belongs to the *MATERIAL before it.
    pub(super) fn read_materials(&mut self) -> Result<()> {
        let cards: &'a [Card] = &self.cards.cards;
        let mut current = None;
        for card in cards {
            match (card.keyword.as_str(), verdict(&card.keyword)) {
                ("MATERIAL", _) => current = Some(self.material(card)?),
                ("ELASTIC", _) => self.elastic(card, current)?,
                ("DENSITY", _) => {
                    let density = self.constant(card, 1)?[0];
                    if density < 0.0 {
                        return self.error(card, format!("the density is {density}"));
                    }
                    self.current(card, current)?.density = Some(density);
                }
                ("EXPANSION", _) => {
                    let expansion = self.expansion(card)?;
                    self.current(card, current)?.expansion = Some(expansion);
                }
                (_, Some((_, KeywordTreatment::InMaterial(reason)))) => {
                    let note = Self::note(card, card.place, reason);
                    let material = self.current(card, current)?;
                    material.refused.get_or_insert(note);
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn material(&mut self, card: &'a Card) -> Result<usize> {
        let mut params = Params::new(card, self.files);
        let name = params.required("NAME")?;
        params.done()?;
        let m = self.deck.materials.len();
        if self.materials.insert(name.to_string(), m as u32).is_some() {
            return self.error(
                card,
                format!("the material {} is defined before", clip(name)),
            );
        }
        self.deck.materials.push(DeckMaterial {
            name: name.to_string(),
            elastic: None,
            density: None,
            expansion: None,
            place: card.place,
            refused: None,
        });
        Ok(m)
    }

    /// The material to which a property belongs.
    pub(super) fn current(
        &mut self,
        card: &Card,
        current: Option<usize>,
    ) -> Result<&mut DeckMaterial> {
        match current {
            Some(m) => Ok(&mut self.deck.materials[m]),
            None => self.error(card, "there is no *MATERIAL before it"),
        }
    }

    /// The `n` numbers of a property. Further lines are for other temperatures and must say the same.
    pub(super) fn constant(&self, card: &'a Card, n: usize) -> Result<Vec<f64>> {
        let mut constants: Option<Vec<f64>> = None;
        for row in self.cards.rows(card) {
            row.at_most(self.files, n + 1, "a line of this property")?;
            let now: Vec<f64> = (0..n)
                .map(|k| row.real(self.files, k, "a constant of the material"))
                .collect::<Result<_>>()?;
            match &constants {
                None => constants = Some(now),
                Some(before) if *before == now => {}
                Some(_) => {
                    let message = "properties that depend on temperature are not supported";
                    return Err(self.files.error(row.place, message));
                }
            }
        }
        match constants {
            Some(constants) => Ok(constants),
            None => self.error(card, "its line of data is missing"),
        }
    }

    pub(super) fn solid_section(&mut self, card: &'a Card) -> Result<()> {
        self.before_steps(card)?;
        let mut params = Params::new(card, self.files);
        let elset = params.required("ELSET")?;
        let material = params.required("MATERIAL")?;
        params.refuse(
            &["COMPOSITE", "CONTROLS", "NODALTHICKNESS"],
            "this is not supported",
        )?;
        let orientation = params.value("ORIENTATION");
        if params.real("OFFSET")?.is_some_and(|x| x != 0.0) {
            return params.error("OFFSET is for shells and beams");
        }
        params.done()?;
        let Some(&material) = self.materials.get(material) else {
            return self.error(card, format!("there is no material {}", clip(material)));
        };
        let orientation = match orientation {
            None => None,
            Some(name) => match self.orientations.get(name) {
                Some(&place) => Some(place),
                None => return self.error(card, format!("there is no orientation {}", clip(name))),
            },
        };
        let Some(set) = self.elsets.get(elset) else {
            return self.error(card, format!("there is no element set {}", clip(elset)));
        };
        let mut cells = increasing(&set.members);
        // CalculiX's decks give sections to gap elements, too; they need none.
        cells.retain(|&c| c < gaps::FIRST);
        let found = &self.deck.materials[material as usize];
        if let Some(Note {
            keyword,
            place,
            reason,
        }) = &found.refused
        {
            let message =
                format!("{keyword}: {reason} (the elements of {elset} have this material)");
            return Err(self.files.error(*place, message));
        }
        if found.elastic.is_none() {
            let name = found.name.clone();
            return self.error(card, format!("the material {name} has no *ELASTIC"));
        }
        let mut thickness = 1.0;
        let mut rows = self.cards.rows(card);
        if let Some(row) = rows.next() {
            thickness = row.real_or(self.files, 0, 1.0, "a thickness")?;
            if thickness <= 0.0 && self.deck.dim() == 2 {
                let message = format!("the thickness is {thickness}; it must be positive");
                return Err(self.files.error(row.place, message));
            }
        }
        if let Some(row) = rows.next() {
            return Err(self
                .files
                .error(row.place, "a section has one line of data at most"));
        }
        if matches!(
            self.deck.model(),
            ElementModel::Solid | ElementModel::Axisymmetric
        ) {
            thickness = 1.0;
        }
        let section = self.deck.sections.len() as u32;
        self.spend(cells.len(), card.place)?;
        for cell in cells {
            self.deck.cell_section[cell as usize] = section;
        }
        self.deck.sections.push(Section {
            elset: elset.to_string(),
            material,
            thickness,
            orientation,
            place: card.place,
        });
        Ok(())
    }
}
