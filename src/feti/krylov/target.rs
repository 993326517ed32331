//! The residual to end with.

use super::refinement::TIGHT;
use super::residual::ROUNDING;
use crate::feti::method::LinearMethod;
use crate::petsc::Ksp;
use crate::Result;

/// The norm of the residual on `rows` rows to end with: relative to `reference`, that of Pᵀ r at λ₀, or to displacements as
/// large as `length`, 0 as long as they are not known, if that is less. Where stiff and soft bodies meet, λ₀ may stand for
/// displacements far larger than those of the solution; jumps are to be small beside these.
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

/// Whether a run down to `tolerance` was one to the end, where that turns out to be `target`.
pub fn to_the_end(tolerance: f64, target: f64) -> bool {
    tolerance <= 1.01 * target
}

/// The same for the iterations of one solve: digits beyond [`TIGHT`] are for refinement.
pub struct Target {
    rtol: f64,
    atol: f64,
    /// How many times larger than asked for.
    ease: f64,
    /// ‖Pᵀ r‖ at λ₀.
    reference: f64,
    rows: usize,
}

impl Target {
    /// Relative to `reference`, with the tolerances of the KSP.
    pub fn new(method: &LinearMethod, reference: f64) -> Result<Target> {
        let (rtol, atol, _, _) = method.ksp().tolerances()?;
        Ok(Target {
            rtol,
            atol,
            ease: match rtol {
                rtol if rtol > 0.0 => (TIGHT / rtol).max(1.0),
                _ => 1.0,
            },
            reference,
            rows: method.dual().stiffness.jump.n_global,
        })
    }

    /// As long as displacements are not known.
    pub fn at_first(&self) -> f64 {
        self.ease * absolute(self.rtol, self.atol, self.reference, 0.0, self.rows)
    }

    /// For displacements with largest entry `length`; `size` is what they were formed from, and what rounding is relative to.
    pub fn of_displacements(&self, length: f64, size: f64) -> f64 {
        let target = absolute(self.rtol, self.atol, self.reference, length, self.rows);
        (self.ease * target).max(ROUNDING * size)
    }
}
