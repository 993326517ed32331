//! The linear method as the inner problem of the contact loop, and its strategies.
//!
//! | strategy | proposes |
//! |---|---|
//! | [`ActiveSet`] | the equations on the set that multipliers and gaps ask for |
//! | [`AugmentedLagrangian`] | semismooth Newton steps on springs, and trials of the sets that they find |
//! | [`Smalbe`] | problems with bounds and discs by MPRGP, and trials of the sets and states that they find |
//! | [`Friction`] | the equations on the rows that hold and the nodes that stick, with given forces along slips |
//! | [`FrictionLagrangian`] | semismooth Newton steps with discs, and trials of the states that they find |
//!
//! A trial wraps a strategy: it is an [`ActiveSet`], or with friction a [`Friction`], followed for as long as it comes
//! nearer. A new strategy is a file with a [`Strategy`](super::strategy::Strategy), and a line in
//! [`begin`](DualProblem::begin).

use super::active_set::ActiveSet;
use super::certified_signs::{signs, Signs};
use super::course::DualCourse;
use super::driver::{self, Begin, Begun, InnerProblem, Verdict};
use super::existence::Existence;
use super::friction::{self, Friction, FrictionLagrangian};
use super::lagrangian::AugmentedLagrangian;
use super::modes::GivenMultipliers;
use super::settings::{ContactSettings, ContactType};
use super::smalbe::Smalbe;
use super::state::{Observer, State, Step};
use crate::feti::krylov::loads::Loads;
use crate::feti::{LinearMethod, LinearSolution};
use crate::status::Status;
use crate::Result;

/// Solves the problem with its inequalities. Returns the solution and the steps of the loop. After an error the rows of
/// the method hold that held before. Collective.
///
/// # Errors
/// Contradictory rows, bodies that the load pushes away for ever, PETSc's own errors, and those of `observe`.
pub(crate) fn solve(
    method: &LinearMethod,
    settings: &ContactSettings,
    start: Option<&State>,
    observe: &mut Observer,
) -> Result<(LinearSolution, Vec<Step>)> {
    method.with_rows_kept(|| {
        Existence::new(method, &method.dual(), settings).of_gaps()?;
        let friction = friction::is_asked_for(method);
        let problem = DualProblem {
            method,
            settings,
            start,
            friction,
        };
        let _given = GivenMultipliers::of(method);
        driver::solve(&problem, start.cloned(), observe)
    })
}

/// The linear method with its inequalities.
struct DualProblem<'m> {
    method: &'m LinearMethod,
    settings: &'m ContactSettings,
    /// The state from which the loop goes on.
    start: Option<&'m State>,
    /// Whether there is friction, or soft contact.
    friction: bool,
}

impl DualProblem<'_> {
    /// Asks whether there is a solution, from the λ where the loop is. Few rigid motions are asked about before the
    /// loop, many only here.
    fn ask(&self, lambda: &[f64]) -> Result<()> {
        let (method, dual) = (self.method, self.method.dual());
        let load = Loads::new(&method.problem, &dual).kernel;
        Existence::new(method, &dual, self.settings).if_many(&load, lambda)
    }
}

impl InnerProblem for DualProblem<'_> {
    type Course = DualCourse;

    fn begin<'a>(&'a self, begin: Begin<State>) -> Result<Begun<'a, DualCourse>> {
        let (method, settings) = (self.method, self.settings);
        let (kind, start) = match begin {
            Begin::First(start) => (settings.kind, start),
            Begin::HandOver(state) => (ContactType::AugmentedLagrangian, Some(state)),
            Begin::Again(state) => (ContactType::ActiveSet, Some(state)),
        };
        let state = |start: Option<State>| {
            start.unwrap_or_else(|| State::cold(&method.dual().stiffness.jump))
        };
        Ok(match (kind, self.friction) {
            (ContactType::ActiveSet, false) => {
                Box::new(ActiveSet::new(method, settings, start.as_ref())?)
            }
            (ContactType::ActiveSet, true) => {
                Box::new(Friction::new(method, settings, start.as_ref())?)
            }
            (ContactType::AugmentedLagrangian, false) => {
                Box::new(AugmentedLagrangian::new(method, settings, state(start))?)
            }
            (ContactType::AugmentedLagrangian, true) => {
                Box::new(FrictionLagrangian::new(method, settings, state(start))?)
            }
            (ContactType::Smalbe, _) => Box::new(Smalbe::new(method, settings, state(start))?),
        })
    }

    fn stop(&self, state: &State) -> Option<Status> {
        (state.steps >= self.settings.max_it).then_some(Status::ContactSteps)
    }

    fn is_doubtful(&self, steps: usize) -> bool {
        steps == self.settings.tuning.doubt_after
    }

    fn doubt(&self, at: &State) -> Result<()> {
        self.ask(&at.lambda)
    }

    fn doubt_end(&self, found: &LinearSolution) -> Result<()> {
        if found.status.converged() {
            return Ok(());
        }
        self.ask(&found.lambda)
    }

    fn certify(
        &self,
        found: LinearSolution,
        steps: usize,
        round: usize,
    ) -> Result<Verdict<DualCourse>> {
        let (method, tuning) = (self.method, &self.settings.tuning);
        let mut certified = method.certify(method.refine(found)?)?;
        let is_last = round == tuning.certified_rounds;
        // A certificate that rows on the wrong side have spoilt is for the loop to mend.
        let spoilt = certified.status == Status::Certificate && !is_last;
        if !certified.status.converged() && !spoilt {
            return Ok(Verdict::Done(certified));
        }
        match signs(method, tuning, &certified)? {
            Signs::Right => Ok(Verdict::Done(certified)),
            Signs::Shared(lambda) => {
                let shared = method.with_multipliers(certified, lambda)?;
                Ok(Verdict::Done(shared))
            }
            Signs::Wrong(_) if is_last => {
                certified.status = Status::Certificate;
                Ok(Verdict::Done(certified))
            }
            Signs::Wrong(mut state) => {
                state.accuracy = tuning.certified_reduction.powi(round as i32 + 1);
                if let Some(start) = self.start {
                    state.steps = start.steps;
                    state.slid.clone_from(&start.slid);
                }
                state.steps += steps;
                Ok(Verdict::Wrong(state, certified))
            }
        }
    }

    fn joined(&self, before: &LinearSolution, next: LinearSolution) -> LinearSolution {
        LinearSolution {
            iterations: before.iterations + next.iterations,
            solve_seconds: before.solve_seconds + next.solve_seconds,
            ..next
        }
    }
}
