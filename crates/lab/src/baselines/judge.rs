//! The judge: a direct solution, the distance of every method's solution from it, and the residuals of the optimality
//! conditions.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::assembled::groups::{multipliers, MultiplierSigns};
use crate::assembled::layout::UnknownLayout;
use crate::assembled::problem::AssembledProblem;
use crate::assembled::reference::{Reference, ResidualPrecision};
use crate::assembled::refine::over;
use base::Result;
use petsc::{Session, Vec as PetscVec};
use scene::Scene;

/// A row counts as idle where both its force and its gap are below this, relative to the largest force and
/// displacement. It touches without a force, and methods may count it as active or not.
const IDLE: f64 = 1e-8;

/// The result of the judge.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct CaseJudgement {
    /// The judgement of the direct solution.
    pub reference: Option<Judgement>,
    /// Number of active sets on the way to the direct solution; `None` without inequalities.
    pub steps: Option<usize>,
    /// Number of active rows in the direct solution.
    pub active: usize,
    /// Number of inequalities.
    pub rows: usize,
    /// The judgement of every solution.
    pub solutions: Vec<Judgement>,
}

/// The judgement of one solution.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Judgement {
    /// Relative error in the energy norm; zero for the reference.
    pub error: Option<f64>,
    /// Residual on the unknowns of the active set, relative to the load.
    pub residual: Option<f64>,
    /// With inequalities: the largest violation, relative to the largest |u|.
    pub feasibility: Option<f64>,
    /// With inequalities: the smallest multiplier, relative to the largest; 0 where none pulls.
    pub min_multiplier: Option<f64>,
    /// With inequalities: the number of rows that are active in either the solution or the reference solution, but not
    /// in both.
    pub differ: Option<usize>,
}

/// Judges the solutions in these files, each with its active rows. Collective.
///
/// # Errors
/// Those of the scene, PETSc's, and those of the disk.
pub fn judge(
    session: &Session,
    scene: &Scene,
    solutions: &[(PathBuf, Vec<usize>)],
) -> Result<CaseJudgement> {
    let layout = UnknownLayout::new(scene);
    let reference = Reference::new(session, scene, &layout, ResidualPrecision::Twice, None)?;
    let (problem, found) = (&reference.problem, &reference.found);
    let court = ReferenceComparison { session, problem };
    let mut holds = vec![false; problem.rows.len()];
    let mut first = court.judge(&found.u, found.active.clone(), None, &mut holds)?;
    first.error = Some(0.0);
    let u_max = found.u.norm_inf()?;
    let lambda_max = found.lambda.iter().fold(0.0f64, |a, l| a.max(l.abs()));
    let idle = |r: usize| {
        let (l, gap) = (found.lambda[r].abs(), found.gaps[r].abs());
        l <= IDLE * lambda_max && gap <= IDLE * u_max
    };
    let counts: Vec<bool> = (0..problem.rows.len()).map(|r| !idle(r)).collect();
    let mut verdict = CaseJudgement {
        reference: found.converged.then_some(first),
        steps: scene.has_contact().then_some(found.steps),
        active: holds.iter().filter(|on| **on).count(),
        rows: problem.rows.len(),
        solutions: Vec::new(),
    };
    let size = reference.energy_norm(&found.u)?;
    let d = found.u.duplicate()?;
    for (file, active) in solutions {
        d.load(file)?;
        let mut own = vec![false; problem.rows.len()];
        let active = problem.rows.set(active);
        let mut one = court.judge(&d, active, Some((&holds, &counts)), &mut own)?;
        d.axpy(-1.0, &found.u)?;
        let distance = reference.energy_norm(&d)?;
        one.error = found.converged.then_some(over(distance, size));
        if !found.converged {
            one.differ = None;
        }
        verdict.solutions.push(one);
    }
    Ok(verdict)
}

/// The data that solutions are compared with.
struct ReferenceComparison<'a> {
    session: &'a Session,
    problem: &'a AssembledProblem,
}

impl ReferenceComparison<'_> {
    /// Everything but the error. `holds` receives the rows that hold; `reference` contains the rows of the direct
    /// solution, and which rows count. Collective.
    fn judge(
        &self,
        u: &PetscVec,
        mut active: Vec<bool>,
        reference: Option<(&[bool], &[bool])>,
        holds: &mut Vec<bool>,
    ) -> Result<Judgement> {
        let AssembledProblem {
            system,
            rows,
            trace,
        } = self.problem;
        if rows.len() == 0 {
            return Ok(Judgement {
                residual: Some(system.relative_residual(u)?),
                ..Judgement::default()
            });
        }
        let comm = self.session.comm();
        let groups = self.problem.groups(&mut active);
        let gaps = rows.gaps(&trace.get(comm, u)?);
        let r = u.duplicate()?;
        system.residual(u, &r)?;
        let lambda = multipliers(rows, &active, &trace.get(comm, &r)?, MultiplierSigns::Any);
        // The folds start at zero: only violated rows and pulling multipliers count.
        let lambda_max = lambda.iter().fold(0.0f64, |a, l| a.max(l.abs()));
        let least = lambda.iter().fold(0.0f64, |a, l| a.min(*l));
        let violation = gaps.iter().fold(0.0f64, |a, g| a.max(*g));
        let differ = reference.map(|(other, counts)| {
            let differs = |&r: &usize| counts[r] && groups.holds[r] != other[r];
            (0..rows.len()).filter(differs).count()
        });
        let residual = self.problem.stationarity(self.session, &groups, u)?;
        *holds = groups.holds;
        Ok(Judgement {
            error: None,
            residual: Some(residual),
            feasibility: Some(over(violation, u.norm_inf()?)),
            min_multiplier: Some(over(least, lambda_max)),
            differ,
        })
    }
}
