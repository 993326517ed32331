//! The linear method, set up for one problem. Only Z^k, the set of rows that hold, may change.

use std::cell::{Cell, OnceCell, Ref};
use std::rc::Rc;
use std::sync::Arc;

use super::krylov::check;
use super::krylov::system::DualSystem;
use super::krylov::tally::Communication;
use super::operators::dual::Dual;
use super::set_up_summary::SetUpSummary;
use super::settings::MethodSettings;
use super::setup::SetUpResult;
use super::subdomain::retained::RetainedFactors;
use crate::substructures::{FrictionNode, Problem, Row};
use crate::Result;
use cholesky::interior::Analysed;
use parallel::exchange::any;
use petsc::{Ksp, Session};

/// The operators, the Krylov method and facts about the problem.
pub struct LinearMethod {
    pub(crate) session: Session,
    pub(crate) problem: Problem,
    /// With options applied.
    pub(crate) settings: MethodSettings,
    /// The dual problem as the Krylov method works on it.
    pub(crate) system: Rc<DualSystem>,
    pub(crate) ksp: Ksp,
    pub(crate) facts: SetUpSummary,
    /// The largest displacement of the solutions so far: the scale of the problem where a later load vanishes.
    pub(crate) length: Cell<f64>,
    /// The largest ratio of coefficients inside a body.
    pub(crate) varies: f64,
    /// The eigenvalue from which deflation is worth its cost, once it is asked for, and the largest one below it that
    /// an iteration has seen and `auto` would deflate with fewer bodies.
    pub(super) worth: OnceCell<f64>,
    pub(super) declined: Cell<f64>,
    /// The symbolic analysis of each local subdomain, kept for further set-ups.
    pub(super) analysed: Vec<Option<Arc<Analysed>>>,
}

/// Other numbers for the matrix of a subdomain, whose pattern stays.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Numbers {
    /// The entries of K in their order.
    pub k: Vec<f64>,
    /// ρ of each dof ([`Subdomain::rho`](crate::Subdomain::rho)).
    pub rho: Vec<f64>,
}

impl Numbers {
    /// The entries of K in their order, and ρ of each dof.
    pub fn new(k: Vec<f64>, rho: Vec<f64>) -> Numbers {
        Numbers { k, rho }
    }
}

impl LinearMethod {
    /// The session that it works in.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// The substructures that it was set up for.
    pub fn problem(&self) -> &Problem {
        &self.problem
    }

    /// The dual problem as the Krylov method works on it.
    pub fn system(&self) -> &DualSystem {
        &self.system
    }

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

    /// Replaces the rows between bodies that this rank provides, and the nodes with friction among them. Subdomains
    /// whose interface stays the same stay factored, all else is set up anew. After an error the old rows are there as
    /// they were. Collective.
    ///
    /// # Errors
    /// Bad rows, a body that nothing holds, PETSc's own errors; the same on all ranks.
    pub fn set_rows(&mut self, rows: Vec<Row>, friction: Vec<FrictionNode>) -> Result<()> {
        let adapted = self.facts.adaptive_constraints.iter().any(|n| *n > 0);
        // Adaptive constraints have changed the operators of subdomains.
        let kept = self.kept();
        let kept = if adapted { kept.patterns() } else { kept };
        let before = self.problem.replace_rows(rows, friction);
        match SetUpResult::new(&self.session, &self.problem, &self.settings, Some(&kept)) {
            Ok(made) => {
                self.take(made);
                Ok(())
            }
            Err(error) => {
                self.problem.replace_rows(before.0, before.1);
                Err(error)
            }
        }
    }

    /// This problem, set up again with other numbers in all matrices, and with other interface rows if there are some.
    /// Patterns are not analysed again. `None` if a subdomain turns out to have motions without energy that it did not
    /// have: whatever follows from its motions is no longer right. Collective.
    ///
    /// # Errors
    /// As [`LinearMethod::new`].
    pub fn renewed(
        self,
        numbers: Vec<Numbers>,
        rows: Option<(Vec<Row>, Vec<FrictionNode>)>,
    ) -> Result<Option<LinearMethod>> {
        let session = self.session.clone();
        let kept = self.kept().patterns();
        let free = |method: &LinearMethod| -> Vec<usize> {
            let dual = method.dual();
            let fixing = dual.stiffness.locals.iter().map(|l| l.gamma().fixing.len());
            fixing.collect()
        };
        let before = free(&self);
        let (length, seconds) = (self.length.get(), self.facts.setup_seconds);
        let LinearMethod {
            mut problem,
            settings,
            ..
        } = self;
        for (sub, new) in problem.local.iter_mut().zip(numbers) {
            assert_eq!(
                (sub.k.val.len(), sub.rho.len()),
                (new.k.len(), new.rho.len())
            );
            Arc::make_mut(&mut sub.k).val = new.k;
            sub.rho = new.rho;
        }
        if let Some((rows, friction)) = rows {
            problem.replace_rows(rows, friction);
        }
        let mut out = LinearMethod::keeping(&session, problem, settings, Some(&kept))?;
        let more = free(&out).iter().zip(&before).any(|(now, then)| now > then);
        if any(session.comm(), more) {
            return Ok(None);
        }
        out.length.set(length);
        out.facts.setup_seconds += seconds;
        Ok(Some(out))
    }

    /// The subdomains as they are factored. The operators may have adaptive constraints that rows do not know.
    fn kept(&self) -> RetainedFactors {
        let dual = self.dual();
        let s = &dual.stiffness;
        RetainedFactors::new(&s.jump, &s.locals, &self.analysed, s.primal.patterns())
    }

    /// Changes Z^k to `active` (one per owned row). Returns the number of rows that changed over all ranks. Collective.
    pub(crate) fn set_active(&self, active: &[bool]) -> Result<usize> {
        self.system.set_active(&self.problem, active)
    }

    /// Does `work`, which may change Z^k. Z^k is then what it was before, whether `work` succeeds or not. Collective.
    ///
    /// # Errors
    /// Those of `work`; PETSc's own.
    pub(crate) fn with_rows_put_back<T>(&self, work: impl FnOnce() -> Result<T>) -> Result<T> {
        let before = self.dual().stiffness.jump.active.clone();
        let done = work();
        let put_back = self.set_active(&before);
        // What `work` says is the reason, if both fail.
        let done = done?;
        put_back?;
        Ok(done)
    }

    /// Does `work`, which may change Z^k. If it succeeds, Z^k stays where `work` has brought it; else Z^k is what it
    /// was before. Collective.
    ///
    /// # Errors
    /// Those of `work`.
    pub(crate) fn with_rows_kept<T>(&self, work: impl FnOnce() -> Result<T>) -> Result<T> {
        let before = self.dual().stiffness.jump.active.clone();
        work().inspect_err(|_| {
            // The error of `work` is the one that counts.
            let _ = self.set_active(&before);
        })
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
