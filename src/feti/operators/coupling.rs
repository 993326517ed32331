//! B_D and B_Dᵀ on multipliers that their owners have: ghosts of rows, and of dofs in coupled blocks.

use std::cell::RefCell;

use super::stiffness::Stiffness;
use crate::feti::jump::blocks::BlockForm;
use crate::feti::jump::columns::ScaledGhosts;
use crate::feti::jump::coupled::Coupled;
use crate::feti::jump::operator::Jump;
use crate::Result;
use parallel::halo::Halo;
use petsc::{Session, Vec as PetscVec};

/// The dofs of coupled blocks on their way between the owners of the blocks and the subdomains.
pub struct Coupling {
    halo: Halo,
    dofs: PetscVec,
    ghosts: RefCell<Vec<f64>>,
}

impl Coupling {
    /// `None` where no block is coupled. Collective.
    pub(super) fn new(session: &Session, jump: &Jump) -> Result<Option<Coupling>> {
        let slots = &jump.slots;
        if !slots.anywhere {
            return Ok(None);
        }
        let dofs = PetscVec::mpi(session, slots.n_owned)?;
        Ok(Some(Coupling {
            halo: Halo::new(session, &dofs, &slots.ghosts)?,
            dofs,
            ghosts: RefCell::new(vec![0.0; slots.ghosts.len()]),
        }))
    }

    /// Calls `each` with every coupled block of this rank, its dofs and its rows in `rows`.
    fn each(
        &self,
        jump: &Jump,
        rows: &mut [f64],
        each: impl Fn(&Coupled, &mut [f64], &mut [f64]),
    ) -> Result<()> {
        let mut dofs = self.dofs.array_mut()?;
        for block in &jump.blocks {
            if let BlockForm::Coupled(coupled) = &block.form {
                let (dofs, rows) = (
                    &mut dofs[block.slots.clone()],
                    &mut rows[block.rows.clone()],
                );
                each(coupled, dofs, rows);
            }
        }
        Ok(())
    }
}

impl Stiffness {
    /// Room for the ghosts of B_D.
    pub fn scaled_ghosts(&self) -> ScaledGhosts {
        ScaledGhosts {
            rows: vec![0.0; self.jump.ghosts.len()],
            dofs: vec![0.0; self.jump.slots.ghosts.len()],
        }
    }

    /// Fetches what B_Dᵀ λ needs. Collective.
    pub fn fetch_scaled(&self, lambda: &PetscVec, ghosts: &mut ScaledGhosts) -> Result<()> {
        self.dual_halo.fetch(lambda, &mut ghosts.rows)?;
        let Some(coupling) = &self.coupling else {
            return Ok(());
        };
        let mut rows = lambda.to_vec()?;
        coupling.each(&self.jump, &mut rows, |coupled, dofs, rows| {
            coupled.lift(rows, dofs)
        })?;
        coupling.halo.fetch(&coupling.dofs, &mut ghosts.dofs)
    }

    /// out ← B_D y, with the sums over subdomains in `ghosts`. Collective.
    pub fn sum_scaled(&self, ghosts: &ScaledGhosts, out: &PetscVec) -> Result<()> {
        self.dual_halo.sum(&ghosts.rows, out)?;
        let Some(coupling) = &self.coupling else {
            return Ok(());
        };
        coupling.halo.sum(&ghosts.dofs, &coupling.dofs)?;
        let rows = &mut out.array_mut()?;
        coupling.each(&self.jump, rows, |coupled, dofs, rows| {
            coupled.collect(dofs, rows)
        })
    }

    /// Adds the rows of coupled blocks to `q`: diag(B_D X B_Dᵀ) with diag(G)⁻¹ in place of G⁻¹, where `entry` is that
    /// of the diagonal matrix X at a position of a local subdomain's Γ. Collective.
    pub fn add_diagonal(&self, entry: impl Fn(usize, usize) -> f64, q: &mut [f64]) -> Result<()> {
        let Some(coupling) = &self.coupling else {
            return Ok(());
        };
        let mut ghosts = coupling.ghosts.borrow_mut();
        ghosts.fill(0.0);
        for (j, columns) in self.jump.columns.iter().enumerate() {
            for &(slot, at) in columns.coupled {
                ghosts[slot as usize] += entry(j, at as usize);
            }
        }
        coupling.halo.sum(&ghosts, &coupling.dofs)?;
        coupling.each(&self.jump, q, |coupled, dofs, rows| {
            coupled.diagonal(dofs, rows)
        })
    }
}
