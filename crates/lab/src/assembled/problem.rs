//! K, f and the inequalities of a scene, and how far vectors are from satisfying them.

use super::groups::{multipliers, ActiveGroups, MultiplierSigns};
use super::rows::Inequalities;
use super::system::{AssembledSystem, MatrixFormat};
use super::unknowns::{Trace, Unknowns};
use base::Result;
use fetifeti::inside::node::{Node, Step};
use fetifeti::settings::FrictionTuning;
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

/// The rows at a displacement.
pub struct RowsAt {
    /// The rows that bear forces, and their groups: see [`AssembledProblem::bearing`].
    pub bears: Vec<bool>,
    /// The groups.
    pub groups: ActiveGroups,
    /// The multipliers.
    pub lambda: Vec<f64>,
    /// B u − c.
    pub gaps: Vec<f64>,
}

impl RowsAt {
    /// B u − C λ − c.
    pub fn slips(&self, rows: &Inequalities) -> Vec<f64> {
        let pairs = self.gaps.iter().zip(&self.lambda).enumerate();
        pairs
            .map(|(r, (gap, l))| gap - rows.softness(r) * l)
            .collect()
    }
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

    /// The rows that bear forces where these are active: the active ones, and the tangential rows of nodes with
    /// friction that touch, whether or not they stick; and the groups of all these. A force of friction or of a spring
    /// is then what the equations say, whatever its law.
    pub fn bearing(&self, active: &[bool]) -> (Vec<bool>, ActiveGroups) {
        let mut bears = active.to_vec();
        for node in &self.rows.friction {
            let touches = active[node.normal] || node.bound.acts_apart();
            for &t in &node.tangential {
                let row = self.rows.rows[t];
                bears[t] = touches && row.plus != row.minus;
            }
        }
        if !self.rows.has_laws() {
            return (bears, self.groups(&mut active.to_vec()));
        }
        let joined = Inequalities {
            compliance: Vec::new(),
            ..self.rows.clone()
        };
        let in_order: Vec<usize> = (0..self.rows.len()).collect();
        let groups = ActiveGroups::new(&joined, &mut bears.clone(), &in_order);
        (bears, groups)
    }

    /// The rows at a displacement where these are active. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn rows_at(&self, session: &Session, u: &PetscVec, active: &[bool]) -> Result<RowsAt> {
        let (bears, groups) = self.bearing(active);
        let comm = session.comm();
        let gaps = self.rows.gaps(&self.trace.get(comm, u)?);
        let r = u.duplicate()?;
        self.system.residual(u, &r)?;
        let forces = self.trace.get(comm, &r)?;
        Ok(RowsAt {
            lambda: multipliers(&self.rows, &bears, &forces, MultiplierSigns::Any),
            gaps,
            bears,
            groups,
        })
    }

    /// How far these multipliers are from the laws of friction and of soft contact, as a force: the largest
    /// |λ_t − Π_g(λ_t + k w)| of a node, with the projection Π_g onto the disc of radius g, and the largest
    /// |λ_n − (B u − c)/C| of a soft row. `diagonal` is that of K at the unknowns in rows. Rows in `unclear` do not
    /// count.
    pub fn law_error(
        &self,
        (lambda, gaps, active): (&[f64], &[f64], &[bool]),
        diagonal: &[f64],
        unclear: &[bool],
        nothing: f64,
    ) -> f64 {
        let rows = &self.rows;
        let each = || (0..rows.len()).map(|r| (r, rows.scale_of(r)));
        let force = rows.of_scene(lambda);
        let give: Vec<f64> = each()
            .map(|(r, s)| s * rows.softness(r) * lambda[r])
            .collect();
        let slip: Vec<f64> = each().map(|(r, s)| s * gaps[r] - give[r]).collect();
        let step = Step {
            lambda: &force,
            gaps: &slip,
            active,
            nothing,
        };
        let (compliance, beside, tuning) =
            (rows.give(diagonal), rows.beside(), FrictionTuning::DEFAULT);
        let mut most = 0.0f64;
        for node in &rows.friction {
            let mut own = node.tangential.iter().chain([&node.normal]);
            if own.any(|&r| unclear[r]) {
                continue;
            }
            let at = (&force[..], active);
            let node = Node::new(node, |r| r, beside[node.normal], at, &compliance, &tuning);
            most = most.max(node.error(&step));
        }
        let tangential = rows.tangential();
        let soft =
            |&r: &usize| rows.softness(r) > 0.0 && active[r] && !tangential[r] && !unclear[r];
        for r in (0..rows.len()).filter(soft) {
            most = most.max((lambda[r] - gaps[r] / rows.softness(r)).abs() / rows.scale_of(r));
        }
        most
    }

    /// ‖Tᵀ(f − K u)‖₂ relative to the load: the part of the residual that multipliers of the rows in `groups` cannot
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
