//! A look at the multipliers while a set is solved to the end. Rows that pull and go on pulling must leave the set;
//! the iterations that follow would be in vain.

use mpi::topology::SimpleCommunicator;

use crate::feti::jump::operator::Jump;
use crate::feti::krylov::residual::Iterate;
use crate::Result;
use parallel::exchange::{any, max_all};
use petsc::Vec as PetscVec;

/// The multipliers of the inequalities that hold, at the last look.
pub(super) struct PullMonitor<'a> {
    comm: &'a SimpleCommunicator,
    rows: Vec<usize>,
    before: Vec<f64>,
    /// Multipliers below this part of the largest one, or of the largest load, are rounding.
    rounding: f64,
    load: f64,
}

impl<'a> PullMonitor<'a> {
    /// The multipliers at the start of the solve; `load` is the
    /// [`JudgeSizes::load`](super::judge::JudgeSizes::load).
    pub fn new(
        comm: &'a SimpleCommunicator,
        jump: &Jump,
        at: &Iterate,
        rounding: f64,
        load: f64,
    ) -> Result<PullMonitor<'a>> {
        let all = jump.rows_between_bodies();
        let rows: Vec<usize> = all
            .filter(|&r| jump.law[r].is_inequality() && jump.active[r])
            .collect();
        let lambda = at.lambda.array()?;
        Ok(PullMonitor {
            comm,
            before: rows.iter().map(|&r| lambda[r]).collect(),
            rows,
            rounding,
            load,
        })
    }

    /// Whether some row pulls by more than its multiplier has changed since the last look. The multipliers of an
    /// iteration settle geometrically: such a row will pull at its end, too. Collective.
    pub fn lasts(&mut self, lambda: &PetscVec) -> Result<bool> {
        let lambda = lambda.array()?;
        let now: Vec<f64> = self.rows.iter().map(|&r| lambda[r]).collect();
        let mut largest = [now.iter().fold(self.load, |a, l| a.max(l.abs()))];
        max_all(self.comm, &mut largest);
        let pull = self.rounding * largest[0];
        let mut pairs = self.before.iter().zip(&now);
        let found = pairs.any(|(before, now)| *now < -pull && (now - before).abs() < -now);
        self.before = now;
        Ok(any(self.comm, found))
    }
}
