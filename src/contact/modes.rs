//! Modes of the operators, for as long as a search needs them. A guard ends its mode when it is dropped, however the
//! search has ended.

use crate::feti::jump::turn::Turn;
use crate::feti::LinearMethod;
use parallel::exchange::any;
use std::cell::Cell;
use std::collections::BTreeMap;

/// The rows of a method as springs; they are rigid again afterwards.
pub struct CompliantRows<'a> {
    method: &'a LinearMethod,
    /// Whether they are springs now.
    soft: Cell<bool>,
}

impl<'a> CompliantRows<'a> {
    /// The rows of `method`, as they are.
    pub fn of(method: &'a LinearMethod) -> CompliantRows<'a> {
        CompliantRows {
            method,
            soft: Cell::new(false),
        }
    }

    /// Makes the rows springs with this compliance. Collective.
    pub fn soften(&self, compliance: &[f64]) {
        self.soft.set(true);
        let compliance = compliance.to_vec();
        self.method.system.set_compliance(Some(compliance));
    }

    /// Makes the rows rigid. Collective.
    pub fn rigid(&self) {
        if self.soft.replace(false) {
            self.method.system.set_compliance(None);
        }
    }
}

impl Drop for CompliantRows<'_> {
    fn drop(&mut self) {
        // A panic may have left the operators in the middle of something.
        if !std::thread::panicking() {
            self.rigid();
        }
    }
}

/// Rows of nodes that are turned in their plane; afterwards they have the directions that were given.
pub struct TurnedRows<'a> {
    method: &'a LinearMethod,
    /// The cosine and the sine of the angle by which each pair of rows is turned.
    by: BTreeMap<[usize; 2], [f64; 2]>,
}

impl<'a> TurnedRows<'a> {
    /// The rows of `method`, as they are.
    pub fn of(method: &'a LinearMethod) -> TurnedRows<'a> {
        TurnedRows {
            method,
            by: BTreeMap::new(),
        }
    }

    /// Turns rows. Collective, on ranks without turns, too.
    pub fn turn(&mut self, turns: &[Turn]) {
        if any(self.method.session.comm(), !turns.is_empty()) {
            self.method.system.turn(&self.method.problem, turns);
        }
        for turn in turns {
            let by = self.by.entry(turn.rows).or_insert([1.0, 0.0]);
            *by = turn.after(*by);
        }
    }

    /// Turns all rows back; returns the turns that do so. Collective.
    pub fn back(&mut self) -> Vec<Turn> {
        let by = std::mem::take(&mut self.by);
        let back = |(rows, [cos, sin]): ([usize; 2], [f64; 2])| Turn {
            rows,
            by: [cos, -sin],
        };
        let turns: Vec<Turn> = by.into_iter().map(back).collect();
        if any(self.method.session.comm(), !turns.is_empty()) {
            self.method.system.turn(&self.method.problem, &turns);
        }
        turns
    }
}

impl Drop for TurnedRows<'_> {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            self.back();
        }
    }
}

/// Given multipliers of rows, for as long as friction needs them: a guard that takes them away again.
pub struct GivenMultipliers<'a>(&'a LinearMethod);

impl<'a> GivenMultipliers<'a> {
    /// The rows of `method`, without given multipliers.
    pub fn of(method: &'a LinearMethod) -> GivenMultipliers<'a> {
        GivenMultipliers(method)
    }
}

impl Drop for GivenMultipliers<'_> {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            self.0.system.set_given_multipliers(Vec::new());
        }
    }
}

/// A face of the bounds, in which M⁻¹ knows the free rows only; afterwards the rows hold that held before.
pub struct Face<'a> {
    method: &'a LinearMethod,
    /// The rows that held, once a face was entered.
    held: Option<Vec<bool>>,
}

impl<'a> Face<'a> {
    /// The rows of `method`, as they are.
    pub fn of(method: &'a LinearMethod) -> Face<'a> {
        Face { method, held: None }
    }

    /// Enters the face in which these rows are free. Collective.
    pub fn enter(&mut self, free: &[bool]) {
        let held = || self.method.dual().stiffness.jump.active.clone();
        self.held.get_or_insert_with(held);
        self.method.system.set_face(free);
    }

    /// Forgets the rows that held, where other rows are set at once.
    pub fn forget(&mut self) {
        self.held = None;
    }

    /// Leaves the face: the rows hold that held before it was entered. Collective.
    pub fn leave(&mut self) {
        if let Some(held) = self.held.take() {
            self.method.system.set_face(&held);
        }
    }
}

impl Drop for Face<'_> {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            self.leave();
        }
    }
}
