//! The equations of one active set of the assembled problem, and the verdict on their solution.

use super::course::{
    ActiveSetEnd, OuterCertificate, OuterEnd, OuterSolve, OuterStep, SetState, Solvers, Tolerances,
};
use super::exerted::ExertedForces;
use super::groups::{multipliers, ActiveGroups, MultiplierSigns};
use super::judged::Judged;
use super::reduced::Reduced;
use super::refine::over;
use super::rows::Inequalities;
use base::Result;
use parallel::meter::timed;
use petsc::{Ksp, Session, Vec as PetscVec};

/// A spring counts as changed since the preconditioner was built if it is stiffer or softer by more than this.
const STIFFER: f64 = 2.0;

/// Some rows are kept active only so that no body comes loose. Such a row may pull by this part of the largest
/// multiplier: then no force drives the body away.
const IDLE: f64 = 1e-8;

/// How a set is solved.
#[derive(Clone, Copy)]
pub(super) struct Manner {
    /// Whether the residual is reduced to the tolerance, or only as far as a set needs that still changes.
    pub exact: bool,
    /// Whether only the worst row changes.
    pub single: bool,
    /// The signs that multipliers of dependent rows are to have.
    pub signs: MultiplierSigns,
    /// Factor on the reduction of the residual while the set changes.
    pub finer: f64,
    /// Factor on the tolerance.
    pub digits: f64,
}

impl Manner {
    /// A solve to the tolerance with these signs.
    pub const fn to_the_end(signs: MultiplierSigns) -> Manner {
        Manner {
            exact: true,
            single: false,
            signs,
            finer: 1.0,
            digits: 1.0,
        }
    }
}

/// The solution of a set, and what follows from it.
pub(super) struct Solved {
    /// The set.
    pub active: Vec<bool>,
    /// The set that follows.
    pub next: Vec<bool>,
    pub judged: Judged,
    pub certificate: OuterCertificate,
    /// The residual, relative to the load.
    pub residual: f64,
    /// Whether it is within the tolerance of the user, and was meant to be.
    pub met: bool,
    pub to_the_end: bool,
    /// Whether the rows that were put back hold bodies without force.
    pub held: bool,
    /// Why the solver has ended, and whether it failed.
    pub reason: (String, bool),
    pub step: OuterStep,
    groups: ActiveGroups,
}

impl Solved {
    /// Whether the loop may end with this set, which stays or is `right` all the same; and whether the last row that
    /// holds a body pulls there.
    pub fn settles(&self, right: bool) -> [bool; 2] {
        let settled = (self.stays() || right) && self.to_the_end;
        [settled && self.held, settled && !self.held]
    }

    /// Whether the set follows from itself.
    pub fn stays(&self) -> bool {
        self.next == self.active
    }

    /// The set that follows, and the order in which its rows are made to hold.
    pub fn following(self) -> SetState {
        SetState {
            priority: self.judged.priority(&self.active, &self.next),
            active: self.next,
            ..SetState::default()
        }
    }
}

/// A preconditioner, and the active set and springs for which it was built.
#[derive(Clone, Default)]
pub(super) struct Preconditioner {
    /// The solver that has it.
    ksp: Option<Ksp>,
    active: Vec<bool>,
    exerted: ExertedForces,
    is_built: bool,
}

/// The solver of one set after the other.
pub(super) struct Equations<'a> {
    session: &'a Session,
    rows: &'a Inequalities,
    reduced: &'a Reduced,
    pub solvers: &'a mut Solvers<'a>,
    tolerances: Tolerances,
    solve: OuterSolve<'a>,
    /// The present u, the start of the next solve.
    u: PetscVec,
    preconditioner: Preconditioner,
    /// The groups of the last set, where it is solved again.
    groups: Option<ActiveGroups>,
    /// Seconds for matrices and preconditioners.
    pub setup: f64,
}

impl<'a> Equations<'a> {
    /// The equations of these rows. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(
        session: &'a Session,
        (rows, reduced): (&'a Inequalities, &'a Reduced),
        solvers: &'a mut Solvers<'a>,
        tolerances: Tolerances,
        solve: OuterSolve<'a>,
    ) -> Result<Equations<'a>> {
        Ok(Equations {
            u: reduced.vector()?,
            session,
            rows,
            reduced,
            solvers,
            tolerances,
            solve,
            preconditioner: Preconditioner::default(),
            groups: None,
            setup: 0.0,
        })
    }

    /// Takes the first solver. Collective.
    ///
    /// # Errors
    /// Those of its source.
    pub fn start(&mut self) -> Result<()> {
        self.preconditioner.ksp = Some((self.solvers)()?);
        Ok(())
    }

    /// Goes on where another loop has ended, with its preconditioner. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn go_on(&mut self, end: &ActiveSetEnd) -> Result<()> {
        self.preconditioner = end.preconditioner.clone();
        self.u.copy_from(&end.u)
    }

    /// Whether solutions are refined.
    pub fn is_refined(&self) -> bool {
        matches!(self.solve, OuterSolve::Refined(_))
    }

    /// The tolerance of the residual, relative to the load.
    pub fn rtol(&self) -> f64 {
        self.tolerances.rtol
    }

    /// The next set is that of `solved` once more.
    pub fn again(&mut self, solved: Solved) {
        self.groups = Some(solved.groups);
    }

    /// The next solve begins at `u`, with a preconditioner of its own. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn restart(&mut self, u: &PetscVec) -> Result<()> {
        self.preconditioner.active.clear();
        self.u.copy_from(u)
    }

    /// The matrix of a set, and its preconditioner if that is to be built. Rows that cannot hold leave the set.
    fn prepared(&mut self, state: &mut SetState) -> Result<ActiveGroups> {
        if let Some(groups) = self.groups.take() {
            return Ok(groups);
        }
        let (rows, reduced) = (self.rows, self.reduced);
        let active = &mut state.active;
        let groups = ActiveGroups::new(rows, active, &state.priority);
        let last = &mut self.preconditioner;
        let (before, springs) = (&last.active, &last.exerted);
        let changed = active.iter().zip(before).filter(|(a, b)| a != b).count()
            + state.exerted.rows_changed(springs, STIFFER);
        let stale = changed as f64 > self.tolerances.lag * rows.len() as f64;
        // Where nothing iterates, the preconditioner is the solver.
        let other = self.tolerances.inner == 0.0 && !state.exerted.is_as_stiff(springs);
        let build = before.is_empty() || stale || other;
        if build {
            (last.active, last.exerted) = (active.clone(), state.exerted.clone());
        }
        let entries = state.exerted.entries(rows, &groups);
        let prepare = || {
            if build && last.is_built {
                last.ksp = Some((self.solvers)()?);
            }
            let ksp = last.ksp.as_ref().expect("the loop has begun");
            ksp.set_reuse_preconditioner(!build)?;
            reduced.update(&groups, &entries)?;
            ksp.set_operators(&reduced.a, &reduced.a)?;
            ksp.setup()
        };
        self.setup += timed(self.session, prepare)?.1;
        self.preconditioner.is_built = true;
        Ok(groups)
    }

    /// Solves the equations of a set from the present u, and judges its rows. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn solved(&mut self, state: &mut SetState, manner: Manner) -> Result<Solved> {
        let groups = self.prepared(state)?;
        let (rows, reduced, comm) = (self.rows, self.reduced, self.session.comm());
        let (u, active) = (&self.u, &state.active);
        let ksp = self.preconditioner.ksp.as_ref();
        let ksp = ksp.expect("the loop has begun");
        let exerted = |w: &[f64]| state.exerted.forces(rows, w);
        let b = reduced.rhs(&groups, &exerted(&groups.offset))?;
        let v = reduced.start(&groups, u)?;
        let reference = reduced.reference(&b)?;
        let target = manner.digits * self.tolerances.rtol * reference;
        let (r, d) = (reduced.vector()?, reduced.vector()?);
        let mut residual = residual_of(reduced, &b, &v, &r)?;
        let stop = match manner.exact {
            false => target.max(manner.finer * self.tolerances.inner * residual),
            true => target,
        };
        let mut reason = "CONVERGED_NOTHING_TO_DO".to_string();
        let (mut failed, mut correction) = (false, 0.0);
        let mut step = OuterStep {
            systems: 1,
            iterations: 0,
        };
        if let OuterSolve::Refined(refiner) = self.solve {
            let refined = refiner.refine(&groups, ksp, &v, &exerted)?;
            (residual, correction) = (refined.residual, refined.correction);
            (reason, failed) = refined.reason;
            step.iterations += refined.rounds;
        }
        let solves = match self.solve {
            OuterSolve::Once => usize::from(residual > stop),
            OuterSolve::Repeated(solves) => solves,
            OuterSolve::Refined(_) => 0,
        };
        for _ in 0..solves {
            ksp.set_tolerances(Some((stop / residual).min(0.9)), Some(0.0), None, None)?;
            ksp.solve(&r, &d)?;
            v.axpy(1.0, &d)?;
            step.iterations += ksp.iterations()?;
            let why = ksp.converged_reason()?;
            failed = !why.converged();
            reason = why.name;
            residual = residual_of(reduced, &b, &v, &r)?;
        }
        reduced.trace.spread(comm, &groups, &v, u)?;

        let at = reduced.trace.get(comm, u)?;
        let mut forces = match self.solve {
            OuterSolve::Refined(refiner) => refiner.forces(u)?,
            _ => reduced.forces(u)?,
        };
        let mut gaps = rows.gaps(&at);
        let others = exerted(&at);
        forces.iter_mut().zip(others).for_each(|(f, y)| *f -= y);
        let mut lambda = multipliers(rows, &rows.rigid(active), &forces, manner.signs);
        if rows.has_laws() {
            let others = state.exerted.multipliers(&gaps);
            lambda.iter_mut().zip(others).for_each(|(l, y)| *l += y);
            let soft = rows.compliance.iter().zip(&lambda);
            gaps.iter_mut()
                .zip(soft)
                .for_each(|(gap, (c, l))| *gap -= c * l);
        }
        let sizes = (u.norm_inf()?, reference);
        let judged = Judged::new(rows, active, lambda, gaps, sizes);
        let certificate = judged.certificate(correction);
        let relative = over(residual, reference);
        let mut next = judged.next.clone();
        if manner.single {
            judged.keep_worst(active, &mut next);
        }
        // Where there is friction, what holds bodies depends on the states of nodes.
        let restored = match rows.has_laws() {
            true => Vec::new(),
            false => rows.restore(&mut next, &judged.score, []),
        };
        let met = match self.solve {
            OuterSolve::Refined(_) => certificate.holds(),
            _ => relative <= self.tolerances.rtol,
        };
        Ok(Solved {
            active: active.clone(),
            next,
            held: restored.iter().all(|r| judged.idle(*r, IDLE)),
            judged,
            certificate,
            residual: relative,
            met,
            to_the_end: stop <= target,
            reason: (reason, failed),
            step,
            groups,
        })
    }

    /// The end of the loop with this solution, after these steps and seconds.
    pub fn ended(
        &self,
        solved: Solved,
        (steps, seconds): (&[OuterStep], f64),
        (converged, reason): OuterEnd,
    ) -> Result<ActiveSetEnd> {
        let u = self.reduced.vector()?;
        u.copy_from(&self.u)?;
        Ok(ActiveSetEnd {
            u,
            held: solved.active.clone(),
            active: solved.active,
            preconditioner: self.preconditioner.clone(),
            lambda: solved.judged.lambda,
            gaps: solved.judged.gaps,
            steps: steps.iter().map(|step| step.systems).sum(),
            iterations: steps.iter().map(|step| step.iterations).sum(),
            setup: self.setup,
            solve: seconds - self.setup,
            residual: solved.residual,
            certificate: solved.certificate,
            converged,
            reason,
        })
    }
}

/// r ← b − A v, and its norm.
fn residual_of(reduced: &Reduced, b: &PetscVec, v: &PetscVec, r: &PetscVec) -> Result<f64> {
    reduced.a.mult(v, r)?;
    r.aypx(-1.0, b)?;
    r.norm2()
}
