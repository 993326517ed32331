//! Inequalities on the assembled problem: the driver of the contact loop around solvers of PETSc.
//!
//! ```text
//!     solve Tᵀ K T v = Tᵀ(f − K u₀) on A_k,  Bᵀ λ = f − K u,  A_{k+1} = { j : λ_j > 0 on A_k, (B u − c)_j > 0 off it }
//! ```
//!
//! There are three strategies: sets that follow from each other ([`sets`](super::sets)), and those of a method that
//! converges, to which it hands over ([`trials`](super::trials)); where there is friction or soft contact, states of
//! nodes that follow from each other ([`friction`](super::friction)).

use std::cell::RefCell;

use super::course::{
    ActiveSetEnd, AssembledCourse, OuterSolve, OuterStart, SetState, Solvers, Tolerances,
};
use super::equations::Equations;
use super::friction::StickAndSlip;
use super::reduced::Reduced;
use super::rows::Inequalities;
use super::sets::WanderingSets;
use super::trials::Trials;
use base::Result;
use fetifeti::inside::driver::{self, Begin, Begun, InnerProblem, Verdict};
use petsc::Session;

/// The assembled problem.
struct AssembledRows<'a> {
    session: &'a Session,
    rows: &'a Inequalities,
    reduced: &'a Reduced,
    /// The solver of one set. Only the strategy that runs has it.
    equations: RefCell<Equations<'a>>,
    start: OuterStart<'a>,
}

impl InnerProblem for AssembledRows<'_> {
    type Course = AssembledCourse;

    fn begin<'a>(&'a self, begin: Begin<SetState>) -> Result<Begun<'a, AssembledCourse>> {
        Ok(match begin {
            Begin::HandOver(state) => {
                let search = (self.session, self.rows, self.reduced);
                Box::new(Trials::new(search, &self.equations, state)?)
            }
            Begin::First(_) | Begin::Again(_) => {
                let mut equations = self.equations.borrow_mut();
                match self.start {
                    OuterStart::After(end) => equations.go_on(end)?,
                    OuterStart::Cold | OuterStart::Given(_) => equations.start()?,
                }
                drop(equations);
                let (active, lambda) = match self.start {
                    OuterStart::Cold => (self.rows.initial.clone(), Vec::new()),
                    OuterStart::Given(set) => (set.to_vec(), Vec::new()),
                    OuterStart::After(end) => (end.held.clone(), end.lambda.clone()),
                };
                let state = SetState {
                    active,
                    priority: (0..self.rows.len()).collect(),
                    lambda,
                    ..SetState::default()
                };
                let is_given = matches!(self.start, OuterStart::Given(_));
                if self.rows.has_laws() && !is_given {
                    let inner = (self.rows, self.reduced);
                    return Ok(Box::new(StickAndSlip::new(inner, &self.equations, state)));
                }
                Box::new(WanderingSets::new(&self.equations, state, is_given))
            }
        })
    }

    /// Every set has its certificate.
    fn certify(&self, found: ActiveSetEnd, _: usize, _: usize) -> Result<Verdict<AssembledCourse>> {
        Ok(Verdict::Done(found))
    }
}

/// Runs the loop. Collective.
///
/// # Errors
/// PETSc's.
pub fn solve(
    session: &Session,
    rows: &Inequalities,
    reduced: &Reduced,
    solvers: &mut Solvers,
    tolerances: Tolerances,
    solve: OuterSolve,
    start: OuterStart,
) -> Result<ActiveSetEnd> {
    let equations = Equations::new(session, (rows, reduced), solvers, tolerances, solve)?;
    let problem = AssembledRows {
        session,
        rows,
        reduced,
        equations: RefCell::new(equations),
        start,
    };
    Ok(driver::solve(&problem, None, &mut |_, _| Ok(()))?.0)
}
