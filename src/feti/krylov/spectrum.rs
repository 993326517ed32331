//! Exact extreme eigenvalues of the preconditioned operator on V ∩ range B.

use crate::feti::operators::dual;
use crate::feti::operators::dual::{Dual, Shared};
use crate::petsc::{extreme_eigenvalues, Session};
use crate::Result;

/// The ends of a spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spectrum {
    /// Smallest eigenvalue that is not a kernel direction's.
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

/// Residual tolerance of the eigensolver, relative to the eigenvalue. An eigenvalue of a self-adjoint operator lies within the
/// residual, so κ is good to 1e-6; in fact the error is about the residual's square. Asking for much less would
/// mean to tell apart the members of the cluster at 1, which no one wants to know.
const TOLERANCE: f64 = 4e-7;

/// The extreme eigenvalues of P M⁻¹ Pᵀ F by SLEPc; `None` without multipliers. Collective.
///
/// C A with A = Pᵀ F P and C = P M⁻¹ Pᵀ is self-adjoint in the inner product of A. Redundant multipliers and the range of G
/// are in the kernel of A; the projection E = Π P takes them out, so that they are never reported.
pub fn exact(session: &Session, dual: &Shared, prefix: &str) -> Result<Option<Spectrum>> {
    if dual.borrow().stiffness.jump.n_global == 0 {
        return Ok(None);
    }
    let a = if dual.borrow().deflation().is_some() {
        dual::deflated_operator(session, dual)?
    } else {
        dual::operator(session, dual)?
    };
    let c = dual::preconditioner_matrix(session, dual)?;
    let e = dual::range_matrix(session, dual)?;
    let start = start_vector(&dual.borrow())?;
    let (lambda_min, lambda_max) =
        extreme_eigenvalues(session, &a, &c, Some(&e), &start, TOLERANCE, prefix)?;
    Ok(Some(Spectrum {
        lambda_min,
        lambda_max,
    }))
}

/// A vector rich in all eigenvectors, without random state.
fn start_vector(dual: &Dual) -> Result<crate::petsc::Vec> {
    let start = dual.multipliers()?;
    let jump = &dual.stiffness.jump;
    for (i, v) in start.array_mut()?.iter_mut().enumerate() {
        // Multiples of the golden ratio modulo one never repeat.
        let t = (jump.first + i + 1) as f64 * 0.618_033_988_749_894_9;
        *v = 2.0 * t.fract() - 1.0;
    }
    Ok(start)
}
