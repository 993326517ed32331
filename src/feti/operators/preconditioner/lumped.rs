//! The lumped preconditioner M_L⁻¹ = Z B_D K_ΓΓ B_Dᵀ Z: no interior solve.

use super::scaled_jumps::ScaledJumps;
use super::{DualPreconditioner, PreconditionerInput, PreconditionerKind};
use crate::feti::operators::stiffness::Stiffness;
use crate::feti::settings::PcType;
use crate::Result;
use base::linalg::csr::Csr;
use petsc::Vec as PetscVec;

/// M_L.
pub static LUMPED: PreconditionerKind = PreconditionerKind {
    pc_type: PcType::Lumped,
    symbol: "M_L",
    needs_s: false,
    floor: None,
    set_up: |input| Ok(Box::new(Lumped::new(input))),
};

struct Lumped {
    jumps: ScaledJumps,
    /// K_ΓΓ of each local subdomain in the order of Γ, n_Γ × n_Γ.
    k_gamma: Vec<Csr>,
}

impl Lumped {
    fn new(input: &PreconditionerInput<'_>) -> Lumped {
        let subdomains = input.problem.local.iter().zip(&input.stiffness.locals);
        let block = subdomains.map(|(sub, local)| {
            let gamma = &local.gamma().interface;
            sub.k.block(gamma, gamma)
        });
        Lumped {
            jumps: ScaledJumps::new(input.stiffness),
            k_gamma: block.collect(),
        }
    }
}

impl DualPreconditioner for Lumped {
    fn kind(&self) -> &'static PreconditionerKind {
        &LUMPED
    }

    fn apply(&self, stiffness: &Stiffness, lambda: &PetscVec, out: &PetscVec) -> Result<()> {
        let k_gamma = &self.k_gamma;
        self.jumps.apply(stiffness, lambda, out, |work| {
            stiffness.team.for_each(work, |j, w| {
                w.y.fill(0.0);
                k_gamma[j].add_mul(1.0, &w.v, &mut w.y); /*      y ← K_ΓΓ v         */
            });
            Ok(())
        })
    }
}
