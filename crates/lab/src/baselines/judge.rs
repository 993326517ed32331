//! The judge: a direct solution, the distance of every method's solution from it, and the residuals of the optimality
//! conditions.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::assembled::groups::{multipliers, unclear, MultiplierSigns};
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

/// Slips below this, relative to the largest displacement, have no direction.
const NO_SLIP: f64 = 1e-8;

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
    /// in both. Tangential rows of nodes that stick are active.
    pub differ: Option<usize>,
    /// With friction or soft contact: the largest distance of a force from its law, relative to the largest multiplier.
    pub law: Option<f64>,
    /// With friction or soft contact: the largest difference of a multiplier from that of the direct solution, relative
    /// to the largest one there.
    pub forces: Option<f64>,
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
    let court = ReferenceComparison {
        session,
        problem,
        diagonal: if problem.rows.has_laws() {
            diagonal(session, problem)?
        } else {
            Vec::new()
        },
    };
    let (mut first, holds, forces) = court.judge(&found.u, found.active.clone(), None)?;
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
    let known = DirectRows {
        holds: &holds,
        counts: &counts,
        forces: &forces,
    };
    for (file, active) in solutions {
        d.load(file)?;
        let active = problem.rows.set(active);
        let (mut one, ..) = court.judge(&d, active, Some(&known))?;
        d.axpy(-1.0, &found.u)?;
        let distance = reference.energy_norm(&d)?;
        one.error = found.converged.then_some(over(distance, size));
        if !found.converged {
            (one.differ, one.forces) = (None, None);
        }
        verdict.solutions.push(one);
    }
    Ok(verdict)
}

/// The diagonal of K at the unknowns in rows. Collective.
fn diagonal(session: &Session, problem: &AssembledProblem) -> Result<Vec<f64>> {
    let all = problem.system.b.duplicate()?;
    problem.system.a.diagonal(&all)?;
    problem.trace.get(session.comm(), &all)
}

/// The data that solutions are compared with.
struct ReferenceComparison<'a> {
    session: &'a Session,
    problem: &'a AssembledProblem,
    /// The diagonal of K at the unknowns in rows; empty without friction and soft contact.
    diagonal: Vec<f64>,
}

/// The rows in the direct solution.
struct DirectRows<'a> {
    /// Whether each holds.
    holds: &'a [bool],
    /// Whether it counts.
    counts: &'a [bool],
    /// Its multiplier; `None` where it is not the only one.
    forces: &'a [Option<f64>],
}

/// A judgement, which rows hold, and their multipliers as in [`DirectRows`].
type Judged = (Judgement, Vec<bool>, Vec<Option<f64>>);

impl ReferenceComparison<'_> {
    /// Everything but the error. Collective.
    fn judge(
        &self,
        u: &PetscVec,
        mut active: Vec<bool>,
        reference: Option<&DirectRows>,
    ) -> Result<Judged> {
        let AssembledProblem {
            system,
            rows,
            trace,
        } = self.problem;
        if rows.len() == 0 {
            let judgement = Judgement {
                residual: Some(system.relative_residual(u)?),
                ..Judgement::default()
            };
            return Ok((judgement, Vec::new(), Vec::new()));
        }
        let comm = self.session.comm();
        let mut holds = self.problem.groups(&mut active).holds;
        for (r, holds) in holds.iter_mut().enumerate() {
            *holds |= active[r];
        }
        let (bears, groups) = self.problem.bearing(&active);
        let gaps = rows.gaps(&trace.get(comm, u)?);
        let r = u.duplicate()?;
        system.residual(u, &r)?;
        let lambda = multipliers(rows, &bears, &trace.get(comm, &r)?, MultiplierSigns::Any);
        // The folds start at zero: only violated rows and pulling multipliers count.
        let lambda_max = lambda.iter().fold(0.0f64, |a, l| a.max(l.abs()));
        let tangential = rows.tangential();
        let bounds = || (0..rows.len()).filter(|&r| !tangential[r]);
        let least = bounds().fold(0.0f64, |a, r| a.min(lambda[r]));
        // A soft row gives way.
        let give = |r: usize| rows.softness(r) * lambda[r];
        let violation = bounds().fold(0.0f64, |a, r| a.max(gaps[r] - give(r)));
        let differ = reference.map(|known| {
            let differs = |&r: &usize| known.counts[r] && holds[r] != known.holds[r];
            (0..rows.len()).filter(differs).count()
        });
        let residual = self.problem.stationarity(self.session, &groups, u)?;
        let unclear = unclear(rows, &bears);
        let forces: Vec<Option<f64>> = lambda
            .iter()
            .zip(&unclear)
            .map(|(l, u)| (!u).then_some(*l))
            .collect();
        let u_max = u.norm_inf()?;
        let laws = rows.has_laws().then(|| {
            let at = (&lambda[..], &gaps[..], &active[..]);
            let nothing = NO_SLIP * u_max;
            self.problem
                .law_error(at, &self.diagonal, &unclear, nothing)
        });
        let apart = |known: &DirectRows| {
            let pairs = forces.iter().zip(known.forces);
            let apart = pairs.filter_map(|(a, b)| Some((a.as_ref()? - b.as_ref()?).abs()));
            let size = known
                .forces
                .iter()
                .flatten()
                .fold(0.0f64, |a, l| a.max(l.abs()));
            over(apart.fold(0.0, f64::max), size)
        };
        let judgement = Judgement {
            error: None,
            residual: Some(residual),
            feasibility: Some(over(violation, u_max)),
            min_multiplier: Some(over(least, lambda_max)),
            differ,
            law: laws.map(|error| over(error, lambda_max)),
            forces: reference.filter(|_| rows.has_laws()).map(apart),
        };
        Ok((judgement, holds, forces))
    }
}
