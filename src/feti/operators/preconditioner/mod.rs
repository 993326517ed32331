//! M⁻¹: what is asked of a preconditioner of the dual problem. Each kind has a file in this folder and a line in
//! [`table`].
//!
//! ```text
//!     none        I
//!     lumped      M_L⁻¹ = Z B_D K_ΓΓ B_Dᵀ Z
//!     dirichlet   M_D⁻¹ = Z B_D S̃ B_Dᵀ Z                      [Lee, section 3.1]
//!     corrected   M_C⁻¹ = Z B_D (S̃ − S̃ Z_c (Z_cᵀ S̃ Z_c)⁺ Z_cᵀ S̃) B_Dᵀ Z
//! ```

pub mod coarse_corrected;
pub mod dirichlet;
mod identity;
mod lumped;
mod scaled_jumps;
pub mod table;

use super::stiffness::Stiffness;
use crate::feti::interface::sharing::DofSharing;
use crate::feti::lifting::correction::Lifting;
use crate::feti::settings::{MethodSettings, PcType};
use crate::substructures::Problem;
use crate::Result;
use petsc::Vec as PetscVec;

/// A kind of preconditioner: what is known of it before a problem is set up.
#[derive(Debug)]
pub struct PreconditionerKind {
    /// How a user asks for it.
    pub pc_type: PcType,
    /// Its symbol in docs/theory.md, section 4.
    pub symbol: &'static str,
    /// Whether it reads entries of S or multiplies with S many times before the iteration begins. S is then made as a
    /// dense matrix wherever memory allows it.
    pub needs_s: bool,
    /// A lower bound of λ_min(P M⁻¹ Pᵀ F) with rigid rows (docs/theory.md, section 4); `None` where none is proved.
    pub floor: Option<f64>,
    /// Sets it up. Collective.
    pub set_up: fn(&PreconditionerInput<'_>) -> Result<Box<dyn DualPreconditioner>>,
}

/// The parts of the set-up from which a preconditioner is made.
pub struct PreconditionerInput<'a> {
    /// The matrices of the subdomains.
    pub problem: &'a Problem,
    /// Which subdomains share a dof.
    pub sharing: &'a DofSharing,
    /// S̃⁺, B and B_D.
    pub stiffness: &'a Stiffness,
    /// The settings of the method.
    pub settings: &'a MethodSettings,
}

/// M⁻¹, symmetric and positive on the range of B. Vectors have one entry for each row of B that this rank owns.
pub trait DualPreconditioner {
    /// Its kind.
    fn kind(&self) -> &'static PreconditionerKind;

    /// out ← M⁻¹ λ. Collective.
    ///
    /// # Errors
    /// PETSc's own.
    fn apply(&self, stiffness: &Stiffness, lambda: &PetscVec, out: &PetscVec) -> Result<()>;

    /// outs ← M⁻¹ λs, as many columns each. Collective.
    ///
    /// # Errors
    /// PETSc's own.
    fn apply_many(
        &self,
        stiffness: &Stiffness,
        lambdas: &[PetscVec],
        outs: &[PetscVec],
    ) -> Result<()> {
        self.apply_each(stiffness, lambdas, outs)
    }

    /// outs ← M⁻¹ λs, one after the other. Collective.
    ///
    /// # Errors
    /// PETSc's own.
    fn apply_each(
        &self,
        stiffness: &Stiffness,
        lambdas: &[PetscVec],
        outs: &[PetscVec],
    ) -> Result<()> {
        let mut pairs = lambdas.iter().zip(outs);
        pairs.try_for_each(|(lambda, out)| self.apply(stiffness, lambda, out))
    }

    /// A name for `-fetifeti_ksp_view`, with what its set-up has found.
    fn describe(&self) -> String {
        self.kind().pc_type.name().into()
    }

    /// Whether M⁻¹ = I, so that it is no weight for the projector.
    fn is_identity(&self) -> bool {
        false
    }

    /// Z_c, if it takes coarse functions away.
    fn lifting(&self) -> Option<&Lifting> {
        None
    }

    /// Number of local subdomains with S in single precision.
    fn in_single(&self) -> usize {
        0
    }
}
