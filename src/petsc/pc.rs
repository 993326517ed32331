//! Preconditioners.

use super::error::{c_string, rust_string};
use super::handle::Handle;
use super::{Is, Vec};
use crate::Result;
use petsc_sys as sys;

/// A preconditioner, usually of a [`Ksp`](super::Ksp). [`Pc::set_shell`] makes one from Rust code.
#[derive(Clone)]
pub struct Pc(pub(super) Handle<sys::_p_PC>);

impl Pc {
    /// Sets the type by PETSc's name (`"none"`, `"cholesky"`, `"gamg"`, `"bddc"`, …).
    pub fn set_type(&self, name: &str) -> Result<()> {
        petsc!(PCSetType(self.0.raw(), c_string(name).as_ptr()))
    }

    /// The type's name; empty if none is set.
    pub fn type_name(&self) -> Result<String> {
        let mut name = std::ptr::null();
        petsc!(PCGetType(self.0.raw(), &mut name))?;
        Ok(rust_string(name))
    }

    /// The package of a factorisation (`"mumps"`, `"cholmod"`, …).
    pub fn set_solver_type(&self, package: &str) -> Result<()> {
        petsc!(PCFactorSetMatSolverType(
            self.0.raw(),
            c_string(package).as_ptr()
        ))
    }

    /// The prefix of this preconditioner's options, without a dash.
    pub fn set_options_prefix(&self, prefix: &str) -> Result<()> {
        petsc!(PCSetOptionsPrefix(self.0.raw(), c_string(prefix).as_ptr()))
    }

    /// Reads the options of this preconditioner.
    pub fn set_from_options(&self) -> Result<()> {
        petsc!(PCSetFromOptions(self.0.raw()))
    }

    /// Sets up the preconditioner. Collective.
    pub fn setup(&self) -> Result<()> {
        petsc!(PCSetUp(self.0.raw()))
    }

    /// y ← M⁻¹ x. Collective.
    pub fn apply(&self, x: &Vec, y: &Vec) -> Result<()> {
        let (x, y) = (x.read()?, y.write()?);
        petsc!(PCApply(self.0.raw(), x, y))
    }

    /// PCBDDC: local dofs of this rank's subdomain with essential conditions. Collective.
    pub fn bddc_set_dirichlet_local(&self, dofs: &Is) -> Result<()> {
        petsc!(PCBDDCSetDirichletBoundariesLocal(
            self.0.raw(),
            dofs.0.raw()
        ))
    }

    /// PCBDDC: local dofs of this rank's subdomain on the rest of the boundary. Collective.
    pub fn bddc_set_neumann_local(&self, dofs: &Is) -> Result<()> {
        petsc!(PCBDDCSetNeumannBoundariesLocal(self.0.raw(), dofs.0.raw()))
    }

    /// Sets the coordinates of the rows that this rank owns: the first `dim` entries of each point. Collective.
    pub fn set_coordinates(&self, dim: usize, points: &[[f64; 3]]) -> Result<()> {
        let flat: std::vec::Vec<f64> = points.iter().flat_map(|p| p[..dim].to_vec()).collect();
        let (dim, n) = (dim as i32, points.len() as i32);
        petsc!(PCSetCoordinates(
            self.0.raw(),
            dim,
            n,
            flat.as_ptr().cast_mut()
        ))
    }

    /// PCBDDC: the local dofs of this rank's subdomain by field. Collective.
    pub fn bddc_set_fields_local(&self, fields: &[Is]) -> Result<()> {
        let mut raw: std::vec::Vec<sys::IS> = fields.iter().map(|is| is.0.raw()).collect();
        petsc!(PCBDDCSetDofsSplittingLocal(
            self.0.raw(),
            raw.len() as i32,
            raw.as_mut_ptr()
        ))
    }

    /// PCBDDC: local dofs that are primal in addition to those that PCBDDC selects. Collective.
    pub fn bddc_set_primal_local(&self, dofs: &Is) -> Result<()> {
        petsc!(PCBDDCSetPrimalVerticesLocalIS(self.0.raw(), dofs.0.raw()))
    }
}
