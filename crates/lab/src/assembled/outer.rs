//! Inequalities on the assembled problem: the driver of the contact loop around solvers of PETSc.
//!
//! ```text
//!     solve Tᵀ K T v = Tᵀ(f − K u₀) on A_k,  Bᵀ λ = f − K u,  A_{k+1} = { j : λ_j > 0 on A_k, (B u − c)_j > 0 off it }
//! ```
//!
//! There are two strategies: sets that follow from each other ([`sets`](super::sets)), and those of a method that
//! converges, to which it hands over ([`trials`](super::trials)).

use std::cell::RefCell;

use super::equations::Equations;
use super::reduced::Reduced;
use super::refine::Refiner;
use super::rows::Inequalities;
use super::sets::WanderingSets;
use super::trials::Trials;
use base::Result;
use fetifeti::driver::{self, Begin, Begun, Course, InnerProblem, Verdict};
use petsc::{Ksp, Session, Vec as PetscVec};

/// The certificate of a refined solution must be below this.
const CERTIFIED: f64 = 1e-9;

/// Tolerances.
#[derive(Debug, Clone, Copy)]
pub struct Tolerances {
    /// Residual at the end, relative to the load.
    pub rtol: f64,
    /// Reduction of the residual in a step while the set still changes.
    pub inner: f64,
    /// The preconditioner is kept until more than this part of all rows has changed since it was built.
    pub lag: f64,
}

/// How the equations of one active set are solved.
#[derive(Clone, Copy)]
pub enum OuterSolve<'a> {
    /// One solve.
    Once,
    /// This many solves, of which all but the first refine a direct solution.
    Repeated(usize),
    /// A direct solution that is refined in twice the working precision.
    Refined(&'a Refiner<'a>),
}

/// The result of the loop.
pub struct ActiveSetEnd {
    /// The solution.
    pub u: PetscVec,
    /// The active set.
    pub active: Vec<bool>,
    /// Multipliers of the rows.
    pub lambda: Vec<f64>,
    /// B u − c.
    pub gaps: Vec<f64>,
    /// Number of systems of equations that were solved, one for each set or Newton step.
    pub steps: usize,
    /// Inner iterations of all steps.
    pub iterations: usize,
    /// Seconds for matrices and preconditioners.
    pub setup: f64,
    /// Seconds for everything else.
    pub solve: f64,
    /// Residual, relative to the load.
    pub residual: f64,
    /// How well the conditions of optimality hold.
    pub certificate: OuterCertificate,
    /// Whether the set has settled and the residual is small enough; where the solution is refined, whether the
    /// certificate holds.
    pub converged: bool,
    /// Why the loop ended.
    pub reason: String,
}

/// How well the conditions of optimality hold, each relative to the size of its terms.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct OuterCertificate {
    /// The last correction of a refinement relative to the solution, in the energy norm or by the largest displacement,
    /// whichever is larger. It bounds the error in u even where the residual is small against its terms.
    pub correction: f64,
    /// Largest violation of an inequality over the largest |u|.
    pub feasibility: f64,
    /// Largest pull, over the largest multiplier.
    pub pull: f64,
}

impl OuterCertificate {
    /// The largest of the three.
    pub fn largest(&self) -> f64 {
        self.correction.max(self.feasibility).max(self.pull)
    }

    /// Whether the certificate is small enough for a refined solution.
    pub fn holds(&self) -> bool {
        self.largest() < CERTIFIED
    }
}

/// The source of the loop's solvers. It is called whenever a preconditioner is built, and returns the previous solver
/// or a new one, with options, but without operator and set-up.
pub type Solvers<'a> = dyn FnMut() -> Result<Ksp> + 'a;

/// The types of a loop around the assembled problem.
pub struct AssembledCourse;

impl Course for AssembledCourse {
    type State = SetState;
    type Step = OuterStep;
    type End = OuterEnd;
    type Solution = ActiveSetEnd;
}

/// The next set.
#[derive(Debug, Clone)]
pub struct SetState {
    /// Whether each row is to hold.
    pub active: Vec<bool>,
    /// The order in which rows are made to hold.
    pub priority: Vec<usize>,
    /// Why a method that converges is needed.
    pub trouble: Option<&'static str>,
}

/// Numbers of one step.
#[derive(Debug, Clone, Copy, Default)]
pub struct OuterStep {
    /// Systems of equations.
    pub systems: usize,
    /// Iterations of their solvers.
    pub iterations: usize,
}

/// Whether a solution was found, and why the loop has ended.
pub type OuterEnd = (bool, String);

/// The assembled problem.
struct AssembledRows<'a> {
    session: &'a Session,
    rows: &'a Inequalities,
    reduced: &'a Reduced,
    /// The solver of one set. Only the strategy that runs has it.
    equations: RefCell<Equations<'a>>,
    given: Option<&'a [bool]>,
}

impl InnerProblem for AssembledRows<'_> {
    type Course = AssembledCourse;

    fn begin<'a>(&'a self, begin: Begin<SetState>) -> Result<Begun<'a, AssembledCourse>> {
        let mut equations = self.equations.borrow_mut();
        Ok(match begin {
            Begin::HandOver(state) => {
                let search = (self.session, self.rows, self.reduced);
                drop(equations);
                Box::new(Trials::new(search, &self.equations, state)?)
            }
            Begin::First(_) | Begin::Again(_) => {
                equations.start()?;
                drop(equations);
                let state = SetState {
                    active: self
                        .given
                        .map_or_else(|| self.rows.initial.clone(), <[bool]>::to_vec),
                    priority: (0..self.rows.len()).collect(),
                    trouble: None,
                };
                let is_given = self.given.is_some();
                Box::new(WanderingSets::new(&self.equations, state, is_given))
            }
        })
    }

    /// The strategies end by themselves.
    fn stop(&self, _: &SetState) -> Option<OuterEnd> {
        None
    }

    fn is_doubtful(&self, _: usize) -> bool {
        false
    }

    /// A loop that finds nothing says so; why is for others to find out.
    fn doubt(&self, _: &SetState) -> Result<()> {
        Ok(())
    }

    fn doubt_end(&self, _: &ActiveSetEnd) -> Result<()> {
        Ok(())
    }

    /// Every set has its certificate.
    fn certify(&self, found: ActiveSetEnd, _: usize, _: usize) -> Result<Verdict<AssembledCourse>> {
        Ok(Verdict::Done(found))
    }

    fn joined(&self, _: &ActiveSetEnd, next: ActiveSetEnd) -> ActiveSetEnd {
        next
    }
}

/// Runs the loop. Where a set is given, only its equations are solved. Collective.
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
    given: Option<&[bool]>,
) -> Result<ActiveSetEnd> {
    let equations = Equations::new(session, (rows, reduced), solvers, tolerances, solve)?;
    let problem = AssembledRows {
        session,
        rows,
        reduced,
        equations: RefCell::new(equations),
        given,
    };
    Ok(driver::solve(&problem, None, &mut |_, _| Ok(()))?.0)
}
