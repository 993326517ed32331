//! Exact extreme eigenvalues of the preconditioned operator on V ∩ range B.

use std::rc::Rc;

use super::shells;
use super::system::DualSystem;
use crate::feti::operators::dual::Dual;
use crate::feti::spectrum::Spectrum;
use crate::Result;
use parallel::exchange::any;
use petsc::extreme_eigenvalues;

/// Residual tolerance of the eigensolver, relative to the eigenvalue. An eigenvalue of a self-adjoint operator lies
/// within the residual, so κ is good to 1e-6; in fact the error is about the residual's square. A much smaller
/// tolerance would require to separate the members of the cluster at 1, which is of no use. Where λ_min ≥ 1 by theory,
/// a Rayleigh quotient of 1 plus this tolerance is as good.
const TOLERANCE: f64 = 4e-7;

/// The extreme eigenvalues of P M⁻¹ Pᵀ F by SLEPc; `None` without multipliers, or where no row holds. Collective.
///
/// C A with A = Pᵀ F P and C = P M⁻¹ Pᵀ is self-adjoint in the inner product of A. Redundant multipliers and the range
/// of G are in the kernel of A; the projection E = Π P takes them out, so that they are never reported.
pub fn exact(system: &Rc<DualSystem>, prefix: &str) -> Result<Option<Spectrum>> {
    let holds = system.dual().stiffness.jump.active.contains(&true);
    if !any(system.session.comm(), holds) {
        return Ok(None);
    }
    let a = if system.deflation().is_some() {
        shells::deflated_operator(system)?
    } else {
        shells::operator(system)?
    };
    let c = shells::preconditioner(system)?;
    let e = shells::range(system)?;
    let start = start_vector(&system.dual())?;
    let floor = {
        let dual = system.dual();
        let floor = dual.preconditioner.kind().floor;
        floor.filter(|_| !dual.stiffness.has_springs())
    };
    let accuracy = (TOLERANCE, floor);
    let session = &system.session;
    let [least, largest] =
        extreme_eigenvalues(session, &a, &c, Some(&e), &start, accuracy, prefix)?;
    let settled = [least.settled, largest.settled].into_iter().flatten();
    Ok(Some(Spectrum {
        lambda_min: least.value,
        lambda_max: largest.value,
        settled: settled.reduce(f64::max),
    }))
}

/// A vector rich in all eigenvectors, without random state.
fn start_vector(dual: &Dual) -> Result<petsc::Vec> {
    let start = dual.multipliers()?;
    let jump = &dual.stiffness.jump;
    for (i, v) in start.array_mut()?.iter_mut().enumerate() {
        // Multiples of the golden ratio modulo one never repeat.
        let t = (jump.first + i + 1) as f64 * 0.618_033_988_749_894_9;
        *v = 2.0 * t.fract() - 1.0;
    }
    Ok(start)
}
