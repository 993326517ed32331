//! The tolerance on the residual.

use super::refinement::TIGHT;
use super::residual::ROUNDING;
use crate::feti::method::LinearMethod;
use crate::Result;
use petsc::Ksp;

/// The norm of the residual, over `rows` rows, at which the iteration ends. It is relative to the smaller of two
/// numbers: `reference`, the norm of Pᵀ r at λ₀, and the norm of displacements of size `length` (0 while they are not
/// known). Where stiff and soft bodies meet, λ₀ may stand for displacements far larger than those of the solution.
/// Jumps must be small relative to the displacements of the solution.
pub fn target(ksp: &Ksp, reference: f64, length: f64, rows: usize) -> Result<f64> {
    let (rtol, atol, _, _) = ksp.tolerances()?;
    Ok(absolute(rtol, atol, reference, length, rows))
}

fn absolute(rtol: f64, atol: f64, reference: f64, length: f64, rows: usize) -> f64 {
    let least = match length {
        length if length > 0.0 => reference.min(length * (rows as f64).sqrt()),
        _ => reference,
    };
    (rtol * least).max(atol)
}

/// Whether a run to `tolerance` was a run to the end, now that the tolerance of the end is `target`.
pub fn to_the_end(tolerance: f64, target: f64) -> bool {
    tolerance <= 1.01 * target
}

/// The tolerance of the iterations of one solve. Digits beyond [`TIGHT`] are left to refinement.
pub struct Target {
    rtol: f64,
    atol: f64,
    /// ‖Pᵀ r‖ at λ₀.
    reference: f64,
    rows: usize,
}

impl Target {
    /// A tolerance relative to `reference`, with the tolerances of the KSP.
    pub fn new(method: &LinearMethod, reference: f64) -> Result<Target> {
        let (rtol, atol, _, _) = method.ksp.tolerances()?;
        Ok(Target {
            rtol: rtol.max(TIGHT),
            atol,
            reference,
            rows: method.dual().stiffness.jump.n_global,
        })
    }

    /// The tolerance while displacements are not known.
    pub fn at_first(&self) -> f64 {
        absolute(self.rtol, self.atol, self.reference, 0.0, self.rows)
    }

    /// The tolerance for displacements with largest entry `length`. `size` is the norm of the terms that they were
    /// formed from; rounding is relative to it.
    pub fn of_displacements(&self, length: f64, size: f64) -> f64 {
        let target = absolute(self.rtol, self.atol, self.reference, length, self.rows);
        target.max(ROUNDING * size)
    }
}
