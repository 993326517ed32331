//! *STEP, *STATIC and *END STEP: what holds at the end of each step.

use super::base::DeckReader;
use super::held::SeenCards;
use super::params::Params;
use crate::cards::Card;
use crate::numbers::clip;
use crate::step::{BodyLoad, BodyLoadKind, DeckStep, NodeForce, Pressure, Support};
use base::Result;

impl<'a> DeckReader<'a> {
    /// The error if a card that belongs before all steps stands after one.
    pub(super) fn before_steps(&self, card: &Card) -> Result<()> {
        match self.state.number {
            0 => Ok(()),
            _ => self.error(card, "it must stand before the first *STEP"),
        }
    }

    /// The error if a card that belongs to a step stands outside.
    pub(super) fn within_step(&self, card: &Card) -> Result<()> {
        match self.state.open {
            Some(_) => Ok(()),
            None => self.error(card, "it must stand between *STEP and *END STEP"),
        }
    }

    pub(super) fn step(&mut self, card: &'a Card) -> Result<()> {
        let mut params = Params::new(card, self.files);
        match params.value("NLGEOM") {
            None | Some("NO" | "OFF") => {}
            Some(_) => return params.error(
                "NLGEOM: large displacements are not supported; remove it to solve the linear step",
            ),
        }
        if params.flag("PERTURBATION") && self.state.number > 0 {
            return params.error("PERTURBATION is supported in the first step only");
        }
        if let Some(other) = params
            .value("AMPLITUDE")
            .filter(|a| !matches!(*a, "RAMP" | "STEP"))
        {
            return params.error(format!("AMPLITUDE={} is not supported", clip(other)));
        }
        params.skip(&["NAME", "INC", "INCF", "UNSYMM", "EXTRAPOLATION"]);
        params.done()?;
        if let Some(place) = self.state.open {
            let place = self.files.at(place);
            return self.error(card, format!("the *STEP of {place} has no *END STEP"));
        }
        self.state.number += 1;
        self.state.open = Some(card.place);
        self.state.procedure = None;
        self.state.seen = SeenCards::default();
        Ok(())
    }

    pub(super) fn static_step(&mut self, card: &'a Card) -> Result<()> {
        let mut params = Params::new(card, self.files);
        let reset = params.flag("TIMERESET");
        let start = params.real("TOTALTIMEATSTART")?;
        params.skip(&["SOLVER", "DIRECT", "EXPLICIT"]);
        params.done()?;
        self.within_step(card)?;
        if self.state.procedure.is_some() {
            return self.error(card, "the step has a *STATIC before");
        }
        let mut duration = 1.0;
        if let Some(row) = self.cards.rows(card).next() {
            for k in 0..row.fields.len() {
                row.real_or(self.files, k, 0.0, "a time")?;
            }
            duration = row.real_or(self.files, 1, 1.0, "the duration of the step")?;
            if duration < 0.0 {
                return Err(self
                    .files
                    .error(row.place, "the step has a negative duration"));
            }
            if duration == 0.0 {
                duration = 1.0;
            }
            let increment = row.real_or(self.files, 0, duration, "a time")?;
            let friction = self.state.friction.iter().any(Option::is_some);
            if friction && increment > 0.0 && increment < duration {
                let reason = "a step with friction goes to its end in one increment";
                self.deck.replaced.push(Self::note(card, row.place, reason));
            }
        }
        let start = start.unwrap_or(self.state.time) - if reset { duration } else { 0.0 };
        self.state.procedure = Some((duration, start + duration));
        Ok(())
    }

    pub(super) fn end_step(&mut self, card: &'a Card) -> Result<()> {
        Params::new(card, self.files).done()?;
        let Some(place) = self.state.open.take() else {
            return self.error(card, "there is no *STEP before it");
        };
        let Some((duration, time)) = self.state.procedure.take() else {
            return Err(self.files.error(place, "*STEP: the step has no *STATIC"));
        };
        self.no_change_pending()?;
        let state = &self.state;
        let entries = state.friction.len()
            + state.supports.len()
            + state.forces.len()
            + state.pressures.len()
            + state.temperatures.len()
            + state
                .bodies
                .iter()
                .map(|b| b.cells.len() + 1)
                .sum::<usize>()
            + state
                .prints
                .iter()
                .map(|p| p.nodes.len() + 1)
                .sum::<usize>()
            + state
                .fields
                .iter()
                .map(|f| f.fields.len() + 1)
                .sum::<usize>();
        self.spend(entries, place)?;
        let (state, amplitudes) = (&mut self.state, &self.amplitudes);
        state.time = time;
        let mut step = DeckStep {
            place,
            duration,
            time,
            friction: state.friction.clone(),
            prints: state.prints.clone(),
            fields: state.fields.clone(),
            ..DeckStep::default()
        };
        for (&(node, dof), held) in &mut state.supports {
            let value = held.end(amplitudes, duration, time);
            let place = held.place;
            step.supports.push(Support {
                node,
                dof,
                value,
                place,
            });
        }
        for (&(node, dof), held) in &mut state.forces {
            let value = held.end(amplitudes, duration, time);
            let place = held.place;
            step.forces.push(NodeForce {
                node,
                dof,
                value,
                place,
            });
        }
        for (&(cell, side), held) in &mut state.pressures {
            let value = held.end(amplitudes, duration, time);
            let place = held.place;
            step.pressures.push(Pressure {
                cell,
                side,
                value,
                place,
            });
        }
        for (&node, held) in &mut state.temperatures {
            let value = held.end(amplitudes, duration, time);
            step.temperatures.push((node, value));
        }
        step.forces.retain(|f| f.value != 0.0);
        step.pressures.retain(|p| p.value != 0.0);
        for body in &mut state.bodies {
            let value = body.held.end(amplitudes, duration, time);
            if value == 0.0 {
                continue;
            }
            let kind = match body.kind {
                BodyLoadKind::Gravity(direction) => {
                    BodyLoadKind::Gravity(direction.map(|x| x * value))
                }
                BodyLoadKind::Centrifugal {
                    point, direction, ..
                } => BodyLoadKind::Centrifugal {
                    omega2: value,
                    point,
                    direction,
                },
            };
            let (cells, place) = (body.cells.clone(), body.held.place);
            step.body_loads.push(BodyLoad { cells, kind, place });
        }
        self.deck.steps.push(step);
        Ok(())
    }

    /// Checks what can be checked at the end only.
    pub(super) fn end(&mut self) -> Result<()> {
        if let Some(place) = self.state.open {
            let message = "*STEP: the step has no *END STEP; the file may be cut off";
            return Err(self.files.error(place, message));
        }
        let name = &self.files.0[0];
        let fail = |message: String| Err(base::Error::input(format!("{name}: {message}")));
        if self.deck.mesh.cells.is_empty() {
            return fail("the deck has no elements".to_string());
        }
        if self.deck.steps.is_empty() {
            return fail("the deck has no *STEP, so it asks for nothing".to_string());
        }
        if let Some(c) = self.deck.cell_section.iter().position(|&s| s == u32::MAX) {
            let id = self.deck.mesh.cell_ids[c];
            return fail(format!("element {id} belongs to no *SOLID SECTION"));
        }
        for body in self.deck.steps.iter().flat_map(|s| &s.body_loads) {
            for &cell in &body.cells {
                let section = &self.deck.sections[self.deck.cell_section[cell as usize] as usize];
                let material = &self.deck.materials[section.material as usize];
                if material.density.is_none() {
                    let message = format!(
                        "element {} has a force by mass, but its material {} has no *DENSITY",
                        self.cell_id(cell),
                        material.name
                    );
                    return Err(self.files.error(body.place, message));
                }
            }
        }
        Ok(())
    }
}
