//! After a step of the active-set method: how its rows are judged, and which set comes next.

use super::{ActiveSet, ActiveSetChange};
use crate::contact::judge;
use crate::feti::operators::dual::Dual;
use crate::Result;
use parallel::exchange::any;

/// The next set, and the observations that led to it.
pub(super) struct NextSet {
    active: Vec<bool>,
    /// Number of rows on the wrong side over all ranks.
    pub wrong: usize,
    /// Whether rows that hold contradict each other.
    contradictory: bool,
    /// Largest remaining jump on rows that hold.
    pub jump_left: f64,
    /// Number of rows, over all ranks, that were put back so that no body comes loose.
    restored: usize,
}

impl ActiveSet<'_> {
    /// Judges the rows by the present λ and displacements.
    pub(super) fn next(&mut self, dual: &Dual) -> Result<NextSet> {
        let comm = dual.comm();
        let jump = &dual.stiffness.jump;
        self.at.residual.add_rigid_motion(dual)?;
        self.placed = true;
        self.gaps = self
            .repairs
            .place(dual, &mut self.at.residual, &self.at.lambda)?;
        self.held.clone_from(&jump.active);
        let lambda = self.at.lambda.array()?;
        for (r, spring) in self.springs.iter().enumerate().filter(|s| *s.1 > 0.0) {
            self.gaps[r] -= spring * lambda[r];
        }
        let gaps = &self.gaps;
        let (sizes, tuning) = (
            (self.at.residual.largest(), self.sizes),
            &self.settings.tuning,
        );
        let judged = judge::JudgedRows::new(comm, jump, (gaps, &lambda), sizes, self.open, tuning);
        self.length = judged.y_max;
        let wrong = judged.wrong(comm);
        let load = &self.at.loads.kernel;
        let score = |r: usize| judged.score(lambda[r], gaps[r]);
        let mut active = judged.active.clone();
        let restored = self.repairs.hold(dual, &mut active, &score, load)?;
        Ok(NextSet {
            active,
            wrong,
            contradictory: judged.contradictory,
            jump_left: judged.jump_left,
            restored,
        })
    }

    /// Moves on to the next set.
    pub(super) fn advance(
        &mut self,
        next: NextSet,
        to_the_end: bool,
        closed: bool,
    ) -> Result<ActiveSetChange> {
        let comm = self.method.session.comm();
        let state = &mut self.state;
        state.steps += 1;
        state.lambda = self.at.lambda.to_vec()?;
        state.before = std::mem::replace(&mut state.active, next.active);
        let stays = !any(comm, state.active != state.before);
        self.fresh = stays;
        self.tight = stays;
        if stays {
            if !to_the_end {
                return Ok(ActiveSetChange::GoOn);
            }
            if next.restored == 0 && !next.contradictory && closed {
                return Ok(ActiveSetChange::Solved);
            }
            // The rule has no next set here. Rows that pull are kept because nothing else holds a body, or rows cannot
            // all be satisfied, or no motion closes their jumps.
            state.safeguarded = true;
            return Ok(ActiveSetChange::GoOn);
        }
        // A set that stays after a loose step says nothing yet: the exact step has the word.
        state.progress.note(next.wrong);
        state.safeguarded = state.progress.stalled(self.settings.tuning.patience);
        Ok(ActiveSetChange::GoOn)
    }
}
