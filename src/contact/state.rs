//! The state of the contact loop, and a record of its steps.

use mpi::topology::SimpleCommunicator;
use serde::{Deserialize, Serialize};

use super::settings::ContactType;
use crate::feti::jump::operator::Jump;
use crate::feti::Spectrum;
use crate::Result;
use parallel::exchange::sum_all;

/// Record of one step of the outer loop.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Step {
    /// The method of the step.
    pub method: ContactType,
    /// Rows of B_gl that held.
    pub active: usize,
    /// Number of rows that hold now and did not in the step before.
    pub entered: usize,
    /// Number of rows that held in the step before and do not now.
    pub left: usize,
    /// Krylov iterations.
    pub iterations: usize,
    /// The Krylov method's estimate of the spectrum.
    pub estimate: Option<Spectrum>,
    /// Exact spectrum with these rows, if `-fetifeti_spectrum` asks for it.
    pub exact: Option<Spectrum>,
    /// Residual at the end, relative to the reference.
    pub residual: f64,
    /// The tolerance of the step.
    pub tolerance: f64,
    /// Number of inequality rows that are on the wrong side at the end of the step: violated, or with a pulling
    /// multiplier.
    pub wrong: usize,
    /// Seconds.
    pub seconds: f64,
}

impl Step {
    /// A step whose equations were not begun.
    pub(super) fn without(method: ContactType) -> Step {
        Step {
            method,
            active: 0,
            entered: 0,
            left: 0,
            iterations: 0,
            estimate: None,
            exact: None,
            residual: 1.0,
            tolerance: 1.0,
            wrong: 0,
            seconds: 0.0,
        }
    }

    /// This step as the end of one that has begun with `before`.
    pub(super) fn continuing(self, before: &Step) -> Step {
        Step {
            entered: before.entered,
            left: before.left,
            iterations: before.iterations + self.iterations,
            seconds: before.seconds + self.seconds,
            ..self
        }
    }
}

/// The state of the outer loop, sufficient to continue it. Vectors are this rank's part.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct State {
    /// Multipliers of the owned rows.
    pub lambda: Vec<f64>,
    /// Whether each owned row is to hold in the next step.
    pub active: Vec<bool>,
    /// Whether each owned row held in the step before.
    pub before: Vec<bool>,
    /// Residual that tolerances are relative to; 0 if it is not known yet.
    pub reference: f64,
    /// Steps so far.
    pub steps: usize,
    /// The progress of the active-set method.
    pub progress: ActiveSetProgress,
    /// Whether the active-set method has given up, and the augmented Lagrangian goes on.
    pub safeguarded: bool,
    /// Factor on the tolerance of the user. Below 1 if multipliers turned out to need more digits.
    pub accuracy: f64,
    /// SMALBE's multipliers of the balance of forces, length r, the same on every rank; empty if SMALBE has not run.
    pub mu: Vec<f64>,
    /// Where the sides stood at the start of the load step: by how far they had slid, on the tangential owned rows;
    /// empty if they have not.
    #[serde(default)]
    pub slid: Vec<f64>,
}

impl State {
    /// The start of a loop for other loads: the multipliers and the set of a solution.
    pub fn warm(lambda: Vec<f64>, active: &[bool]) -> State {
        State {
            lambda,
            active: active.to_vec(),
            before: active.to_vec(),
            reference: 0.0,
            steps: 0,
            progress: ActiveSetProgress::default(),
            safeguarded: false,
            accuracy: 1.0,
            mu: Vec::new(),
            slid: Vec::new(),
        }
    }

    /// This state with other rows: their multipliers, whether each is to hold and held in the step before, and how far
    /// they had slid.
    pub fn on_rows(
        &self,
        lambda: Vec<f64>,
        [active, before]: [Vec<bool>; 2],
        slid: Vec<f64>,
    ) -> State {
        State {
            lambda,
            active,
            before,
            slid,
            ..self.clone()
        }
    }

    /// The start of a loop: λ = 0, and all candidate rows hold.
    pub(crate) fn cold(jump: &Jump) -> State {
        State::warm(vec![0.0; jump.n_owned], &jump.initial)
    }
}

/// Numbers of rows over all ranks that hold now, that hold now and did not before, and the reverse. Collective.
pub(super) fn changes(comm: &SimpleCommunicator, before: &[bool], now: &[bool]) -> [usize; 3] {
    let count = |test: fn(bool, bool) -> bool| {
        let pairs = before.iter().zip(now);
        pairs.filter(|(was, on)| test(**was, **on)).count() as f64
    };
    let mut counts = [
        count(|_, on| on),
        count(|was, on| on && !was),
        count(|was, on| was && !on),
    ];
    sum_all(comm, &mut counts);
    counts.map(|n| n as usize)
}

/// The progress of the active-set method, measured by the number of rows on the wrong side.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[non_exhaustive]
pub struct ActiveSetProgress {
    /// The smallest number of wrong rows so far; `None` before the first step.
    fewest: Option<usize>,
    /// Steps since then.
    idle: usize,
    /// The number after the last step.
    wrong: usize,
}

impl ActiveSetProgress {
    /// Notes the number of wrong rows after a step.
    pub(super) fn note(&mut self, wrong: usize) {
        self.wrong = wrong;
        match self.fewest {
            Some(fewest) if wrong >= fewest => self.idle += 1,
            _ => (self.fewest, self.idle) = (Some(wrong), 0),
        }
    }

    /// Begins anew with the number after the last step.
    pub(super) fn begin(&mut self, wrong: usize) {
        *self = ActiveSetProgress::default();
        self.note(wrong);
    }

    /// The number of wrong rows after the last step.
    pub(super) fn wrong(&self) -> usize {
        self.wrong
    }

    /// Whether the number of wrong rows has not fallen for `patience` steps.
    pub(super) fn stalled(&self, patience: usize) -> bool {
        self.idle >= patience
    }
}

/// Called after each outer step.
pub type Observer<'a> = dyn FnMut(&Step, &State) -> Result<()> + 'a;

#[cfg(test)]
#[path = "../../tests/inside/contact/state.rs"]
mod tests;
