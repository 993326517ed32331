//! The coarse-corrected Dirichlet preconditioner
//! M_C⁻¹ = Z B_D (S̃ − S̃ Z_c (Z_cᵀ S̃ Z_c)⁺ Z_cᵀ S̃) B_Dᵀ Z (docs/theory.md, section 4).

use super::dirichlet::Dirichlet;
use super::{DualPreconditioner, PreconditionerInput, PreconditionerKind};
use crate::feti::lifting::correction::Lifting;
use crate::feti::operators::stiffness::Stiffness;
use crate::feti::operators::work::InterfaceColumns;
use crate::feti::settings::PcType;
use crate::Result;
use parallel::clock::{self, Phase};
use petsc::Vec as PetscVec;

/// M_C.
pub static COARSE_CORRECTED: PreconditionerKind = PreconditionerKind {
    pc_type: PcType::CoarseCorrected,
    symbol: "M_C",
    // Y = S Z_c, or A = Z_cᵀ S Z_c.
    needs_s: true,
    floor: Some(1.0),
    set_up: |input| Ok(Box::new(CoarseCorrected::new(input)?)),
};

struct CoarseCorrected {
    dirichlet: Dirichlet,
    /// Z_c; `None` if no body has a coarse function.
    lifting: Option<Lifting>,
}

impl CoarseCorrected {
    fn new(input: &PreconditionerInput<'_>) -> Result<CoarseCorrected> {
        let functions = input.settings.coarse_functions();
        let lifting = clock::timed(Phase::LiftingSetup, || {
            Lifting::new(input.problem, input.sharing, input.stiffness, functions)
        })?;
        Ok(CoarseCorrected {
            dirichlet: Dirichlet::new(input),
            lifting,
        })
    }
}

impl DualPreconditioner for CoarseCorrected {
    fn kind(&self) -> &'static PreconditionerKind {
        &COARSE_CORRECTED
    }

    fn apply(&self, stiffness: &Stiffness, lambda: &PetscVec, out: &PetscVec) -> Result<()> {
        let dirichlet = &self.dirichlet;
        let Some(lifting) = &self.lifting else {
            return dirichlet.apply(stiffness, lambda, out);
        };
        dirichlet.jumps.apply(stiffness, lambda, out, |work| {
            // Yᵀ v is sent while S v is computed.
            lifting.begin(stiffness, work)?;
            dirichlet.multiply(stiffness, work);
            lifting.finish(stiffness, work, |work| dirichlet.multiply(stiffness, work))
        })
    }

    fn apply_many(
        &self,
        stiffness: &Stiffness,
        lambdas: &[PetscVec],
        outs: &[PetscVec],
    ) -> Result<()> {
        let dirichlet = &self.dirichlet;
        let Some(lifting) = &self.lifting else {
            return dirichlet.apply_many(stiffness, lambdas, outs);
        };
        if !dirichlet.takes_columns(lambdas) {
            return self.apply_each(stiffness, lambdas, outs);
        }
        let multiply =
            |blocks: &mut [InterfaceColumns]| dirichlet.multiply_columns(stiffness, blocks);
        let jumps = &dirichlet.jumps;
        jumps.apply_many(stiffness, lambdas, outs, |blocks| {
            multiply(blocks);
            lifting.finish_many(stiffness, blocks, multiply)
        })
    }

    fn describe(&self) -> String {
        let name = COARSE_CORRECTED.pc_type.name();
        match self.lifting.as_ref().map(|l| l.rank_and_order) {
            Some((rank, order)) => {
                format!("{name}, {rank} independent of {order} coarse functions on this rank")
            }
            None => name.into(),
        }
    }

    fn lifting(&self) -> Option<&Lifting> {
        self.lifting.as_ref()
    }

    fn in_single(&self) -> usize {
        self.dirichlet.in_single()
    }
}
