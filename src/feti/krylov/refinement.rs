//! Iterative refinement of displacements and multipliers.
//!
//! S, T, Ψ and S_Π carry the rounding of their factorisations. This rounding is large where coefficients jump inside
//! subdomains, or with supports of 1e-8. K itself does not carry it. The residual r of (u, λ) is the load of a
//! correction problem with the same operators:
//!
//! ```text
//!     r = f − K u − Bᵀ λ,    (du, dλ) solves it with load r and jumps c − B u,    u ← u + du,  λ ← λ + dλ
//! ```
//!
//! r is summed in twice the working precision. The set of rows that hold does not change. If the tolerance is below
//! [`TIGHT`], the first iteration stops at `TIGHT` and corrections bring the remaining digits. A single iteration would
//! stall on the rounding of the operators, or diverge. Where corrections stop to help above the tolerance, the status
//! is [`Status::Rounding`].

use super::certificate::{Certificate, Kkt};
use super::iterate::{iterate, IterationControl};
use super::loads::Loads;
use super::recovery::{displacements, LinearSolution};
use super::residual::{Iterate, ROUNDING};
use crate::feti::method::LinearMethod;
use crate::feti::operators::dual::Dual;
use crate::status::Status;
use crate::substructures::{Problem, Subdomain};
use crate::Result;
use base::linalg::strained::strained;
use parallel::exchange::total;
use petsc::Vec as PetscVec;

/// Tolerances below this may be beyond the accuracy of the operators.
pub const TIGHT: f64 = 1e-9;

/// A solution is refined if its certificate is above this many times the tolerance.
const WORTH: f64 = 10.0;

/// Tolerances below `TIGHT` count as missed if the certificate is above this many times the tolerance.
const MISSED: f64 = 1e4;

/// A tolerance never counts as missed if the certificate is below this.
const FLOOR: f64 = 1e-11;

/// Displacements are not a solution yet if their stationarity is above this and above a thousand times the tolerance.
const FAR: f64 = 1e-3;

/// Largest number of steps. Each step must at least halve the certificate.
pub(super) const STEPS: usize = 4;

impl LinearMethod {
    /// Refines a solution towards the tolerance of the user, as far as it helps. Collective.
    pub(crate) fn refine(&self, mut solution: LinearSolution) -> Result<LinearSolution> {
        let rtol = self.relative_tolerance(&solution)?;
        for _ in 0..STEPS {
            let now = distance(&solution.kkt);
            let asked = rtol < TIGHT && now > WORTH * rtol;
            let far = solution.kkt.stationarity > FAR.max(1e3 * rtol);
            if !solution.status.converged() || !(asked || far) {
                break;
            }
            // A step reduces the residual by no more digits than are missing. Where the displacements are not a
            // solution yet, that number is not known.
            let most = if far { 1e-2 } else { 0.3 };
            let reduction = (rtol / now).clamp(1e-6, most);
            match self.refined(&solution, reduction)?.better {
                Some(better) => solution = better,
                None => break,
            }
        }
        let left = distance(&solution.kkt);
        if solution.status.converged() && rtol < TIGHT {
            if left > (MISSED * rtol).max(FLOOR) {
                solution.status = Status::Refinement;
            } else if !is_reached(rtol, left) {
                solution.status = Status::Rounding;
            }
        }
        Ok(solution)
    }

    /// The tolerance relative to the first residual: an absolute tolerance may be the larger one. A first residual of
    /// rounding says nothing: beside it any absolute tolerance, PETSc's 1e-50 too, would allow everything. Collective.
    pub(super) fn relative_tolerance(&self, solution: &LinearSolution) -> Result<f64> {
        let (rtol, atol, _, _) = self.ksp.tolerances()?;
        Ok(match solution.residuals.first() {
            // Beside a larger one it is the smaller tolerance all the more.
            Some(&first) if atol <= rtol * first => rtol,
            Some(&first) if first > 0.0 => rtol.max(atol / first.max(self.least_residual())),
            _ => rtol,
        })
    }

    /// One step, which reduces the residual of the correction problem by the factor `reduction`. Collective.
    pub(super) fn refined(
        &self,
        solution: &LinearSolution,
        reduction: f64,
    ) -> Result<RefinementStep> {
        let next = self.corrected(solution, reduction)?;
        let better = distance(&next.solution.kkt) < 0.5 * distance(&solution.kkt);
        Ok(RefinementStep {
            better: better.then_some(next.solution),
            correction: next.converged.then_some(next.size),
        })
    }

    /// The solution with a correction whose residual is reduced by the factor `reduction`. Collective.
    pub(super) fn corrected(&self, solution: &LinearSolution, reduction: f64) -> Result<Corrected> {
        let (problem, dual) = (&self.problem, &*self.dual());
        let lambda = dual.multipliers()?;
        lambda.array_mut()?.copy_from_slice(&solution.lambda);
        let (forces, jumps) = remainder(problem, dual, &solution.u, &lambda)?;
        let forces: Vec<&[f64]> = forces.iter().map(Vec::as_slice).collect();
        let loads = Loads::of(dual, &forces, Some(jumps));
        let mut at = Iterate::new(dual, loads)?;
        at.begin(dual)?;
        let first = at.evaluate_projected(dual)?;
        let control = IterationControl::to(reduction * first, at.residual.size);
        let run = iterate(self, &at.residual.r, &at.lambda, &control, None)?;
        at.place(dual)?;
        let du = displacements(dual, &at.loads, &mut at.residual)?;
        let size = self.energy_norm(&du);
        let mut u = solution.u.clone();
        for (u, du) in u.iter_mut().flatten().zip(du.iter().flatten()) {
            *u += du;
        }
        lambda.axpy(1.0, &at.lambda)?;
        let next = LinearSolution {
            u,
            iterations: solution.iterations + run.iterations,
            ..solution.clone()
        };
        Ok(Corrected {
            solution: self.measured(next, &lambda)?,
            size,
            converged: run.status.converged(),
        })
    }

    /// The solution with other multipliers of nearly the same forces: its certificate is measured again, its status and
    /// the estimate of its error stay. Collective.
    pub(crate) fn with_multipliers(
        &self,
        solution: LinearSolution,
        other: Vec<f64>,
    ) -> Result<LinearSolution> {
        let lambda = self.dual().multipliers()?;
        lambda.array_mut()?.copy_from_slice(&other);
        let error = solution.kkt.error;
        let mut measured = self.measured(solution, &lambda)?;
        measured.kkt.error = error;
        Ok(measured)
    }

    /// A solution with the multipliers `lambda` and the certificate of its displacements with them. Collective.
    fn measured(&self, solution: LinearSolution, lambda: &PetscVec) -> Result<LinearSolution> {
        let (u, known) = (&solution.u, self.length.get());
        let certificate = Certificate::new(&self.problem, &self.dual(), u, lambda, known)?;
        Ok(LinearSolution {
            lambda: lambda.to_vec()?,
            gaps: certificate.gaps,
            kkt: certificate.kkt,
            energy: certificate.energy,
            left: certificate.left,
            ..solution
        })
    }

    /// ‖u‖_K. Collective.
    pub(super) fn energy_norm(&self, u: &[Vec<f64>]) -> f64 {
        let dual = self.dual();
        let local = &self.problem.local;
        let energies = dual.stiffness.team.map(local.len(), |j| {
            let mut force = vec![0.0; u[j].len()];
            local[j].k.mul(&u[j], &mut force);
            force.iter().zip(&u[j]).map(|(f, u)| f * u).sum::<f64>()
        });
        total(dual.comm(), energies.iter().sum()).max(0.0).sqrt()
    }
}

/// A solution with a correction.
pub(super) struct Corrected {
    /// The corrected solution, whether it is better or not.
    pub solution: LinearSolution,
    /// ‖du‖_K.
    pub size: f64,
    /// Whether the correction problem was solved.
    pub converged: bool,
}

/// The result of one step.
pub(super) struct RefinementStep {
    /// The corrected solution, if the step has helped.
    pub better: Option<LinearSolution>,
    /// ‖du‖_K, if the correction problem was solved.
    pub correction: Option<f64>,
}

/// Whether a certificate of `left` has reached this tolerance. Residuals of the iteration do not fall below
/// [`ROUNDING`]; with a smaller tolerance the certificate alone decides.
fn is_reached(rtol: f64, left: f64) -> bool {
    if rtol < ROUNDING {
        left <= rtol
    } else {
        left <= WORTH * rtol
    }
}

/// The measure that refinement reduces.
fn distance(kkt: &Kkt) -> f64 {
    kkt.stationarity.max(kkt.feasibility)
}

/// r of every local subdomain, and the remaining jumps c − B u + C λ of the rows. Collective.
pub(super) fn remainder(
    problem: &Problem,
    dual: &Dual,
    u: &[Vec<f64>],
    lambda: &PetscVec,
) -> Result<(Vec<Vec<f64>>, Vec<f64>)> {
    let stiffness = &dual.stiffness;
    let mut ghost = vec![0.0; stiffness.jump.ghosts.len()];
    stiffness.dual_halo.fetch(lambda, &mut ghost)?;
    let mut work = stiffness.work();
    let mut forces = Vec::new();
    for (j, (sub, w)) in problem.local.iter().zip(&mut work).enumerate() {
        let interface = &stiffness.locals[j].gamma().interface;
        let columns = stiffness.jump.columns.of(j);
        columns.b_transpose_all(&ghost, &mut w.v);
        let mut f = sub.f.clone();
        for (&i, v) in interface.iter().zip(&w.v) {
            f[i as usize] -= v;
        }
        forces.push(less_product(sub, &u[j], f));
        for (y, &i) in w.y.iter_mut().zip(interface) {
            *y = u[j][i as usize];
        }
    }
    let rows = dual.multipliers()?;
    stiffness.jump_of(&work, &rows)?;
    stiffness.add_compliance(-1.0, lambda, &rows)?;
    let jumps = rows.array()?;
    let jumps = stiffness.jump.held.iter().zip(&*jumps).map(|(c, b)| c - b);
    let jumps = jumps.collect();
    Ok((forces, jumps))
}

/// f − K u, with products and sums in twice the working precision.
fn less_product(sub: &Subdomain, u: &[f64], mut f: Vec<f64>) -> Vec<f64> {
    let k = &sub.k;
    let mut force = vec![0.0; k.n()];
    k.mul(u, &mut force);
    let energy = u.iter().zip(&force).map(|(u, f)| u * f).sum();
    let columns = sub.near_kernel.as_deref();
    let without = strained(k, columns, &k.diagonal(), u, energy);
    let u = without.as_deref().unwrap_or(u);
    for (i, f) in f.iter_mut().enumerate() {
        let (col, val) = k.row(i);
        let (mut sum, mut rest) = (*f, 0.0);
        for (&j, &v) in col.iter().zip(val) {
            let x = -u[j as usize];
            let product = v * x;
            let next = sum + product;
            let part = next - sum;
            rest += (sum - (next - part)) + (product - part) + v.mul_add(x, -product);
            sum = next;
        }
        *f = sum + rest;
    }
    f
}
