//! *EXPANSION, and temperatures: *INITIAL CONDITIONS and *TEMPERATURE.

use super::base::DeckReader;
use super::held::HeldValue;
use super::params::Params;

use crate::cards::Card;
use crate::numbers::clip;
use base::Result;
use std::collections::BTreeMap;

impl<'a> DeckReader<'a> {
    /// The strain per degree. With one that does not depend on the temperature, ZERO is of no effect.
    pub(super) fn expansion(&self, card: &'a Card) -> Result<[f64; 3]> {
        let mut params = Params::new(card, self.files);
        params.skip(&["ZERO"]);
        let kind = params.value("TYPE").unwrap_or("ISO");
        params.done()?;
        match kind {
            "ISO" | "ISOTROPIC" => Ok([self.constant(card, 1)?[0]; 3]),
            "ORTHO" | "ORTHOTROPIC" => {
                let constants = self.constant(card, 3)?;
                Ok([constants[0], constants[1], constants[2]])
            }
            other => self.error(
                card,
                format!("TYPE={} is neither ISO nor ORTHO", clip(other)),
            ),
        }
    }

    pub(super) fn initial_conditions(&mut self, card: &'a Card) -> Result<()> {
        let mut params = Params::new(card, self.files);
        match params.required("TYPE")? {
            "TEMPERATURE" => {}
            "VELOCITY" => {
                let reason = "velocities do nothing in static steps";
                self.deck.ignored.push(Self::note(card, card.place, reason));
                return Ok(());
            }
            kind => return params.error(format!("TYPE={} is not supported", clip(kind))),
        }
        params.refuse(&["USER"], "routines of users are not supported")?;
        params.refuse(&["FILE"], "results of other computations are not read")?;
        params.done()?;
        let before = std::mem::take(&mut self.deck.initial_temperatures);
        let mut all: BTreeMap<u32, f64> = before.into_iter().collect();
        for row in self.cards.rows(card) {
            let nodes = self.target_nodes(&row, 0)?;
            let value = row.real_or(self.files, 1, 0.0, "a temperature")?;
            self.spend(nodes.len(), row.place)?;
            all.extend(nodes.into_iter().map(|node| (node, value)));
        }
        self.deck.initial_temperatures = all.into_iter().collect();
        Ok(())
    }

    /// *TEMPERATURE of a step.
    pub(super) fn temperature(&mut self, card: &'a Card) -> Result<()> {
        let mut params = Params::new(card, self.files);
        let anew = self.anew(&mut params)?;
        let timed = self.timed(&mut params)?;
        params.refuse(&["USER"], "routines of users are not supported")?;
        for key in ["FILE", "BSTEP", "SUBMODEL"] {
            params.refuse(&[key], "results of other computations are not read")?;
        }
        params.done()?;
        self.within_step(card)?;
        if anew && !self.state.seen.temperature {
            self.state.temperatures.clear();
        }
        self.state.seen.temperature = true;
        for row in self.cards.rows(card) {
            // What follows the temperature is for shells and beams.
            let nodes = self.target_nodes(&row, 0)?;
            let value = row.real_or(self.files, 1, 0.0, "a temperature")?;
            self.spend(nodes.len(), row.place)?;
            for node in nodes {
                let held = HeldValue::new(value, timed, row.place);
                self.state.temperatures.insert(node, held);
            }
        }
        Ok(())
    }
}
