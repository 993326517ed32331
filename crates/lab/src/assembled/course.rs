//! The types of a loop around the assembled problem: tolerances, steps, its end.

use super::equations::Preconditioner;
use super::exerted::ExertedForces;
use super::refine::Refiner;
use base::Result;
use fetifeti::inside::driver::Course;
use petsc::{Ksp, Vec as PetscVec};

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

/// Where a loop begins.
#[derive(Clone, Copy)]
pub enum OuterStart<'a> {
    /// At the initial set, where all nodes stick, and u = 0.
    Cold,
    /// At this set, which is the only one.
    Given(&'a [bool]),
    /// Where the loop of the load step before has ended.
    After(&'a ActiveSetEnd),
}

/// The result of the loop.
pub struct ActiveSetEnd {
    /// The solution.
    pub u: PetscVec,
    /// The active set.
    pub active: Vec<bool>,
    /// The active set, and the tangential rows that follow from it where their nodes stick.
    pub held: Vec<bool>,
    /// Multipliers of the rows.
    pub lambda: Vec<f64>,
    /// B u − c, less what rows give way.
    pub gaps: Vec<f64>,
    /// The last preconditioner.
    pub(super) preconditioner: Preconditioner,
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
#[derive(Debug, Clone, Default)]
pub struct SetState {
    /// Whether each row is to hold.
    pub active: Vec<bool>,
    /// The order in which rows are made to hold.
    pub priority: Vec<usize>,
    /// Why a method that converges is needed.
    pub trouble: Option<&'static str>,
    /// The wrong rows of the set before, where this set is to be tried before that method is asked.
    pub fewest: Option<usize>,
    /// Forces of rows that do not hold.
    pub exerted: ExertedForces,
    /// The multipliers where a loop begins with friction; empty: none.
    pub lambda: Vec<f64>,
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
