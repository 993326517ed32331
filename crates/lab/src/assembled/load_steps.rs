//! The load steps of an assembled problem, each solved from the end of the one before.
//!
//! ```text
//!     c_t = A + drag,      A ← A + w + drag        w = B_t u − C λ − c_t, the slip of the step
//! ```
//!
//! A step needs the slip A of nodes with friction from the steps before it. Without friction the last step says all,
//! and is the only one. All steps have one matrix.

use super::course::{ActiveSetEnd, OuterStart};
use super::layout::UnknownLayout;
use super::problem::AssembledProblem;
use super::rows::Inequalities;
use super::system::{load, AssembledSystem, MatrixFormat};
use super::unknowns::Unknowns;
use base::Result;
use petsc::{Session, Vec as PetscVec};
use scene::Scene;

/// One load step.
pub struct LoadStep {
    /// The load.
    pub b: PetscVec,
    /// The norm that residuals are relative to.
    pub reference: f64,
    /// The right-hand sides of the rows, with drags.
    gaps: Vec<f64>,
    /// How far obstacles drag the nodes of each row in this step.
    drags: Vec<f64>,
}

/// The load steps that are solved, in their order.
pub struct LoadSteps(pub Vec<LoadStep>);

/// How far the sides of each row have slid up to the start of a load step.
#[derive(Debug, Clone, Default)]
pub struct Slid(Vec<f64>);

impl LoadSteps {
    /// The number of load steps of a scene that are solved.
    pub fn number(scene: &Scene) -> usize {
        match scene.has_friction() {
            true => scene.n_steps(),
            false => 1,
        }
    }

    /// The load steps of a scene, whose last one has been assembled in this format. Collective.
    ///
    /// # Errors
    /// Those of the scene, and PETSc's.
    pub fn new(
        session: &Session,
        scene: &Scene,
        (system, rows): (&AssembledSystem, &Inequalities),
        format: MatrixFormat,
    ) -> Result<LoadSteps> {
        let before = 0..LoadSteps::number(scene) - 1;
        let before = before.map(|step| LoadStep::assembled(session, &scene.until(step)?, format));
        let mut steps: Vec<LoadStep> = before.collect::<Result<_>>()?;
        let b = system.b.duplicate()?;
        b.copy_from(&system.b)?;
        steps.push(LoadStep::last(scene, rows, b, system.reference)?);
        Ok(LoadSteps(steps))
    }

    /// Solves the steps in their order, up to one without a solution. Collective.
    ///
    /// # Errors
    /// Those of `solve`.
    pub fn follow(
        &self,
        rows: &mut Inequalities,
        mut solve: impl FnMut(&LoadStep, &Inequalities, OuterStart) -> Result<ActiveSetEnd>,
    ) -> Result<Vec<ActiveSetEnd>> {
        let mut slid = Slid::default();
        let mut ends: Vec<ActiveSetEnd> = Vec::new();
        for step in &self.0 {
            step.set_gaps(rows, &slid);
            let start = ends.last().map_or(OuterStart::Cold, OuterStart::After);
            let end = solve(step, rows, start)?;
            step.slide(rows, &end.gaps, &mut slid);
            let goes_on = end.converged;
            ends.push(end);
            if !goes_on {
                break;
            }
        }
        Ok(ends)
    }
}

impl LoadStep {
    /// The last load step of a scene. Collective.
    fn assembled(session: &Session, scene: &Scene, format: MatrixFormat) -> Result<LoadStep> {
        let layout = UnknownLayout::new(scene);
        let (b, reference) = load(session, scene, &Unknowns::all(&layout), format)?;
        let rows = Inequalities::new(scene, &layout);
        LoadStep::last(scene, &rows, b, reference)
    }

    /// The last load step of a scene, with these rows and this load.
    fn last(scene: &Scene, rows: &Inequalities, b: PetscVec, reference: f64) -> Result<LoadStep> {
        let all = scene.drags(&|_| true, scene.n_steps() - 1)?;
        let mut drags = vec![0.0; rows.len()];
        for (drag, place) in all.into_iter().zip(rows.provided(&|_| true)) {
            if let Some(r) = place {
                drags[r] = drag / rows.scale_of(r);
            }
        }
        Ok(LoadStep {
            b,
            reference,
            gaps: rows.rows.iter().map(|row| row.gap).collect(),
            drags,
        })
    }

    /// Gives the rows the right-hand sides of this step, where their sides have slid so far.
    fn set_gaps(&self, rows: &mut Inequalities, slid: &Slid) {
        let slid = slid.0.iter().chain(std::iter::repeat(&0.0));
        let both = self.gaps.iter().zip(slid);
        for (row, (gap, slid)) in rows.rows.iter_mut().zip(both) {
            row.gap = gap + slid;
        }
    }

    /// Gives a problem the load and the right-hand sides of this step. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn pose(&self, problem: &mut AssembledProblem, slid: &Slid) -> Result<()> {
        self.set_gaps(&mut problem.rows, slid);
        problem.system.set_load(&self.b, self.reference)
    }

    /// Adds the slips of this step, at whose end B u − C λ − c is `gaps`.
    pub fn slide(&self, rows: &Inequalities, gaps: &[f64], slid: &mut Slid) {
        slid.0.resize(rows.len(), 0.0);
        for &t in rows.friction.iter().flat_map(|node| &node.tangential) {
            slid.0[t] += gaps[t] + self.drags[t];
        }
    }
}
