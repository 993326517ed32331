//! Seconds of this rank by phase.
//!
//! PETSc's events (`-log_view`) time F, M and P as a whole. These clocks time the phases whose cost depends on the
//! number of bodies and ranks: local factorisations, the three coarse problems, messages. Waiting for a slower rank
//! counts as message.

use std::cell::Cell;
use std::time::Instant;

/// The timed phases: everything but the work inside the subdomains during the iteration. Phases of the set-up never run
/// inside each other, but for the last two, nor do phases of the iteration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Set-up: factors, S, T and Ψ of the subdomains.
    LocalSetup,
    /// Set-up: S_Π.
    PrimalSetup,
    /// Set-up: Z_c and A.
    LiftingSetup,
    /// Set-up: G and Gᵀ Q G.
    NaturalSetup,
    /// The part of it that every rank does for all bodies: pattern and order of Gᵀ Q G.
    NaturalOrder,
    /// Another part of it: the factor of Gᵀ G.
    NaturalFactor,
    /// Iteration: messages between neighbours, with the copies into and out of them.
    Exchange,
    /// Iteration: all-reduces of the projector.
    Reduction,
    /// Iteration: S_Π⁺.
    Primal,
    /// Iteration: A⁺.
    Lifting,
    /// Iteration: (Gᵀ Q G)⁻¹.
    Natural,
}

const PHASES: usize = Phase::Natural as usize + 1;

/// Seconds by phase.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Times([f64; PHASES]);

impl Times {
    /// Seconds of one phase.
    pub fn of(&self, phase: Phase) -> f64 {
        self.0[phase as usize]
    }

    /// The seconds spent since an earlier reading.
    pub fn since(&self, before: &Times) -> Times {
        let mut out = *self;
        out.0.iter_mut().zip(before.0).for_each(|(t, b)| *t -= b);
        out
    }

    /// Adds other seconds.
    pub fn add(&mut self, more: &Times) {
        self.0.iter_mut().zip(more.0).for_each(|(t, m)| *t += m);
    }
}

thread_local! {
    static SPENT: Cell<Times> = const { Cell::new(Times([0.0; PHASES])) };
}

/// The readings of all clocks; take differences.
pub fn spent() -> Times {
    SPENT.get()
}

/// Does `work` with the clock of `phase` running.
pub fn timed<T>(phase: Phase, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    let mut times = SPENT.get();
    times.0[phase as usize] += start.elapsed().as_secs_f64();
    SPENT.set(times);
    result
}

#[cfg(test)]
#[path = "../tests/clock.rs"]
mod tests;
