//! The result of a solve.

use crate::petsc::named;
use crate::status::Status;
use crate::substructures::SolvedRow;

/// The smallest and the largest eigenvalue of an operator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spectrum {
    /// Smallest eigenvalue outside the kernel.
    pub lambda_min: f64,
    /// Largest eigenvalue.
    pub lambda_max: f64,
}

impl Spectrum {
    /// λ_max / λ_min.
    pub fn kappa(&self) -> f64 {
        self.lambda_max / self.lambda_min
    }
}

/// How well the optimality conditions hold, relative to the sizes of their terms.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Kkt {
    /// ‖K u − f + Bᵀ λ‖ / (‖f‖ + ‖Bᵀ λ‖) in the norm of diag(K)⁻¹, in which stiff and soft parts have the same weight.
    /// Residuals of primal dofs and averages are summed over their copies.
    pub stationarity: f64,
    /// Largest violation of B u = c (≤ c) over the largest |u|; inequality rows count whether or not they hold.
    pub feasibility: f64,
    /// Largest |λ_r (B u − c)_r| over inequality rows, relative to max |λ| · max |u|; zero without inequality rows.
    pub complementarity: f64,
    /// Smallest multiplier of an inequality row, relative to max |λ|; zero without inequality rows.
    pub min_multiplier: f64,
}

/// The method of the outer loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactType {
    /// Primal-dual active set.
    ActiveSet,
    /// SMALBE-M with MPRGP.
    Smalbe,
}

named!(ContactType { ActiveSet = "active_set", Smalbe = "smalbe" });

/// Record of one step of the outer loop.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// The method of the step.
    pub method: ContactType,
    /// Rows of B_gl that held.
    pub active: usize,
    /// Number of rows that hold now and did not in the step before.
    pub entered: usize,
    /// Number of rows that held in the step before and do not now.
    pub left: usize,
    /// Krylov iterations.
    pub iterations: usize,
    /// The Krylov method's estimate of the spectrum.
    pub estimate: Option<Spectrum>,
    /// Exact spectrum with these rows, if `-fetifeti_spectrum` asks for it.
    pub exact: Option<Spectrum>,
    /// Residual at the end, relative to the reference.
    pub residual: f64,
    /// The tolerance of the step.
    pub tolerance: f64,
    /// Number of inequality rows that are on the wrong side at the end of the step: violated, or with a pulling
    /// multiplier.
    pub wrong: usize,
    /// Seconds.
    pub seconds: f64,
}

/// The solution of a problem, with contact or without; vectors are this rank's part.
#[derive(Debug, Clone)]
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
    /// Steps of the contact loop; empty without inequalities.
    pub steps: Vec<Step>,
    pub(crate) rows: Vec<SolvedRow>,
}

impl Solution {
    /// The rows between bodies that this rank provides, in its order: body, node, normal, gap, multiplier, pressure,
    /// state.
    pub fn rows(&self) -> &[SolvedRow] {
        &self.rows
    }

    /// Whether everything reached its tolerance.
    pub fn converged(&self) -> bool {
        self.status.converged()
    }
}
