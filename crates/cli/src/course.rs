//! The course of a solve over the load steps of its scene.

use std::path::Path;
use std::time::Instant;

use super::early::Early;
use super::events::Events;
use super::fields::{GatherTarget, Gathered};
use super::first_rank::on_first_rank;
use super::friction::{self, FrictionRows};
use super::{balance, contact};
use crate::checkpoint::Checkpoints;
use base::Result;
use fetifeti::solution::SolvedRow;
use fetifeti::{Solution, Status};
use petsc::signals::{self, Heeded};
use petsc::Session;
use report::destination::Destination;
use report::json::certified::Certified;
use report::json::contact::{BodyBalance, LoadStep, OuterStep};
use report::paraview::pvd::Pvd;
use report::progress::ProgressLine;
use scene::sliding::Sliding;
use scene::Scene;
use scene::Stepper;

/// The results over the load steps.
pub(super) struct Course {
    /// The last solution.
    pub solution: Solution,
    /// The load step of this solution.
    pub step: usize,
    /// The bounds of its error, if they were asked for.
    pub certified: Option<Certified>,
    /// Its potential energy, with that of given values.
    pub energy: f64,
    pub outer: Vec<OuterStep>,
    pub load_steps: Vec<LoadStep>,
    /// Krylov iterations per outer step, or per load step without inequalities.
    pub iterations: Vec<usize>,
    pub solve_seconds: f64,
    pub recover_seconds: f64,
    /// Fields of load steps.
    pub write_seconds: f64,
    /// Rows of B_gl on rank 0.
    pub rows: Vec<SolvedRow>,
    /// Rows of friction on rank 0.
    pub friction: FrictionRows,
    /// The forces on every body in balance, on rank 0.
    pub balances: Vec<BodyBalance>,
    /// A warning about the bodies that are not in balance, on rank 0.
    pub unbalanced: Option<String>,
    /// In elasticity with contact, how far the sides that touch have slid since the pairing was made.
    pub slides: Option<contact::Slides>,
    /// The fields of this solution, where load steps are written.
    pub fields: Option<Gathered>,
}

impl Course {
    /// The rows of B_gl and the tangential ones.
    pub fn contact(&self) -> (&[SolvedRow], &[SolvedRow]) {
        (&self.rows, &self.friction.rows)
    }
}

/// Solves the load steps in order. Each starts from the end of the one before, the first from the checkpoint if there
/// is one. Collective.
pub(super) fn follow(
    session: &Session,
    stepper: Stepper,
    destination: &Destination,
    place: GatherTarget,
    (mut checkpoints, events): (Checkpoints, &Events),
) -> Result<(Stepper, Course)> {
    let mut progress = ProgressLine::new(session.rank() == 0 && !destination.quiet);
    let mut course: Option<Course> = None;
    let mut pvd = destination
        .out
        .as_ref()
        .map(|dir| Pvd::new(dir.join("solution.pvd")));
    let (mut stepper, mut records) = checkpoints.resume(session, stepper)?;
    let n = stepper.scene().n_steps();
    let times = stepper.scene().steps.as_ref().map(|s| s.times.clone());
    let first = stepper.next_step().unwrap_or(n);
    if let (Some(dir), Some(pvd), Some(times)) = (&destination.out, &mut pvd, &times) {
        session.agree(list_before(session, dir, &times[..first], place, pvd))?;
    }
    let (mut seconds, mut strained) = ([0.0; 3], 0.0);
    let mut fields: Option<Gathered> = None;
    let mut early = Early::new(session, stepper.scene(), stepper.solver())?;
    // From here on there are results to keep; before, a signal ends the program at once.
    let _signals = Heeded::watch();
    while let Some(step) = stepper.next_step() {
        if n > 1 {
            progress.load_step(step, n);
        }
        stepper.begin()?;
        let checkpointer = checkpoints.checkpointer(&stepper);
        if step > first && checkpointer.is_some() {
            let state = stepper.checkpoint()?;
            checkpoints.save(session, state, || records.clone())?;
        }
        let load_step = if times.is_some() { step + 1 } else { 0 };
        let mut outer = records.take(load_step);
        let solved = stepper.solve_by(|solver, scene, start| {
            early.solve(solver, scene, step, start, &mut |done, state| {
                outer.push(contact::outer_step(load_step, outer.len() + 1, done));
                progress.step(outer.len(), done.active);
                progress.residual(done.residual, done.tolerance, done.iterations);
                if let Some(last) = outer.last() {
                    events.step(session, last)?;
                }
                let state = checkpointer.as_ref().and_then(|c| c.checkpoint(state));
                checkpoints.save(session, state, || records.followed_by(&outer))?;
                signals::heed(session)
            })
        });
        let solved = solved.map_err(|e| {
            if signals::is_end(&e) {
                checkpoints.ended(e, (step, n), outer.len())
            } else {
                e
            }
        })?;
        let Some(mut solved) = solved else { break };
        progress.finish();
        let (scene, solver) = (stepper.scene(), stepper.solver());
        let solution = &mut solved.solution;
        let balances = balance::bodies(session, scene, solver, solution, (step, &mut strained))?;
        let (fails, unbalanced) = balance::out_of_balance(session, &balances);
        if fails && solution.converged() {
            solution.status = Status::Balance;
        }
        let rows = contact::rows(session, solution);
        seconds[0] += solution.solve_seconds;
        seconds[1] += solution.recover_seconds;
        let certified = early.record(session, scene, solution, step);
        let mut now = Course {
            step,
            certified,
            energy: solved.energy,
            iterations: if outer.is_empty() {
                vec![solution.iterations]
            } else {
                outer.iter().map(|s| s.iterations).collect()
            },
            outer,
            load_steps: Vec::new(),
            solve_seconds: seconds[0],
            recover_seconds: seconds[1],
            write_seconds: 0.0,
            friction: FrictionRows::new(session, solver, &solved.solution),
            solution: solved.solution,
            rows,
            balances: balances.into_iter().map(|b| b.record).collect(),
            unbalanced,
            slides: solved.slides,
            fields: None,
        };
        if let Some(t) = solved.time {
            now.load_steps.push(LoadStep {
                setup_seconds: solved.renewal.map(|r| r.seconds),
                factored: solved.renewal.map(|r| r.factored),
                ..load_step_record(scene, t, &now)
            });
        }
        if let (Some(dir), Some(pvd), Some(t)) = (&destination.out, &mut pvd, solved.time) {
            let clock = Instant::now();
            let fields = match &mut fields {
                Some(fields) => fields,
                None => fields.insert(Gathered::new(session, scene, solver, place)?),
            };
            fields.gather(session, scene, solver, &now.solution, step);
            let name = step_name(step);
            fields.write_vtu(session, scene, &now.solution, now.contact(), dir, &name)?;
            let file = dir.join(place.file(&name));
            on_first_rank(session, || pvd.add(t, &file))?;
            seconds[2] += clock.elapsed().as_secs_f64();
            now.write_seconds = seconds[2];
        }
        let done = course.insert(now);
        records.outer.append(&mut done.outer);
        records.load_steps.append(&mut done.load_steps);
        records.iterations.append(&mut done.iterations);
        if !done.solution.converged() {
            break;
        }
    }
    let last = course.expect("a scene has at least one load step");
    let course = Course {
        outer: records.outer,
        load_steps: records.load_steps,
        iterations: records.iterations,
        fields,
        ..last
    };
    Ok((stepper, course))
}

/// Lists the files of an interrupted run at the front of the time series.
fn list_before(
    session: &Session,
    dir: &Path,
    times: &[f64],
    place: GatherTarget,
    pvd: &mut Pvd,
) -> Result<()> {
    if session.rank() > 0 {
        return Ok(());
    }
    for (step, &t) in times.iter().enumerate() {
        let file = dir.join(place.file(&step_name(step)));
        if file.is_file() {
            pvd.add(t, &file)?;
        }
    }
    Ok(())
}

/// Name of the file of load step `step`, without its extension.
fn step_name(step: usize) -> String {
    format!("step_{:04}", step + 1)
}

/// The record of a load step; forces are known on rank 0.
fn load_step_record(scene: &Scene, t: f64, course: &Course) -> LoadStep {
    let inequalities = || course.rows.iter().filter(|r| r.is_inequality());
    let all = course.slides.as_ref().map(|all| all.values().copied());
    let slid = all.map(|all| all.fold(Sliding::default(), Sliding::max));
    LoadStep {
        t,
        outer_iterations: course.iterations.len(),
        iterations: course.iterations.iter().sum(),
        active: inequalities().filter(|r| r.holds()).count(),
        energy: course.energy,
        contact_force: inequalities().map(|r| r.multiplier).sum(),
        slid: contact::recorded(slid),
        friction: friction::force(scene, &course.friction.rows),
        ..LoadStep::default()
    }
}
