//! Definitions that hold until they are replaced: supports, loads, requests; and the amplitudes of loads.

use crate::deck_line::DeckLine;
use crate::joint::Friction;
use crate::step::{BodyLoadKind, FieldRequest, NodePrint};
use std::collections::BTreeMap;

/// A factor as a function of time.
#[derive(Debug, Clone)]
pub(super) struct Amplitude {
    /// Whether its time is that of all steps together.
    pub total: bool,
    /// Times, which do not decrease, and factors.
    pub table: Vec<(f64, f64)>,
}

impl Amplitude {
    /// The factor at `time`: linear between the times of the table, constant before and after.
    pub fn at(&self, time: f64) -> f64 {
        let k = self.table.partition_point(|t| t.0 <= time);
        match (k.checked_sub(1).map(|k| self.table[k]), self.table.get(k)) {
            (Some((t0, y0)), Some(&(t1, y1))) => y0 + (y1 - y0) * (time - t0) / (t1 - t0),
            (Some((_, y)), None) | (None, Some(&(_, y))) => y,
            (None, None) => 1.0,
        }
    }
}

/// An amplitude by its place, later by `delay`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Timed {
    pub amplitude: usize,
    pub delay: f64,
}

/// A value that holds until it is replaced.
#[derive(Debug, Clone)]
pub(super) struct HeldValue {
    pub value: f64,
    timed: Option<Timed>,
    pub place: DeckLine,
    /// Whether it was given in the present step: then loads are added to it, later they replace it.
    fresh: bool,
}

/// A load on cells that holds until it is replaced.
#[derive(Debug, Clone)]
pub(super) struct HeldCellLoad {
    /// The cells as they are named.
    pub target: String,
    pub cells: Vec<u32>,
    pub kind: BodyLoadKind,
    pub held: HeldValue,
}

/// Which cards the present step has had: what is asked to begin anew does so at the first.
#[derive(Debug, Default)]
pub(super) struct SeenCards {
    pub boundary: bool,
    pub cload: bool,
    pub dload: bool,
    pub temperature: bool,
    pub print: bool,
    pub node_fields: bool,
    pub cell_fields: bool,
}

/// The definitions that hold at present.
#[derive(Debug, Default)]
pub(super) struct DeckState {
    /// How many steps have begun.
    pub number: usize,
    /// The keyword line of the step that is open.
    pub open: Option<DeckLine>,
    /// The procedure of the step that is open: duration, total time at its end.
    pub procedure: Option<(f64, f64)>,
    /// The total time at the end of the last step.
    pub time: f64,
    pub seen: SeenCards,
    pub supports: BTreeMap<(u32, u8), HeldValue>,
    pub forces: BTreeMap<(u32, u8), HeldValue>,
    pub pressures: BTreeMap<(u32, u8), HeldValue>,
    pub bodies: Vec<HeldCellLoad>,
    pub temperatures: BTreeMap<u32, HeldValue>,
    pub prints: Vec<NodePrint>,
    pub fields: Vec<FieldRequest>,
    /// By interaction.
    pub friction: Vec<Option<Friction>>,
    /// The interaction that the *CHANGE FRICTION before names, until its *FRICTION has come.
    pub changing: Option<(u32, DeckLine)>,
}

const DIFFERENT: &str = "a load is added to another of the same step that has another amplitude";

impl HeldValue {
    pub fn new(value: f64, timed: Option<Timed>, place: DeckLine) -> HeldValue {
        HeldValue {
            value,
            timed,
            place,
            fresh: true,
        }
    }

    /// Adds it to what the present step has there, or replaces what an earlier step has left.
    pub fn add_to(
        self,
        all: &mut BTreeMap<(u32, u8), HeldValue>,
        key: (u32, u8),
    ) -> std::result::Result<(), &'static str> {
        match all.get_mut(&key) {
            Some(before) => before.add(self),
            None => {
                all.insert(key, self);
                Ok(())
            }
        }
    }

    fn add(&mut self, more: HeldValue) -> std::result::Result<(), &'static str> {
        if !self.fresh {
            *self = more;
            return Ok(());
        }
        if self.timed != more.timed {
            return Err(DIFFERENT);
        }
        self.value += more.value;
        Ok(())
    }

    /// The value at the end of a step, which stays unless its amplitude goes on in the total time.
    pub fn end(&mut self, amplitudes: &[Amplitude], duration: f64, time: f64) -> f64 {
        self.fresh = false;
        let Some(timed) = self.timed else {
            return self.value;
        };
        let amplitude = &amplitudes[timed.amplitude];
        let now = if amplitude.total { time } else { duration };
        let value = self.value * amplitude.at(now - timed.delay);
        if !amplitude.total {
            self.value = value;
            self.timed = None;
        }
        value
    }
}

impl HeldCellLoad {
    /// Adds it to the same load of the present step, or replaces that of an earlier one.
    pub fn add_to(
        self,
        all: &mut Vec<HeldCellLoad>,
        same: fn(&BodyLoadKind, &BodyLoadKind) -> bool,
    ) -> std::result::Result<(), &'static str> {
        let known = |b: &&mut HeldCellLoad| b.target == self.target && same(&b.kind, &self.kind);
        match all.iter_mut().find(known) {
            Some(before) => before.held.add(self.held),
            None => {
                all.push(self);
                Ok(())
            }
        }
    }
}
