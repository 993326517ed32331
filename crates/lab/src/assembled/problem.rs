//! K, f and the inequalities of a scene, and how far vectors are from satisfying them.

use super::groups::ActiveGroups;
use super::rows::Inequalities;
use super::system::{AssembledSystem, MatrixFormat};
use super::unknowns::{Trace, Unknowns};
use base::Result;
use petsc::{Session, Vec as PetscVec};
use scene::Scene;

/// The assembled problem of a scene with its inequalities.
pub struct AssembledProblem {
    /// K and f.
    pub system: AssembledSystem,
    /// The inequalities; none where the scene has no contact.
    pub rows: Inequalities,
    /// Access to the entries of vectors at the unknowns in rows.
    pub trace: Trace,
}

impl AssembledProblem {
    /// Assembles the scene. Collective.
    ///
    /// # Errors
    /// Those of the scene and PETSc's.
    pub fn new(
        session: &Session,
        scene: &Scene,
        unknowns: &Unknowns,
        format: MatrixFormat,
    ) -> Result<AssembledProblem> {
        let system = AssembledSystem::new(session, scene, unknowns, format)?;
        let rows = if scene.has_contact() {
            Inequalities::new(scene, unknowns.layout)
        } else {
            Inequalities::default()
        };
        let trace = Trace::new(&rows, &system.b);
        Ok(AssembledProblem {
            system,
            rows,
            trace,
        })
    }

    /// The groups of an active set. Rows are imposed in their order; a row that contradicts earlier ones is removed
    /// from the set.
    pub fn groups(&self, active: &mut [bool]) -> ActiveGroups {
        let in_order: Vec<usize> = (0..self.rows.len()).collect();
        ActiveGroups::new(&self.rows, active, &in_order)
    }

    /// ‖Tᵀ(f − K u)‖₂ relative to the load: the part of the residual that multipliers of the active rows cannot
    /// balance. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn stationarity(
        &self,
        session: &Session,
        groups: &ActiveGroups,
        u: &PetscVec,
    ) -> Result<f64> {
        let r = u.duplicate()?;
        let folded = |x: &PetscVec| -> Result<f64> {
            self.system.residual(x, &r)?;
            let at = self.trace.get(session.comm(), &r)?;
            self.trace.set(&r, &groups.fold(&at))?;
            r.norm2()
        };
        let norm = folded(u)?;
        if self.system.reference > 0.0 {
            return Ok(self.system.relative(norm));
        }
        // Without a load the norm is relative to Tᵀ K u₀.
        let given = u.duplicate()?;
        self.trace.set(&given, &groups.offset)?;
        let size = folded(&given)?;
        Ok(if size > 0.0 { norm / size } else { norm })
    }
}
