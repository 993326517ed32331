//! The judge: a direct solution, and how far every method's solution is from it and from the conditions that it must satisfy.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::assembled::groups::{multipliers, Groups};
use crate::assembled::layout::Layout;
use crate::assembled::near::{Near, NearKernel};
use crate::assembled::outer::{self, Found, Tolerances};
use crate::assembled::reduced::Reduced;
use crate::assembled::rows::Rows;
use crate::assembled::system::{Format, System};
use crate::assembled::unknowns::{Trace, Unknowns};
use crate::petsc::{Comm, Ksp, Session, Vec as PetscVec};
use crate::scene::Scene;
use crate::Result;

/// Residual that a direct solution of a contact problem must have; refined, it has what rounding leaves.
const TARGET: f64 = 1e-8;

/// Solves with one factorisation, of which all but the first refine.
const SOLVES: usize = 3;

/// A row of which both force and gap are below this, relative to the largest force and displacement, touches without a force: methods may
/// count it or not.
const IDLE: f64 = 1e-8;

/// What the judge says.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// The direct solution.
    pub reference: Option<Judgement>,
    /// Active sets that it took; `None` without inequalities.
    pub steps: Option<usize>,
    /// Rows that hold in it.
    pub active: usize,
    /// Inequalities.
    pub rows: usize,
    /// Every solution.
    pub solutions: Vec<Judgement>,
}

/// What there is to say about one solution.
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
    /// With inequalities: rows that hold in one of solution and reference only.
    pub differ: Option<usize>,
}

/// Judges solutions in these files with these rows active. Collective.
///
/// # Errors
/// Those of the scene, PETSc's, and those of the disk.
pub fn judge(
    session: &Session,
    scene: &Scene,
    solutions: &[(PathBuf, Vec<usize>)],
) -> Result<Verdict> {
    let layout = Layout::new(scene);
    let unknowns = Unknowns::all(&layout);
    let system = System::new(session, scene, &unknowns, Format::Assembled)?;
    let rows = match scene.has_contact() {
        true => Rows::new(scene, &layout),
        false => Rows::default(),
    };
    let reference = reference(session, scene, &unknowns, &system, &rows, None)?;
    let trace = Trace::new(&rows, &system.b);
    let court = Court {
        session,
        system,
        rows,
        trace,
    };
    let mut holds = vec![false; court.rows.len()];
    let mut first = court.judge(&reference.u, reference.active.clone(), None, &mut holds)?;
    first.error = Some(0.0);
    let u_max = reference.u.norm_inf()?;
    let lambda_max = reference.lambda.iter().fold(0.0f64, |a, l| a.max(l.abs()));
    let idle = |r: usize| {
        let (l, gap) = (reference.lambda[r].abs(), reference.gaps[r].abs());
        l <= IDLE * lambda_max && gap <= IDLE * u_max
    };
    let counts: Vec<bool> = (0..court.rows.len()).map(|r| !idle(r)).collect();
    let mut verdict = Verdict {
        reference: reference.converged.then_some(first),
        steps: scene.has_contact().then_some(reference.steps),
        active: holds.iter().filter(|on| **on).count(),
        rows: court.rows.len(),
        solutions: Vec::new(),
    };
    let size = court.system.energy_norm(&reference.u)?;
    let d = reference.u.duplicate()?;
    for (file, active) in solutions {
        d.load(file)?;
        let mut own = vec![false; court.rows.len()];
        let active = court.rows.set(active);
        let mut one = court.judge(&d, active, Some((&holds, &counts)), &mut own)?;
        d.axpy(-1.0, &reference.u)?;
        let distance = court.system.energy_norm(&d)?;
        one.error = reference.converged.then_some(match size {
            size if size > 0.0 => distance / size,
            _ => distance,
        });
        if !reference.converged {
            one.differ = None;
        }
        verdict.solutions.push(one);
    }
    Ok(verdict)
}

/// The direct solution: MUMPS with iterative refinement, an active set around it where there are inequalities, unless the set is `given`. Collective.
///
/// # Errors
/// Those of the scene and PETSc's.
pub fn reference(
    session: &Session,
    scene: &Scene,
    unknowns: &Unknowns,
    system: &System,
    rows: &Rows,
    given: Option<&[bool]>,
) -> Result<Found> {
    if !scene.has_contact() {
        return linear(session, system);
    }
    let again = System::new(session, scene, unknowns, Format::Assembled)?;
    let kernel = NearKernel::new(scene, unknowns, &again.b, Near::None)?;
    let reduced = Reduced::new(session, again, rows, kernel)?;
    let ksp = direct(session)?;
    let tolerances = Tolerances {
        rtol: TARGET,
        inner: 0.0,
        lag: 0.0,
        solves: SOLVES,
    };
    let mut solver = || Ok(ksp.clone());
    outer::solve(session, rows, &reduced, &mut solver, tolerances, given)
}

/// MUMPS, without options.
fn direct(session: &Session) -> Result<Ksp> {
    let ksp = Ksp::new(session, Comm::World)?;
    ksp.set_type("preonly")?;
    let pc = ksp.pc()?;
    pc.set_type("cholesky")?;
    pc.set_solver_type("mumps")?;
    Ok(ksp)
}

/// A direct solution with iterative refinement.
fn linear(session: &Session, system: &System) -> Result<Found> {
    let ksp = direct(session)?;
    ksp.set_operators(&system.a, &system.a)?;
    let u = system.b.duplicate()?;
    let (r, d) = (u.duplicate()?, u.duplicate()?);
    for _ in 0..SOLVES {
        system.residual(&u, &r)?;
        ksp.solve(&r, &d)?;
        u.axpy(1.0, &d)?;
    }
    Ok(Found {
        residual: system.relative_residual(&u)?,
        u,
        active: Vec::new(),
        lambda: Vec::new(),
        gaps: Vec::new(),
        steps: 1,
        iterations: SOLVES,
        setup: 0.0,
        solve: 0.0,
        converged: true,
        reason: String::new(),
    })
}

/// What solutions are held against.
struct Court<'a> {
    session: &'a Session,
    system: System,
    rows: Rows,
    trace: Trace,
}

impl Court<'_> {
    /// Everything but the error; `holds` receives the rows that hold, `reference` those of the direct solution and which of them
    /// count. Collective.
    fn judge(
        &self,
        u: &PetscVec,
        mut active: Vec<bool>,
        reference: Option<(&[bool], &[bool])>,
        holds: &mut Vec<bool>,
    ) -> Result<Judgement> {
        if self.rows.len() == 0 {
            return Ok(Judgement {
                residual: Some(self.system.relative_residual(u)?),
                ..Judgement::default()
            });
        }
        let comm = self.session.comm();
        let in_order: Vec<usize> = (0..self.rows.len()).collect();
        let groups = Groups::new(&self.rows, &mut active, &in_order);
        let gaps = self.rows.gaps(&self.trace.get(comm, u)?);
        let r = u.duplicate()?;
        self.system.residual(u, &r)?;
        let lambda = multipliers(&self.rows, &active, &self.trace.get(comm, &r)?);
        // fold starts at zero: nothing that is not violated and nothing that does not pull counts.
        let lambda_max = lambda.iter().fold(0.0f64, |a, l| a.max(l.abs()));
        let least = lambda.iter().fold(0.0f64, |a, l| a.min(*l));
        let violation = gaps.iter().fold(0.0f64, |a, g| a.max(*g));
        let relative = |x: f64, size: f64| if size > 0.0 { x / size } else { x };
        let differ = reference.map(|(other, counts)| {
            let differs = |&r: &usize| counts[r] && groups.holds[r] != other[r];
            (0..self.rows.len()).filter(differs).count()
        });
        let residual = stationarity(self.session, &self.system, &self.trace, &groups, u)?;
        *holds = groups.holds;
        Ok(Judgement {
            error: None,
            residual: Some(residual),
            feasibility: Some(relative(violation, u.norm_inf()?)),
            min_multiplier: Some(relative(least, lambda_max)),
            differ,
        })
    }
}

/// ‖Tᵀ(f − K u)‖₂ relative to the load: what multipliers of the active rows cannot carry. Collective.
///
/// # Errors
/// PETSc's.
pub fn stationarity(
    session: &Session,
    system: &System,
    trace: &Trace,
    groups: &Groups,
    u: &PetscVec,
) -> Result<f64> {
    let r = u.duplicate()?;
    let folded = |x: &PetscVec| -> Result<f64> {
        system.residual(x, &r)?;
        let at = trace.get(session.comm(), &r)?;
        trace.set(&r, &groups.fold(&at))?;
        r.norm2()
    };
    let norm = folded(u)?;
    if system.reference > 0.0 {
        return Ok(system.relative(norm));
    }
    // Without a load: relative to Tᵀ K u₀.
    let given = u.duplicate()?;
    trace.set(&given, &groups.offset)?;
    let size = folded(&given)?;
    Ok(if size > 0.0 { norm / size } else { norm })
}
