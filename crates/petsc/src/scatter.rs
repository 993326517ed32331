//! Moving chosen entries between a distributed and a local vector.

use super::handle::Handle;
use super::{Comm, Is, Vec};
use base::Result;
use petsc_sys as sys;
use petsc_sys::PetscInt;

/// A plan that copies entries of one vector to another, and adds them back.
pub type Scatter = Handle<sys::_p_PetscSF>;

impl Scatter {
    /// Entry k of `to` (a vector of this rank alone) is entry `from_indices[k]` (global numbering) of `from`.
    ///
    /// Collective over the ranks of `from`; `to` has at least as many entries as there are indices.
    pub fn new(from: &Vec, from_indices: &[PetscInt], to: &Vec) -> Result<Scatter> {
        let session = from.session();
        let source = Is::general(session, Comm::Own, from_indices)?;
        let first: std::vec::Vec<PetscInt> = (0..from_indices.len() as PetscInt).collect();
        let target = Is::general(session, Comm::Own, &first)?;
        Scatter::made(session, |raw| {
            petsc!(VecScatterCreate(
                from.raw(),
                source.raw(),
                to.raw(),
                target.raw(),
                raw
            ))
        })
    }

    /// to ← entries of from.
    pub fn forward(&self, from: &Vec, to: &Vec) -> Result<()> {
        let (x, y) = (from.read()?, to.write()?);
        let (scatter, insert) = (self.raw(), sys::INSERT_VALUES);
        petsc!(VecScatterBegin(scatter, x, y, insert, sys::SCATTER_FORWARD))?;
        petsc!(VecScatterEnd(scatter, x, y, insert, sys::SCATTER_FORWARD))
    }

    /// global ← global + entries of local, on every rank: starts the messages. (`local` is the `to` of
    /// [`Scatter::new`].)
    pub fn reverse_add_begin(&self, local: &Vec, global: &Vec) -> Result<()> {
        let (x, y) = (local.read()?, global.write()?);
        let (scatter, add) = (self.raw(), sys::ADD_VALUES);
        petsc!(VecScatterBegin(scatter, x, y, add, sys::SCATTER_REVERSE))
    }

    /// Completes [`Scatter::reverse_add_begin`].
    pub fn reverse_add_end(&self, local: &Vec, global: &Vec) -> Result<()> {
        let (x, y) = (local.read()?, global.write()?);
        let (scatter, add) = (self.raw(), sys::ADD_VALUES);
        petsc!(VecScatterEnd(scatter, x, y, add, sys::SCATTER_REVERSE))
    }

    /// global ← global + entries of local.
    pub fn reverse_add(&self, local: &Vec, global: &Vec) -> Result<()> {
        self.reverse_add_begin(local, global)?;
        self.reverse_add_end(local, global)
    }
}
