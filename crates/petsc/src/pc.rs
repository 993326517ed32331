//! Preconditioners.

use super::error::{c_string, text};
use super::handle::Handle;
use super::{Is, Vec};
use base::Result;
use petsc_sys as sys;
use petsc_sys::PetscInt;

/// A preconditioner, usually of a [`Ksp`](super::Ksp). [`Pc::set_shell`] makes one from Rust code.
pub type Pc = Handle<sys::_p_PC>;

impl Pc {
    /// Sets the type by PETSc's name (`"none"`, `"cholesky"`, `"gamg"`, `"bddc"`, …).
    pub fn set_type(&self, name: &str) -> Result<()> {
        petsc!(PCSetType(self.raw(), c_string(name).as_ptr()))
    }

    /// The type's name; empty if none is set.
    pub fn type_name(&self) -> Result<String> {
        text(|name| petsc!(PCGetType(self.raw(), name)))
    }

    /// The package of a factorisation (`"mumps"`, `"cholmod"`, …).
    pub fn set_solver_type(&self, package: &str) -> Result<()> {
        petsc!(PCFactorSetMatSolverType(
            self.raw(),
            c_string(package).as_ptr()
        ))
    }

    /// A factorisation fails at pivots of this size and below.
    pub fn set_zero_pivot(&self, size: f64) -> Result<()> {
        petsc!(PCFactorSetZeroPivot(self.raw(), size))
    }

    /// The prefix of this preconditioner's options, without a dash.
    pub fn set_options_prefix(&self, prefix: &str) -> Result<()> {
        petsc!(PCSetOptionsPrefix(self.raw(), c_string(prefix).as_ptr()))
    }

    /// Reads the options of this preconditioner.
    pub fn set_from_options(&self) -> Result<()> {
        petsc!(PCSetFromOptions(self.raw()))
    }

    /// Sets up the preconditioner. Collective.
    pub fn setup(&self) -> Result<()> {
        petsc!(PCSetUp(self.raw()))
    }

    /// y ← M⁻¹ x. Collective.
    pub fn apply(&self, x: &Vec, y: &Vec) -> Result<()> {
        let (x, y) = (x.read()?, y.write()?);
        petsc!(PCApply(self.raw(), x, y))
    }

    /// Sets the coordinates of the rows that this rank owns: the first `dim` entries of each point. Collective.
    pub fn set_coordinates(&self, dim: usize, points: &[[f64; 3]]) -> Result<()> {
        let flat: std::vec::Vec<f64> = points.iter().flat_map(|p| p[..dim].to_vec()).collect();
        let (dim, n) = (dim as PetscInt, points.len() as PetscInt);
        petsc!(PCSetCoordinates(
            self.raw(),
            dim,
            n,
            flat.as_ptr().cast_mut()
        ))
    }

    /// PCBDDC: local dofs of this rank that are primal, whatever else is. Collective.
    pub fn bddc_set_primal_vertices_local(&self, dofs: &Is) -> Result<()> {
        petsc!(PCBDDCSetPrimalVerticesLocalIS(self.raw(), dofs.raw()))
    }

    /// PCBDDC: the local dofs of this rank's subdomain by field. Collective.
    pub fn bddc_set_fields_local(&self, fields: &[Is]) -> Result<()> {
        let mut raw: std::vec::Vec<sys::IS> = fields.iter().map(|is| is.raw()).collect();
        petsc!(PCBDDCSetDofsSplittingLocal(
            self.raw(),
            raw.len() as PetscInt,
            raw.as_mut_ptr()
        ))
    }
}
