//! Whether there is a solution.
//!
//! | file | question |
//! |---|---|
//! | [`gaps`] | can all rows hold together? |
//! | [`motions`] | does the load push a body away for ever? |
//! | [`springs`] | the same of many rigid motions, and with friction, by rigid bodies on springs |
//! | [`carriers`] | which rows exert forces, alone or as nodes with friction |
//! | [`cone`] | the forces that a node with friction can exert |
//!
//! Gaps are asked about before every loop. Of rigid motions few are asked about before the loop, by an exact method and
//! with friction by the springs, too. With many the loop itself is the answer: λ_I ≥ 0 with Gᵀ λ = e are what it looks
//! for, and where there are none, a motion that the load drives and no row stands against shows when rows are put back
//! ([`repairs`](super::repairs)). A loop asks about many motions where it cannot begin, as the load works on a motion
//! that all rows leave free; where it has taken many steps; where it has failed; and before a strategy that would go on
//! for ever.

mod carriers;
mod cone;
mod gaps;
mod motions;
mod springs;

use super::settings::ContactSettings;
use super::tuning::Tuning;
use crate::feti::krylov::residual::Iterate;
use crate::feti::operators::dual::Dual;
use crate::feti::projector::balance::KernelLoad;
use crate::feti::projector::gram::FEW;
use crate::feti::LinearMethod;
use crate::substructures::Problem;
use crate::Result;
use parallel::exchange::any;

pub use motions::pushed_away;

/// The questions about a problem. All are collective, and their errors name the bodies.
pub struct Existence<'a> {
    problem: &'a Problem,
    dual: &'a Dual,
    tuning: &'a Tuning,
}

impl<'a> Existence<'a> {
    /// The questions about the problem of `method`.
    pub fn new(
        method: &'a LinearMethod,
        dual: &'a Dual,
        settings: &'a ContactSettings,
    ) -> Existence<'a> {
        Existence {
            problem: &method.problem,
            dual,
            tuning: &settings.tuning,
        }
    }

    /// Whether all rows can hold together.
    ///
    /// # Errors
    /// Gaps that contradict each other.
    pub fn of_gaps(&self) -> Result<()> {
        let found = gaps::check(self.problem, self.dual, self.tuning.contradiction);
        self.dual.stiffness.session.agree(found)
    }

    /// Whether the rows can carry the load, where few motions make the question cheap: without bounds of friction, and
    /// then within them.
    ///
    /// # Errors
    /// Bodies that the load pushes away for ever, and those that slide or tip against friction.
    pub fn if_few(&self, load: &KernelLoad) -> Result<()> {
        if self.dual.natural.r > FEW {
            return Ok(());
        }
        motions::check(self.problem, self.dual, (load, &[]), self.tuning)?;
        match self.has_friction() {
            true => self.in_cones(load),
            false => Ok(()),
        }
    }

    /// Whether the rows can carry the load, where there are many motions. Without friction the search begins at
    /// `lambda`, where a loop has come.
    ///
    /// # Errors
    /// Bodies that the load pushes away for ever, and those that slide or tip against friction.
    pub fn if_many(&self, load: &KernelLoad, lambda: &[f64]) -> Result<()> {
        if self.dual.natural.r <= FEW {
            return Ok(());
        }
        match self.has_friction() {
            true => self.in_cones(load),
            false => motions::check(self.problem, self.dual, (load, lambda), self.tuning),
        }
    }

    /// Whether the rows can carry the load where nodes with friction exert forces within their bounds alone. Coulomb's
    /// law may have no solution even then. The answer is the same wherever a loop has come: beyond the limit of
    /// friction its forces and displacements grow for ever, and have no digits.
    ///
    /// # Errors
    /// Bodies that slide, tip or fly away for ever, with the motion.
    pub fn in_cones(&self, load: &KernelLoad) -> Result<()> {
        let cones = cone::cones(&self.problem.friction, &self.dual.stiffness.jump);
        motions::check_cones(self.problem, self.dual, load, &cones, self.tuning)
    }

    fn has_friction(&self) -> bool {
        any(self.dual.comm(), !self.problem.friction.is_empty())
    }

    /// Whether a loop can begin with all candidates as equations: the load works on no motion that even these leave
    /// free. Where it pushes bodies away, the sentence says so, as it does of few motions.
    ///
    /// # Errors
    /// Bodies that the load pushes away for ever, and bodies that nothing holds.
    pub fn if_all_hold(&self, load: &KernelLoad) -> Result<()> {
        let dual = self.dual;
        let held = dual.natural.check_held(self.problem, &dual.stiffness, load);
        if held.is_err() {
            self.if_many(load, &vec![0.0; dual.stiffness.jump.n_owned])?;
        }
        held
    }

    /// ‖Pᵀ r‖ at the λ₀ that follows from the λ of `at`, which tolerances are relative to, where a loop can begin with
    /// all candidates as equations.
    ///
    /// # Errors
    /// As [`Existence::if_all_hold`]; PETSc's own.
    pub fn reference(&self, at: &mut Iterate) -> Result<f64> {
        self.if_all_hold(&at.loads.kernel)?;
        at.begin(self.dual)?;
        at.evaluate_projected(self.dual)
    }
}
