//! The judge: a direct solution, the distance of every method's solution from it, and the residuals of the optimality
//! conditions.

use serde::{Deserialize, Serialize};

use super::task::StepFile;
use crate::assembled::course::ActiveSetEnd;
use crate::assembled::groups::unclear;
use crate::assembled::layout::UnknownLayout;
use crate::assembled::load_steps::{LoadStep, Slid};
use crate::assembled::problem::{AssembledProblem, RowsAt};
use crate::assembled::reference::{Reference, ResidualPrecision};
use crate::assembled::refine::over;
use crate::assembled::strain::energy_norm;
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
    /// Where several load steps are solved, the judgement of every solution at each of them.
    #[serde(default)]
    pub load_steps: Vec<Vec<Judgement>>,
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
    /// Where several load steps are solved: the distance from our solution in the energy norm, relative to that.
    pub from_ours: Option<f64>,
}

impl Judgement {
    /// The judgement of all load steps together: the worst of each, and all rows that differ.
    fn of_all(steps: &[Judgement]) -> Judgement {
        let worst = |of: fn(&Judgement) -> Option<f64>| -> Option<f64> {
            let mut values = steps.iter().map(of);
            values.try_fold(0.0f64, |a, v| Some(a.max(v?)))
        };
        let mut least = steps.iter().map(|s| s.min_multiplier);
        Judgement {
            error: worst(|s| s.error),
            residual: worst(|s| s.residual),
            feasibility: worst(|s| s.feasibility),
            min_multiplier: least.try_fold(0.0f64, |a, v| Some(a.min(v?))),
            differ: steps.iter().map(|s| s.differ).sum(),
            law: worst(|s| s.law),
            forces: worst(|s| s.forces),
            from_ours: worst(|s| s.from_ours),
        }
    }
}

/// Judges solutions: each is a list of load steps, by their files and active rows. Collective.
///
/// # Errors
/// Those of the scene, PETSc's, and those of the disk.
pub fn judge(
    session: &Session,
    scene: &Scene,
    solutions: &[Vec<StepFile>],
) -> Result<CaseJudgement> {
    let layout = UnknownLayout::new(scene);
    let reference = Reference::new(session, scene, &layout, ResidualPrecision::Twice, None)?;
    let Reference {
        problem,
        found,
        steps,
        before,
        ..
    } = reference;
    let diagonal = match problem.rows.has_laws() {
        true => diagonal(session, &problem)?,
        false => Vec::new(),
    };
    let mut court = ReferenceComparison {
        session,
        layout: &layout,
        problem,
        diagonal,
    };
    let direct: Vec<&ActiveSetEnd> = before.iter().chain([&found]).collect();
    let mut slid = vec![Slid::default(); solutions.len() + 1];
    let mut own = Vec::new();
    let mut verdict = CaseJudgement {
        steps: (scene.has_contact()).then(|| direct.iter().map(|end| end.steps).sum()),
        rows: court.problem.rows.len(),
        load_steps: vec![Vec::new(); solutions.len()],
        ..CaseJudgement::default()
    };
    for (k, step) in steps.0.iter().enumerate() {
        let mut known = None;
        if let Some(end) = direct.get(k) {
            let mut judged = court.judge(step, &end.u, end.active.clone(), (&mut slid[0], None))?;
            judged.0.error = Some(0.0);
            verdict.active = judged.1.iter().filter(|on| **on).count();
            own.push(judged.0);
            known = end
                .converged
                .then(|| court.direct(end, judged))
                .transpose()?;
        }
        let mut ours = None;
        for (i, files) in solutions.iter().enumerate() {
            let Some((file, active)) = files.get(k) else {
                continue;
            };
            let u = court.problem.system.b.duplicate()?;
            u.load(file)?;
            let active = court.problem.rows.set(active);
            let at = (&mut slid[i + 1], known.as_ref());
            let (mut one, ..) = court.judge(step, &u, active, at)?;
            if steps.0.len() > 1 {
                one.from_ours = Some(court.distance(&u, ours.as_ref().unwrap_or(&u))?);
            }
            verdict.load_steps[i].push(one);
            ours.get_or_insert(u);
        }
    }
    verdict.reference = found.converged.then(|| Judgement::of_all(&own));
    let all = verdict.load_steps.iter();
    verdict.solutions = all.map(|list| Judgement::of_all(list)).collect();
    if steps.0.len() == 1 {
        verdict.load_steps.clear();
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
    layout: &'a UnknownLayout<'a>,
    problem: AssembledProblem,
    /// The diagonal of K at the unknowns in rows; empty without friction and soft contact.
    diagonal: Vec<f64>,
}

/// The direct solution of a load step.
struct DirectRows<'a> {
    /// The displacements.
    u: &'a PetscVec,
    /// Whether each row holds.
    holds: Vec<bool>,
    /// Whether it counts.
    counts: Vec<bool>,
    /// Its multiplier; `None` where it is not the only one.
    forces: Vec<Option<f64>>,
}

/// A judgement, which rows hold, and their multipliers as in [`DirectRows`].
type Judged = (Judgement, Vec<bool>, Vec<Option<f64>>);

impl ReferenceComparison<'_> {
    /// The direct solution of a load step, which has been judged. Collective.
    fn direct<'e>(&self, end: &'e ActiveSetEnd, judged: Judged) -> Result<DirectRows<'e>> {
        let (_, holds, forces) = judged;
        let u_max = end.u.norm_inf()?;
        let lambda_max = end.lambda.iter().fold(0.0f64, |a, l| a.max(l.abs()));
        let idle = |r: usize| {
            let (l, gap) = (end.lambda[r].abs(), end.gaps[r].abs());
            l <= IDLE * lambda_max && gap <= IDLE * u_max
        };
        Ok(DirectRows {
            u: &end.u,
            counts: (0..holds.len()).map(|r| !idle(r)).collect(),
            holds,
            forces,
        })
    }

    /// The distance of two solutions in the energy norm, relative to the second one. Collective.
    fn distance(&self, u: &PetscVec, from: &PetscVec) -> Result<f64> {
        let norm = |w: &PetscVec| energy_norm(self.session, self.layout, &self.problem.system, w);
        let d = u.duplicate()?;
        d.copy_from(u)?;
        d.axpy(-1.0, from)?;
        Ok(over(norm(&d)?, norm(from)?))
    }

    /// A solution of a load step, where its own sides have slid so far; they slide on. Collective.
    fn judge(
        &mut self,
        step: &LoadStep,
        u: &PetscVec,
        mut active: Vec<bool>,
        (slid, reference): (&mut Slid, Option<&DirectRows>),
    ) -> Result<Judged> {
        step.pose(&mut self.problem, slid)?;
        let error = reference
            .map(|known| self.distance(u, known.u))
            .transpose()?;
        let AssembledProblem { system, rows, .. } = &self.problem;
        if rows.len() == 0 {
            let judgement = Judgement {
                error,
                residual: Some(system.relative_residual(u)?),
                ..Judgement::default()
            };
            return Ok((judgement, Vec::new(), Vec::new()));
        }
        let mut holds = self.problem.groups(&mut active).holds;
        for (r, holds) in holds.iter_mut().enumerate() {
            *holds |= active[r];
        }
        let at = self.problem.rows_at(self.session, u, &active)?;
        step.slide(rows, &at.slips(rows), slid);
        let RowsAt {
            bears,
            groups,
            lambda,
            gaps,
        } = at;
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
            let pairs = forces.iter().zip(&known.forces);
            let apart = pairs.filter_map(|(a, b)| Some((a.as_ref()? - b.as_ref()?).abs()));
            let size = known
                .forces
                .iter()
                .flatten()
                .fold(0.0f64, |a, l| a.max(l.abs()));
            over(apart.fold(0.0, f64::max), size)
        };
        let judgement = Judgement {
            error,
            residual: Some(residual),
            feasibility: Some(over(violation, u_max)),
            min_multiplier: Some(over(least, lambda_max)),
            differ,
            law: laws.map(|error| over(error, lambda_max)),
            forces: reference.filter(|_| rows.has_laws()).map(apart),
            from_ours: None,
        };
        Ok((judgement, holds, forces))
    }
}
