//! Where the contact loop stands, and what its steps have done.

#[cfg(feature = "cli")]
use serde::{Deserialize, Serialize};

use super::settings::ContactType;
use crate::feti::jump::operator::Jump;
use crate::feti::Spectrum;
use crate::Result;

/// What one step of the outer loop did.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// The method that made it.
    pub method: ContactType,
    /// Rows of B_gl that held.
    pub active: usize,
    /// Rows that hold now and did not in the step before.
    pub entered: usize,
    /// Rows that held in the step before and do not now.
    pub left: usize,
    /// Krylov iterations.
    pub iterations: usize,
    /// The Krylov method's estimate of the spectrum.
    pub estimate: Option<Spectrum>,
    /// Exact spectrum with these rows, where `-fetifeti_spectrum` asks for it.
    pub exact: Option<Spectrum>,
    /// Residual at the end, relative to the reference.
    pub residual: f64,
    /// What was asked of it.
    pub tolerance: f64,
    /// Inequality rows that are on the wrong side at the end of the step: violated, or pulling.
    pub wrong: usize,
    /// Seconds.
    pub seconds: f64,
}

/// Where the outer loop stands; enough to go on from. Vectors are this rank's part.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "cli", derive(Serialize, Deserialize))]
pub struct State {
    /// Multipliers of the owned rows.
    pub lambda: Vec<f64>,
    /// Which of the owned rows are to hold in the next step.
    pub active: Vec<bool>,
    /// Which of them held in the step before.
    pub before: Vec<bool>,
    /// Residual that tolerances are relative to; 0 where it is not known yet.
    pub reference: f64,
    /// Steps so far.
    pub steps: usize,
    /// Fingerprints of the sets so far.
    pub visited: Vec<u64>,
    /// How carefully the loop goes on.
    pub caution: Caution,
    /// SMALBE's multipliers of the balance of forces, length r, the same on every rank; empty where it has not run.
    pub mu: Vec<f64>,
}

impl State {
    /// Where a loop starts for other loads: the multipliers and the set of a solution.
    pub fn warm(lambda: &[f64], active: &[bool]) -> State {
        State {
            lambda: lambda.to_vec(),
            active: active.to_vec(),
            before: active.to_vec(),
            reference: 0.0,
            steps: 0,
            visited: Vec::new(),
            caution: Caution::Loose,
            mu: Vec::new(),
        }
    }

    /// Where the loop starts: λ = 0, and all rows hold that may.
    pub fn cold(jump: &Jump) -> State {
        State {
            lambda: vec![0.0; jump.n_owned],
            active: jump.initial.clone(),
            before: jump.initial.clone(),
            reference: 0.0,
            steps: 0,
            visited: Vec::new(),
            caution: Caution::Loose,
            mu: Vec::new(),
        }
    }
}

/// How carefully an active-set loop goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "cli", derive(Serialize, Deserialize))]
pub enum Caution {
    /// Loose inner tolerances while the set changes.
    Loose,
    /// The set came back: inner problems are solved to the end.
    Exact,
    /// It came back again: one row changes at a time.
    Single,
    /// And again: SMALBE takes over.
    Fallback,
}

/// Called after each outer step.
pub type Observer<'a> = dyn FnMut(&Step, &State) -> Result<()> + 'a;
