//! No preconditioner: M⁻¹ = I.

use super::{DualPreconditioner, PreconditionerKind};
use crate::feti::operators::stiffness::Stiffness;
use crate::feti::settings::PcType;
use crate::Result;
use petsc::Vec as PetscVec;

/// M⁻¹ = I.
pub static IDENTITY: PreconditionerKind = PreconditionerKind {
    pc_type: PcType::None,
    symbol: "I",
    needs_s: false,
    floor: None,
    set_up: |_| Ok(Box::new(Identity)),
};

struct Identity;

impl DualPreconditioner for Identity {
    fn kind(&self) -> &'static PreconditionerKind {
        &IDENTITY
    }

    fn apply(&self, _: &Stiffness, lambda: &PetscVec, out: &PetscVec) -> Result<()> {
        out.copy_from(lambda)
    }

    fn is_identity(&self) -> bool {
        true
    }
}
