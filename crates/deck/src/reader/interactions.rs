//! *SURFACE INTERACTION and *GAP with their *SURFACE BEHAVIOR and *FRICTION, and *CHANGE FRICTION.

use super::base::DeckReader;
use super::params::Params;

use crate::cards::Card;
use crate::joint::{Friction, Interaction, Overclosure};
use crate::numbers::clip;
use base::Result;

/// Without a number the slope of LINEAR is that many times Young's modulus of the first material, as in CalculiX.
const STEEP: f64 = 50.0;

impl<'a> DeckReader<'a> {
    /// Reads the interactions: a property belongs to the *SURFACE INTERACTION or the *GAP before it.
    pub(super) fn read_interactions(&mut self) -> Result<()> {
        let cards: &'a [Card] = &self.cards.cards;
        let mut current = None;
        let mut steps = false;
        for card in cards {
            match card.keyword.as_str() {
                "STEP" => steps = true,
                "SURFACEINTERACTION" | "SURFACEBEHAVIOR" | "GAP" if steps => {
                    return self.error(card, "it must stand before the first *STEP");
                }
                "SURFACEINTERACTION" => current = Some(self.interaction(card)?),
                "GAP" => current = Some(self.gap(card)?),
                "SURFACEBEHAVIOR" => {
                    let overclosure = self.behavior(card)?;
                    let at = self.owner(card, current)?;
                    self.suits_gap(card, at, &overclosure)?;
                    self.deck.interactions[at].overclosure = overclosure;
                }
                "FRICTION" if !steps => {
                    let friction = self.friction(card)?;
                    let at = self.owner(card, current)?;
                    self.state.friction[at] = friction;
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn interaction(&mut self, card: &'a Card) -> Result<usize> {
        let mut params = Params::new(card, self.files);
        let name = params.required("NAME")?;
        params.done()?;
        let i = self.deck.interactions.len();
        if self
            .interactions
            .insert(name.to_string(), i as u32)
            .is_some()
        {
            return self.error(
                card,
                format!("the interaction {} is defined before", clip(name)),
            );
        }
        self.deck.interactions.push(Interaction {
            name: name.to_string(),
            overclosure: Overclosure::Hard,
            place: card.place,
        });
        self.state.friction.push(None);
        Ok(i)
    }

    /// The interaction to which a property belongs.
    fn owner(&self, card: &Card, current: Option<usize>) -> Result<usize> {
        match current {
            Some(i) => Ok(i),
            None => self.error(card, "there is no *SURFACE INTERACTION or *GAP before it"),
        }
    }

    /// The error for a pressure that a gap element cannot have.
    fn suits_gap(&self, card: &Card, interaction: usize, law: &Overclosure) -> Result<()> {
        match (self.gaps.law(interaction), law) {
            ((true, true), _) => {
                self.error(card, "the *GAP before it gives a spring constant already")
            }
            ((true, false), Overclosure::Hard | Overclosure::Linear { .. }) | ((false, _), _) => {
                Ok(())
            }
            _ => self.error(card, "gap elements are HARD or LINEAR"),
        }
    }

    fn behavior(&self, card: &'a Card) -> Result<Overclosure> {
        let mut params = Params::new(card, self.files);
        let kind = params.value("PRESSURE-OVERCLOSURE").unwrap_or("HARD");
        params.refuse(
            &["NOSEPARATION"],
            "surfaces may part again here; write *TIE",
        )?;
        params.skip(&["PENALTY", "DIRECT", "AUGMENTEDLAGRANGE"]);
        let mut rows = self.cards.rows(card);
        let slope = || match self.cards.rows(card).next() {
            None => Ok(None),
            Some(row) => row.real(self.files, 0, "a slope").map(Some),
        };
        let overclosure = match kind {
            "HARD" => Overclosure::Hard,
            "LINEAR" => Overclosure::Linear {
                slope: match slope()? {
                    Some(slope) => slope,
                    None => STEEP * self.first_young(card)?,
                },
            },
            "TIED" => Overclosure::Tied { slope: slope()? },
            "EXPONENTIAL" => match rows.next() {
                None => return self.error(card, "its line of data is missing"),
                Some(row) => Overclosure::Exponential {
                    c0: row.real(self.files, 0, "a gap")?,
                    p0: row.real(self.files, 1, "a pressure")?,
                },
            },
            "TABULAR" => {
                let table: Vec<(f64, f64)> = rows
                    .map(|row| {
                        let pressure = row.real(self.files, 0, "a pressure")?;
                        Ok((pressure, row.real(self.files, 1, "an overclosure")?))
                    })
                    .collect::<Result<_>>()?;
                if table.is_empty() {
                    return self.error(card, "its table is missing");
                }
                Overclosure::Tabular(table)
            }
            _ => {
                let kind = clip(kind);
                return params.error(format!("PRESSURE-OVERCLOSURE={kind} is not supported"));
            }
        };
        params.done()?;
        let positive = match &overclosure {
            Overclosure::Linear { slope } => *slope > 0.0,
            Overclosure::Tied { slope } => slope.is_none_or(|s| s > 0.0),
            Overclosure::Exponential { c0, p0 } => *c0 > 0.0 && *p0 >= 0.0,
            Overclosure::Hard | Overclosure::Tabular(_) => true,
        };
        if positive {
            Ok(overclosure)
        } else {
            self.error(card, "its numbers must be positive")
        }
    }

    /// Young's modulus of the first material, for a card without a slope.
    fn first_young(&self, card: &Card) -> Result<f64> {
        let elastic = self.deck.materials.first().and_then(|m| m.elastic);
        match elastic {
            Some(law) => Ok(law.young()),
            None => self.error(
                card,
                "its slope is missing, and so is *ELASTIC of the first material, from which CalculiX takes it",
            ),
        }
    }

    /// Friction; none where the coefficient is 0.
    fn friction(&mut self, card: &'a Card) -> Result<Option<Friction>> {
        let mut params = Params::new(card, self.files);
        let limit = params.real("TAUMAX")?;
        params.refuse(
            &["ROUGH"],
            "what never slips is not supported; write a large coefficient or *TIE",
        )?;
        // Abaqus's ways to sticking.
        params.skip(&["LAGRANGE", "SLIPTOLERANCE", "ELASTICSLIP"]);
        params.done()?;
        let rows: Vec<_> = self.cards.rows(card).collect();
        let [row] = &rows[..] else {
            let message = format!(
                "one line with coefficient and stick slope is expected, but {} follow",
                rows.len()
            );
            return self.error(card, message);
        };
        row.at_most(self.files, 2, "friction")?;
        let coefficient = row.real(self.files, 0, "a coefficient of friction")?;
        let stick_slope = match row.fields.len() {
            2 => Some(row.real(self.files, 1, "a stick slope")?),
            _ => None,
        };
        let wrong = |what: &str, value: f64, expected: &str| {
            let message = format!("the {what} is {value}; {expected}");
            self.error(card, message)
        };
        if coefficient < 0.0 {
            return wrong(
                "coefficient of friction",
                coefficient,
                "it must not be negative",
            );
        }
        if let Some(slope) = stick_slope.filter(|s| *s <= 0.0) {
            let expected =
                "it must be positive (without the number, surfaces that stick do not slip)";
            return wrong("stick slope", slope, expected);
        }
        if let Some(limit) = limit.filter(|l| *l <= 0.0) {
            return wrong("largest shear stress TAUMAX", limit, "it must be positive");
        }
        if coefficient == 0.0 {
            return Ok(None);
        }
        if stick_slope.is_none() {
            let reason = "without a stick slope surfaces that stick do not slip at all (CalculiX takes half of Young's \
                          modulus of the first material for the slope)";
            self.deck
                .replaced
                .push(Self::note(card, card.place, reason));
        }
        Ok(Some(Friction {
            coefficient,
            stick_slope,
            limit,
        }))
    }

    /// *CHANGE FRICTION: from this step on the *FRICTION that follows holds for the interaction.
    pub(super) fn change_friction(&mut self, card: &'a Card) -> Result<()> {
        let mut params = Params::new(card, self.files);
        if let Some(elset) = params.name("ELSET")? {
            params.done()?;
            self.within_step(card)?;
            self.no_change_pending()?;
            let interaction = self.gap_interaction(card, elset)?;
            self.state.changing = Some((interaction, card.place));
            return Ok(());
        }
        let name = params.required("INTERACTION")?;
        params.done()?;
        self.within_step(card)?;
        self.no_change_pending()?;
        let Some(&interaction) = self.interactions.get(name) else {
            let name = clip(name);
            return self.error(card, format!("there is no surface interaction {name}"));
        };
        self.state.changing = Some((interaction, card.place));
        Ok(())
    }

    /// A *FRICTION where it stands: those before the steps have been read with their interactions.
    pub(super) fn friction_in_step(&mut self, card: &'a Card) -> Result<()> {
        if self.state.number == 0 {
            return Ok(());
        }
        let Some((interaction, _)) = self.state.changing.take() else {
            return self.error(
                card,
                "in a step it must follow a *CHANGE FRICTION, which names the interaction",
            );
        };
        self.state.friction[interaction as usize] = self.friction(card)?;
        Ok(())
    }

    /// The error if a *CHANGE FRICTION has had no *FRICTION.
    pub(super) fn no_change_pending(&self) -> Result<()> {
        match self.state.changing {
            None => Ok(()),
            Some((_, place)) => Err(self.files.error(
                place,
                "*CHANGE FRICTION: no *FRICTION with the new numbers follows it",
            )),
        }
    }
}
