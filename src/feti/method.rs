//! The linear method, set up for one problem. Only Z^k, the set of rows that hold, may change.

use std::cell::{Cell, Ref};
use std::rc::Rc;

use super::facts::Facts;
use super::krylov::check;
use super::krylov::system::System;
use super::krylov::tally::Communication;
use super::operators::dual::Dual;
use super::settings::MethodSettings;
use super::subdomain::kept::Kept;
use crate::petsc::{Ksp, Session};
use crate::substructures::{InterfaceRow, Substructures};
use crate::Result;

/// The operators, the Krylov method and facts about the problem.
pub struct LinearMethod {
    pub(crate) session: Session,
    pub(crate) problem: Substructures,
    /// With options applied.
    pub(crate) settings: MethodSettings,
    /// The dual problem as the Krylov method works on it.
    pub(crate) system: Rc<System>,
    pub(crate) ksp: Ksp,
    pub(crate) facts: Facts,
    /// The largest displacement of the solutions so far: the scale of the problem where a later load vanishes.
    pub(crate) length: Cell<f64>,
    /// The largest ratio of coefficients inside a body.
    pub(crate) varies: f64,
}

impl LinearMethod {
    /// Replaces the loads (one vector per local subdomain) and the right-hand sides c of the rows, which are in the
    /// order in which this rank provides them. Nothing is factored again.
    ///
    /// # Panics
    /// If a length differs from the present one.
    pub fn set_loads(&mut self, loads: Vec<Vec<f64>>, gaps: &[f64]) {
        assert_eq!(loads.len(), self.problem.local.len());
        assert_eq!(gaps.len(), self.problem.rows.len());
        for (sub, f) in self.problem.local.iter_mut().zip(loads) {
            assert_eq!(f.len(), sub.f.len());
            sub.f = f;
        }
        for (row, &gap) in self.problem.rows.iter_mut().zip(gaps) {
            row.gap = gap;
        }
        self.system.set_gaps(gaps);
    }

    /// Replaces the rows between bodies that this rank provides. Subdomains whose interface stays the same stay
    /// factored, all else is set up anew. Collective.
    ///
    /// # Errors
    /// Bad rows, a body that nothing holds, PETSc's own errors; the same on all ranks.
    pub fn set_rows(&mut self, rows: Vec<InterfaceRow>) -> Result<()> {
        let adapted = self.facts.adaptive_constraints.iter().any(|n| *n > 0);
        // Adaptive constraints have changed the operators of subdomains.
        let kept = (!adapted).then(|| {
            let dual = self.dual();
            Kept::new(&dual.stiffness.jump, &dual.stiffness.locals)
        });
        let problem = Substructures {
            local: std::mem::take(&mut self.problem.local),
            body_names: std::mem::take(&mut self.problem.body_names),
            rows,
            ..self.problem
        };
        let (length, seconds) = (self.length.get(), self.facts.setup_seconds);
        let settings = self.settings.clone();
        *self = LinearMethod::keeping(&self.session.clone(), problem, settings, kept.as_ref())?;
        self.length.set(length);
        self.facts.setup_seconds += seconds;
        Ok(())
    }

    /// Changes Z^k to `active` (one per owned row). Returns the number of rows that changed over all ranks. Collective.
    pub(crate) fn set_active(&self, active: &[bool]) -> Result<usize> {
        self.system.set_active(&self.problem, active)
    }

    /// The identities of the theory, each with its relative defect, which must be of the size of rounding. Collective.
    pub fn check(&self) -> Result<Vec<(&'static str, f64)>> {
        check::identities(&self.problem, &self.system)
    }

    /// F, M⁻¹ and P for the rows that hold.
    pub fn dual(&self) -> Ref<'_, Dual> {
        self.system.dual()
    }

    /// Messages and reductions per iteration, over all iterations of the Krylov method so far; `None` if there were
    /// none. Collective.
    pub fn communication(&self) -> Option<Communication> {
        Communication::of(self.session.comm(), &self.system.tally())
    }
}
