//! Gap elements (GAPUNI) and *GAP.
//!
//! They are no cells of the mesh. In element sets they stand beside cells, at places of their own from [`FIRST`] on.

use super::base::{title, DeckReader};
use super::params::Params;

use crate::cards::{Card, DataLine};
use crate::deck_line::DeckLine;
use crate::gap::{Gap, GapElement};
use crate::joint::{Interaction, Overclosure};
use crate::numbers::clip;
use base::linalg::vec3::norm;
use base::Result;
use std::collections::HashMap;

/// The place of the first gap element in sets; those of cells are lower.
pub(super) const FIRST: u32 = 1 << 28;

/// How far the length of a direction may be from 1: cosines are written with few digits.
const COSINES: f64 = 0.01;

/// The gap elements as far as they are read.
#[derive(Default)]
pub(super) struct Gaps {
    elements: Vec<GapElement>,
    /// The *GAP of each element, as a place in [`Deck::gaps`](crate::Deck::gaps).
    of_element: Vec<Option<usize>>,
    /// The interaction of the last *GAP of each element set.
    pub interactions: HashMap<String, u32>,
    /// The interactions of the *GAP that give a spring constant.
    springs: Vec<usize>,
}

impl Gaps {
    /// Adds an element and returns its place in sets.
    pub fn add(&mut self, element: GapElement) -> u32 {
        self.elements.push(element);
        self.of_element.push(None);
        FIRST + self.elements.len() as u32 - 1
    }

    /// Whether `interaction` is that of a *GAP, and whether it has a spring constant.
    pub fn law(&self, interaction: usize) -> (bool, bool) {
        let own = (self.interactions.values()).any(|&i| i as usize == interaction);
        (own, self.springs.contains(&interaction))
    }
}

impl<'a> DeckReader<'a> {
    /// Reads a *GAP, and makes an interaction of its law; the place of the interaction is returned.
    pub(super) fn gap(&mut self, card: &'a Card) -> Result<usize> {
        let mut params = Params::new(card, self.files);
        let elset = params.required("ELSET")?;
        params.done()?;
        let rows: Vec<DataLine> = self.cards.rows(card).collect();
        let [row] = &rows[..] else {
            let message = format!(
                "one line with clearance and direction is expected, but {} follow",
                rows.len()
            );
            return self.error(card, message);
        };
        row.at_most(self.files, 7, "a gap")?;
        let clearance = row.real(self.files, 0, "a clearance")?;
        let direction = self.gap_direction(card, row)?;
        let positive = |k: usize, what: &str| match row.field(k) {
            "" => Ok(None),
            _ => match row.real(self.files, k, what)? {
                value if value > 0.0 => Ok(Some(value)),
                value => {
                    let message = format!("{what} is {value}; it must be positive");
                    self.error(card, message)
                }
            },
        };
        let area = positive(4, "an area")?.unwrap_or(1.0);
        let spring = positive(5, "a spring constant")?;
        if row.real_or(self.files, 6, 0.0, "a force")? != 0.0 {
            let reason = "the force at infinite clearance of CalculiX counts as 0";
            self.deck.replaced.push(Self::note(card, row.place, reason));
        }
        let number = self.deck.gaps.len();
        self.assign(card, elset, number)?;
        let interaction = self.deck.interactions.len();
        self.deck.interactions.push(Interaction {
            name: format!("*GAP of {elset}"),
            overclosure: match spring {
                Some(spring) => Overclosure::Linear {
                    slope: spring / area,
                },
                None => Overclosure::Hard,
            },
            place: card.place,
        });
        self.state.friction.push(None);
        let interactions = &mut self.gaps.interactions;
        interactions.insert(elset.to_string(), interaction as u32);
        if spring.is_some() {
            self.gaps.springs.push(interaction);
        }
        self.deck.gaps.push(Gap {
            elset: elset.to_string(),
            elements: Vec::new(),
            clearance,
            direction,
            area,
            interaction: interaction as u32,
            place: card.place,
        });
        Ok(interaction)
    }

    /// The direction that a *GAP gives, if it gives one.
    fn gap_direction(&mut self, card: &Card, row: &DataLine) -> Result<Option<[f64; 3]>> {
        let mut direction = [0.0; 3];
        for (k, x) in direction.iter_mut().enumerate() {
            *x = row.real_or(self.files, k + 1, 0.0, "a component of the direction")?;
        }
        let length = norm(direction);
        if length == 0.0 {
            let reason =
                "without a direction it is that from the first node to the second, as in Abaqus";
            self.deck.replaced.push(Self::note(card, row.place, reason));
            return Ok(None);
        }
        if (length - 1.0).abs() > COSINES {
            let message = format!("the direction has length {length}; it must be 1");
            return self.error(card, message);
        }
        if self.deck.dim() == 2 && direction[2] != 0.0 {
            let message = "the direction must lie in the plane of the elements";
            return self.error(card, message);
        }
        Ok(Some(direction.map(|x| x / length)))
    }

    /// Gives the elements of a set to a *GAP.
    fn assign(&mut self, card: &Card, elset: &str, gap: usize) -> Result<()> {
        let Some(set) = self.elsets.get(elset) else {
            return self.error(card, format!("there is no element set {}", clip(elset)));
        };
        let places: Vec<Option<u32>> = (set.members.iter())
            .map(|place| place.checked_sub(FIRST))
            .collect();
        for (k, place) in places.iter().enumerate() {
            let Some(place) = *place else {
                let id = self.cell_id(set.members[k]);
                let message = format!("element {id} of {} is no gap element (GAPUNI)", clip(elset));
                return self.error(card, message);
            };
            self.gaps.of_element[place as usize] = Some(gap);
        }
        self.spend(places.len(), card.place)
    }

    /// Gives each *GAP its elements, and checks them.
    pub(super) fn finish_gaps(&mut self) -> Result<()> {
        let elements = std::mem::take(&mut self.gaps.elements);
        for (element, gap) in elements.iter().zip(&self.gaps.of_element) {
            let fail = |why: &str| {
                let message = format!("gap element {} {why}", element.id);
                Err(self.files.error(element.place, message))
            };
            let Some(gap) = *gap else {
                return fail("belongs to no *GAP");
            };
            let [a, b] = element.nodes.map(|k| self.deck.mesh.points[k as usize]);
            if element.nodes[0] == element.nodes[1] {
                return fail("has the same node twice");
            }
            if self.deck.gaps[gap].direction.is_none() && a == b {
                return fail("has no direction: its nodes coincide, and its *GAP gives none");
            }
            self.deck.gaps[gap].elements.push(*element);
        }
        Ok(())
    }

    /// The cells among these places; an error if there are none but gap elements.
    pub(super) fn cells_among(&self, mut places: Vec<u32>, place: DeckLine) -> Result<Vec<u32>> {
        places.retain(|&place| place < FIRST);
        if places.is_empty() {
            let message = "gap elements have neither sides nor loads";
            return Err(self.files.error(place, message));
        }
        Ok(places)
    }

    /// The interaction that a *CHANGE FRICTION names by the element set of a *GAP.
    pub(super) fn gap_interaction(&self, card: &Card, elset: &str) -> Result<u32> {
        match self.gaps.interactions.get(elset) {
            Some(&interaction) => Ok(interaction),
            None => {
                let message = format!("{}: there is no *GAP of {}", title(card), clip(elset));
                Err(self.files.error(card.place, message))
            }
        }
    }
}
