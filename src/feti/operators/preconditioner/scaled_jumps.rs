//! Z B_D A B_Dᵀ Z for an operator A on the interfaces of subdomains: the frame of all preconditioners but the identity.

use std::cell::RefCell;

use crate::feti::jump::columns::ScaledGhosts;
use crate::feti::operators::stiffness::Stiffness;
use crate::feti::operators::work::{InterfaceBuffers, InterfaceColumns};
use crate::feti::subdomain::scaled::ScaledSubdomain;
use crate::Result;
use base::linalg::dense::Dense;
use petsc::Vec as PetscVec;

/// B_D and B_Dᵀ with the vectors between them.
pub struct ScaledJumps {
    buffers: RefCell<(Vec<InterfaceBuffers>, ScaledGhosts)>,
}

impl ScaledJumps {
    /// With buffers for the local subdomains.
    pub fn new(stiffness: &Stiffness) -> ScaledJumps {
        ScaledJumps {
            buffers: RefCell::new((stiffness.work(), stiffness.scaled_ghosts())),
        }
    }

    /// out ← B_D A B_Dᵀ λ. `multiply` computes work.y ← A work.v. Collective.
    pub fn apply(
        &self,
        stiffness: &Stiffness,
        lambda: &PetscVec,
        out: &PetscVec,
        multiply: impl FnOnce(&mut [InterfaceBuffers]) -> Result<()>,
    ) -> Result<()> {
        let (work, ghost) = &mut *self.buffers.borrow_mut();
        let columns = &stiffness.jump.columns;
        stiffness.fetch_scaled(lambda, ghost)?;
        let received = &*ghost;
        stiffness.team.for_each(work, |j, w| {
            columns.of(j).bd_transpose(received, &mut w.v); /*   v ← B_Dᵀ λ         */
        });
        multiply(work)?; /*                                      y ← A v            */
        ghost.clear();
        for (w, columns) in work.iter().zip(columns.iter()) {
            columns.add_bd(&w.y, ghost); /*                      out ← B_D y        */
        }
        stiffness.sum_scaled(ghost, out)
    }

    /// outs ← B_D A B_Dᵀ λs. `multiply` computes blocks.y ← A blocks.v. Collective.
    pub fn apply_many(
        &self,
        stiffness: &Stiffness,
        lambdas: &[PetscVec],
        outs: &[PetscVec],
        multiply: impl FnOnce(&mut [InterfaceColumns]) -> Result<()>,
    ) -> Result<()> {
        let (_, ghost) = &mut *self.buffers.borrow_mut();
        let columns = &stiffness.jump.columns;
        let room = |local: &ScaledSubdomain| InterfaceColumns {
            v: Dense::zeros(local.gamma().n_gamma(), lambdas.len()),
            y: Dense::zeros(local.gamma().n_gamma(), lambdas.len()),
        };
        let mut blocks: Vec<InterfaceColumns> = stiffness.locals.iter().map(room).collect();
        for (c, lambda) in lambdas.iter().enumerate() {
            stiffness.fetch_scaled(lambda, ghost)?;
            let received = &*ghost;
            stiffness.team.for_each(&mut blocks, |j, b| {
                columns.of(j).bd_transpose(received, b.v.col_mut(c)); /* v ← B_Dᵀ λ */
            });
        }
        multiply(&mut blocks)?; /*                               y ← A v            */
        for (c, out) in outs.iter().enumerate() {
            ghost.clear();
            let all = blocks.iter().zip(columns.iter());
            for (b, columns) in all.filter(|(b, _)| !b.y.is_zero(c)) {
                columns.add_bd(b.y.col(c), ghost); /*            out ← B_D y        */
            }
            stiffness.sum_scaled(ghost, out)?;
        }
        Ok(())
    }
}
