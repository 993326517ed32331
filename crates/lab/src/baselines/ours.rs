//! Our method as one of the jobs, measured on the assembled problem like the others.

use std::path::Path;

use super::attempt::{solve_to, together, Attempt};
use super::second::SecondLoad;
use super::task::{ContactOutcome, Job, Outcome, StepOutcome};
use crate::assembled::layout::UnknownLayout;
use crate::assembled::load_steps::{LoadSteps, Slid};
use crate::assembled::problem::AssembledProblem;
use crate::assembled::rows::Inequalities;
use crate::assembled::system::{Copies, MatrixFormat};
use crate::assembled::unknowns::Unknowns;
use base::Result;
use fetifeti::settings::{MergeKind, MethodSettings};
use fetifeti::{FetiFeti, Solution, Subdomain};
use parallel::exchange::{gather_all, max_all};
use parallel::meter::{memory, timed};
use petsc::{Options, Session, Vec as PetscVec};
use scene::{distribution, Scene, Stepper};
use std::rc::Rc;

/// Solves a scene by the FETI-FETI method, with friction all its load steps.
///
/// # Errors
/// Those of the scene and of the method, PETSc's, and those of the disk.
pub fn solve(
    session: &Session,
    scene: &Scene,
    job: &Job,
    (threads, merges): (usize, bool),
    file: &Path,
) -> Result<Outcome> {
    Options::new(session, "fetifeti_").set_default("threads", &threads.to_string())?;
    let (substructures, assemble) = timed(session, || distribution::substructures(session, scene))?;
    // Recycled directions of one attempt would shorten the next one, which is the one that is timed.
    let mut settings = MethodSettings::default().rtol(job.rtol).recycle(0);
    if merges {
        settings = settings.merge(MergeKind::Ties);
    }
    let (solver, setup) = timed(session, || FetiFeti::new(session, substructures, settings))?;
    let mut solver = Some(solver);
    // The assembled matrix serves for the residual only: its time and memory do not count.
    let layout = UnknownLayout::new(scene);
    let mut measure: Option<Measure> = None;
    let mut bytes = 0.0;
    let scene_of_steps = Rc::new(scene.clone());
    let n = LoadSteps::number(scene);
    let (attempt, rtol, message) = solve_to(job.rtol, job.rtol, |rtol| {
        let own = solver.take().expect("every attempt gives it back");
        own.ksp().set_tolerances(Some(rtol), None, None, None)?;
        let (own, solutions) = solve_steps(own, &scene_of_steps, n)?;
        if measure.is_none() {
            bytes = memory(session);
            measure = Some(Measure::new(session, scene, &layout)?);
        }
        let measure = measure.as_mut().expect("it was built above");
        let mut slid = Slid::default();
        let (mut steps, mut u, mut recover) = (Vec::new(), Vec::new(), 0.0);
        for (k, solution) in solutions.iter().enumerate() {
            let mut seconds = [solution.solve_seconds, solution.recover_seconds];
            seconds[0] += seconds[1];
            max_all(session.comm(), &mut seconds);
            recover += seconds[1];
            let (at, residual, contact) = measure.step(k, &own, solution, &mut slid)?;
            u.push(at);
            steps.push(StepOutcome {
                iterations: Some(solution.iterations),
                setup: 0.0,
                solve: seconds[0],
                residual,
                contact,
            });
        }
        let last = solutions.last().expect("there is a load step");
        let mut estimates = solutions.iter().rev().filter_map(|s| s.estimate.as_ref());
        let (outcome, residual) = together(steps, n);
        solver = Some(own);
        Ok(Attempt {
            residual,
            u,
            converged: last.converged(),
            outcome: Outcome {
                kappa: estimates.next().map(|s| s.kappa()),
                recover: Some(recover),
                contact: outcome.contact.filter(|_| scene.has_contact()),
                reason: last.status.to_string(),
                ..outcome
            },
        })
    })?;
    attempt.save(file)?;
    let again = if job.again && n == 1 && message.is_none() {
        let mut solver = solver.expect("every attempt gives it back");
        Some(again(session, &mut solver, &layout, rtol)?)
    } else {
        None
    };
    let mut outcome = attempt.report(rtol, message, [assemble, setup, bytes]);
    outcome.again = again;
    if layout.trouble.is_some() {
        outcome.residual = None;
    }
    Ok(outcome)
}

/// Solves `n` load steps, up to one without a solution: those of the scene, or the last one alone. Returns the solver,
/// too. Collective.
fn solve_steps(
    mut solver: FetiFeti,
    scene: &Rc<Scene>,
    n: usize,
) -> Result<(FetiFeti, Vec<Solution>)> {
    if n == 1 {
        let solution = solver.solve()?;
        return Ok((solver, vec![solution]));
    }
    let mut stepper = Stepper::with_solver(scene.clone(), solver)?;
    let steps: Result<Vec<_>> = stepper.by_ref().map(|s| Ok(s?.solution)).collect();
    let solutions = steps?;
    Ok((stepper.into_solver(), solutions))
}

/// The assembled problem by which solutions are measured.
struct Measure<'a> {
    session: &'a Session,
    scene: &'a Scene,
    layout: &'a UnknownLayout<'a>,
    problem: AssembledProblem,
    steps: LoadSteps,
}

impl<'a> Measure<'a> {
    /// Assembles it. Collective.
    fn new(
        session: &'a Session,
        scene: &'a Scene,
        layout: &'a UnknownLayout<'a>,
    ) -> Result<Measure<'a>> {
        let (unknowns, format) = (Unknowns::all(layout), MatrixFormat::Unassembled);
        let problem = AssembledProblem::new(session, scene, &unknowns, format)?;
        let assembled = (&problem.system, &problem.rows);
        Ok(Measure {
            steps: LoadSteps::new(session, scene, assembled, format)?,
            session,
            scene,
            layout,
            problem,
        })
    }

    /// The assembled solution of a load step, its residual and its contact loop, where sides have slid so far; they
    /// slide on. Collective.
    fn step(
        &mut self,
        k: usize,
        solver: &FetiFeti,
        solution: &Solution,
        slid: &mut Slid,
    ) -> Result<(PetscVec, f64, ContactOutcome)> {
        let (session, step) = (self.session, &self.steps.0[k]);
        step.pose(&mut self.problem, slid)?;
        let problem = &self.problem;
        let (local, copies) = (&solver.problem().local, Copies::ByCoefficient);
        let unknowns = Unknowns::all(self.layout);
        let mean = problem
            .system
            .mean(session, local, &solution.u, &unknowns, copies);
        let (u, weight) = mean?;
        let mut contact = ContactOutcome::default();
        // Without an assembled problem there is no residual.
        let is_known = self.layout.trouble.is_none();
        if !self.scene.has_contact() {
            let residual = is_known.then(|| problem.system.relative_residual(&u));
            return Ok((u, residual.transpose()?.unwrap_or(0.0), contact));
        }
        let active = active(session, self.scene, solution, &problem.rows)?;
        contact.steps = Some(solution.steps.len());
        contact.active = problem.rows.list(&active);
        if !is_known {
            return Ok((u, 0.0, contact));
        }
        let residual = close(session, problem, active.clone(), &u, &weight)?;
        let slips = problem.rows_at(session, &u, &active)?.slips(&problem.rows);
        step.slide(&problem.rows, &slips, slid);
        Ok((u, residual, contact))
    }
}

/// Seconds of a solve for another load with the existing set-up; the contact loop starts from its initial set.
/// Collective.
fn again(
    session: &Session,
    solver: &mut FetiFeti,
    layout: &UnknownLayout,
    rtol: f64,
) -> Result<f64> {
    let second = SecondLoad::new(layout);
    let problem = solver.problem();
    let load = |s: &Subdomain| -> Vec<f64> {
        let terms = s.f.iter().zip(&s.dofs);
        terms
            .map(|(f, &dof)| f * second.at(layout, layout.index(dof)))
            .collect()
    };
    let loads = problem.local.iter().map(load).collect();
    let gaps: Vec<f64> = problem.rows.iter().map(|r| r.gap).collect();
    solver.set_loads(loads, &gaps);
    solver.ksp().set_tolerances(Some(rtol), None, None, None)?;
    let solution = solver.solve()?;
    // Measured as the first solve: without the certificate.
    let mut seconds = [solution.solve_seconds + solution.recover_seconds];
    max_all(session.comm(), &mut seconds);
    Ok(seconds[0])
}

/// Closes the jumps on the active rows that the iteration has left, by the weighted mean of both sides as on tied
/// faces, and returns the residual. Collective.
fn close(
    session: &Session,
    problem: &AssembledProblem,
    mut active: Vec<bool>,
    u: &PetscVec,
    weight: &PetscVec,
) -> Result<f64> {
    let groups = problem.groups(&mut active);
    let (_, bearing) = problem.bearing(&active);
    let at = |x: &PetscVec| problem.trace.get(session.comm(), x);
    let nearest = groups.nearest(&at(u)?, &at(weight)?);
    problem.trace.set(u, &groups.spread(&nearest))?;
    problem.stationarity(session, &bearing, u)
}

/// The active inequalities and the tangential rows that stick, the same on every rank. Collective.
fn active(
    session: &Session,
    scene: &Scene,
    solution: &Solution,
    rows: &Inequalities,
) -> Result<Vec<bool>> {
    let provided = rows.provided(&distribution::owner(session, scene)?);
    let solved = solution.rows().iter().chain(solution.tangential_rows());
    let held = provided.into_iter().zip(solved).filter(|(_, r)| r.holds());
    let mine: Vec<usize> = held.filter_map(|(k, _)| k).collect();
    Ok(rows.set(&gather_all(session.comm(), &mine).concat()))
}
