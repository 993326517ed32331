//! The result of a solve, and what it is made of.

pub use crate::contact::{ActiveSetProgress, Observer, State, Step};
pub use crate::feti::deflation::Cost;
pub use crate::feti::krylov::verdict::{Judge, JudgeTiming};
use crate::feti::LinearSolution;
pub use crate::feti::{
    CertificationResult, Certified, Communication, FreeMotion, Kkt, PerIteration, SetUpSummary,
    Spectrum, Uncertified,
};
use crate::status::Status;
pub use crate::substructures::{RowState, SolvedRow};
use crate::Result;
#[doc(inline)]
pub use petsc::ConvergedReason;

/// Estimates the discretisation error of displacements in the energy norm. Collective.
pub type Discretisation<'a> = dyn FnMut(&[Vec<f64>]) -> Result<f64> + 'a;

/// The solution of a problem, with contact or without; vectors are this rank's part.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Solution {
    /// Displacements of each local subdomain, by local dof; copies inside a body agree.
    pub u: Vec<Vec<f64>>,
    /// Multipliers of the rows that this rank owns.
    pub lambda: Vec<f64>,
    /// B u − c on these rows, including those that do not hold.
    pub gaps: Vec<f64>,
    /// Whether each of these rows holds at the end. Rows that follow from others that hold are included.
    pub active: Vec<bool>,
    /// Krylov iterations; with contact, of all steps of the loop.
    pub iterations: usize,
    /// The reason for the end; [`Solution::converged`] says whether everything reached its tolerance.
    pub status: Status,
    /// ‖r_n‖₂ for n = 0, 1, …; with contact, those of the last step that iterated.
    pub residuals: Vec<f64>,
    /// The Krylov method's own estimate of the spectrum; with contact, that of the last step that iterated.
    pub estimate: Option<Spectrum>,
    /// Optimality.
    pub kkt: Kkt,
    /// ½ uᵀ K u − fᵀ u + λᵀ (B u − c).
    pub energy: f64,
    /// Seconds of condensing and iterating.
    pub solve_seconds: f64,
    /// Seconds of the recovery of displacements.
    pub recover_seconds: f64,
    /// The bound of the error in the energy norm, or why there is none; `None` if nobody asked for it.
    pub certified: Option<CertificationResult>,
    /// Steps of the contact loop; empty without inequalities.
    pub steps: Vec<Step>,
    rows: Vec<SolvedRow>,
    tangential: Vec<SolvedRow>,
}

impl Solution {
    /// The solution from the result of the linear method, its rows, and the steps of the contact loop.
    pub(crate) fn new(found: LinearSolution, rows: Vec<SolvedRow>, steps: Vec<Step>) -> Solution {
        let (tangential, rows) = rows.into_iter().partition(|row| row.law.is_friction());
        Solution {
            u: found.u,
            lambda: found.lambda,
            gaps: found.gaps,
            active: found.active,
            iterations: found.iterations,
            status: found.status,
            residuals: found.residuals,
            estimate: found.estimate,
            kkt: found.kkt,
            energy: found.energy,
            solve_seconds: found.solve_seconds,
            recover_seconds: found.recover_seconds,
            certified: None,
            steps,
            rows,
            tangential,
        }
    }

    /// The start of the contact loop for other loads: the multipliers and the set of this solution.
    pub fn warm_start(&self) -> State {
        State::warm(self.lambda.clone(), &self.active)
    }

    /// The multipliers inside bodies, which come before those of the rows between bodies.
    pub fn inside_bodies(&self) -> &[f64] {
        let between = self.rows.len() + self.tangential.len();
        &self.lambda[..self.lambda.len() - between]
    }

    /// The rows between bodies that this rank provides, in its order, but for the tangential ones: body, node, normal,
    /// gap, multiplier, pressure, state.
    pub fn rows(&self) -> &[SolvedRow] {
        &self.rows
    }

    /// The tangential rows of nodes with friction that this rank provides, in its order. The normal of each is its
    /// direction, its multiplier the force along it with which the first body drags the other side along, its gap less
    /// than zero by the slip of the load step, its state whether the node sticks, slips or is apart.
    pub fn tangential_rows(&self) -> &[SolvedRow] {
        &self.tangential
    }

    /// Whether everything reached its tolerance, or rounding where the tolerance is below it.
    pub fn converged(&self) -> bool {
        self.status.converged()
    }
}
