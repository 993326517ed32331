//! `fetifeti compare`: every method once.

use std::path::Path;
use std::time::Duration;

use mpi::point_to_point::{Destination, Source};
use mpi::traits::Communicator;

use super::launch::{Failure, Launcher, Workspace};
use super::methods::{forwarded, inequalities, row, sentence, Methods, Ran};
use super::plan::{Layouts, Plan};
use super::table::{self, Case};
use crate::cli::args::Compare;
use crate::cli::problem;
use crate::petsc::{Options, Session};
use crate::report::json::{self, CompareReport, CompareRow};
use crate::report::output;
use crate::report::tables::compare;
use crate::scene::{Numbering, Scene};
use crate::{Error, Result};

/// Runs the comparison. Under mpirun only rank 0 starts jobs, the others wait. Collective.
///
/// Jobs are started with the running executable, which must be the `fetifeti` program.
///
/// # Errors
/// [`Error::Input`] for what can be known before anything runs, and where the first job (ours) finds the problem
/// unsolvable; [`Error::NotConverged`] when ours does not converge; [`Error::Environment`] without mpirun. A baseline that fails
/// is no error but a row with a message.
pub fn compare(session: &Session, args: &Compare, petsc: &[String]) -> Result<()> {
    let scene = problem::load(session, &args.scene)?;
    let baselines = session.agree(table::select(&args.with))?;
    let plan = Plan::new(session, &scene, &baselines, Layouts::Two)?;
    let all = Options::new(session, "");
    if all.has("help")? || all.has("h")? {
        for baseline in &baselines {
            baseline.set_options(session, plan.rtol, Case::of(&scene))?;
        }
    }
    let ready = if session.rank() == 0 {
        prepare(args.out.as_deref(), args.json.as_deref())
    } else {
        Ok(())
    };
    session.agree(ready)?;
    on_first_rank(session, || run(args, &scene, &plan, petsc))
}

/// Finds out before the work whether results can be written.
///
/// # Errors
/// [`Error::Environment`] with the path.
pub fn prepare(out: Option<&Path>, json: Option<&Path>) -> Result<()> {
    if let Some(dir) = out {
        output::prepare_directory(dir)?;
    }
    json.map_or(Ok(()), output::prepare_file)
}

/// Does `work` on rank 0; the others sleep until it is done, for the cores belong to the jobs. Collective.
///
/// # Errors
/// Those of `work`, on all ranks.
pub fn on_first_rank(session: &Session, work: impl FnOnce() -> Result<()>) -> Result<()> {
    let comm = session.comm();
    if session.rank() == 0 {
        let finished = work();
        for rank in 1..session.size() {
            comm.process_at_rank(rank as i32).send(&1_i32);
        }
        return session.agree(finished);
    }
    let first = comm.process_at_rank(0);
    while first.immediate_probe().is_none() {
        std::thread::sleep(Duration::from_millis(50));
    }
    let (_, _): (i32, _) = first.receive();
    session.agree(Ok(()))
}

/// On rank 0: all jobs one after the other, then the judge, then the tables.
fn run(args: &Compare, scene: &Scene, plan: &Plan, petsc: &[String]) -> Result<()> {
    let launcher = Launcher {
        workspace: Workspace::new()?,
        limit: plan.limit,
        petsc: forwarded(petsc),
    };
    let file = std::fs::canonicalize(&args.scene).unwrap_or_else(|_| args.scene.clone());
    let to_stdout = args.json.as_deref().is_some_and(output::is_stdout);
    let quiet = args.quiet || to_stdout;
    let mut methods = Methods::new(&launcher, plan, scene, file);
    let mut rows = Vec::new();
    // Numbers of the rows that have a solution; the solutions.
    let (mut solved, mut solutions) = (Vec::new(), Vec::new());
    for (k, run) in plan.runs.iter().enumerate() {
        progress(args, &run.title());
        let mut ran = methods.run(k, false)?;
        if !quiet && !ran.printed.trim().is_empty() {
            println!("{}:\n{}", run.title(), ran.printed);
        }
        // What ours cannot solve is a mistake in the scene or here, and the comparison ends.
        if run.baseline.is_none() {
            let outcome = ran.outcome.map_err(Failure::into_error)?;
            ran = Ran {
                outcome: Ok(outcome),
                ..ran
            };
        }
        if let Some(solution) = ran.solution.take() {
            solved.push(k);
            solutions.push(solution);
        }
        rows.push(row(run, ran));
    }
    progress(args, "direct solution");
    let verdict = methods.judge(solutions)?;
    for (k, judgement) in solved.into_iter().zip(&verdict.solutions) {
        sentence(&mut rows[k], judgement);
    }
    progress(args, "");
    let report = CompareReport {
        scene: scene.title.clone(),
        bodies: scene.n_bodies(),
        subdomains: scene.n_subdomains(),
        dofs: Numbering::new(scene).len() as usize,
        rtol: plan.rtol,
        cores: plan.cores,
        supports: methods.layout.loose(),
        reference_residual: verdict.reference.and_then(|r| r.residual),
        contact: inequalities(scene, &verdict),
        rows,
    };
    write(args, &report)?;
    // An assembled residual that rounding keeps away from its target is said in the table; the method itself has converged.
    let stopped =
        |r: &&CompareRow| r.method == "fetifeti" && !r.converged_reason.starts_with("CONVERGED");
    match report.rows.iter().find(stopped) {
        None => Ok(()),
        Some(row) => Err(Error::NotConverged(format!(
            "fetifeti on {}: {}",
            args.scene.display(),
            row.message.as_deref().unwrap_or(&row.converged_reason)
        ))),
    }
}

/// One line on stderr that overwrites itself, on a terminal only.
fn progress(args: &Compare, what: &str) {
    use std::io::IsTerminal;
    if !args.quiet && std::io::stderr().is_terminal() {
        let text = if what.is_empty() {
            String::new()
        } else {
            format!("compare: {what}")
        };
        eprint!("\r\x1b[K{text}");
    }
}

fn write(args: &Compare, report: &CompareReport) -> Result<()> {
    let to_stdout = args.json.as_deref().is_some_and(output::is_stdout);
    if !args.quiet && !to_stdout {
        print!("{}", compare::text(report));
    }
    if let Some(file) = &args.json {
        json::write(file, report)?;
    }
    if let Some(dir) = &args.out {
        json::write(&dir.join("compare.json"), report)?;
        compare::csv(&report.rows).write_csv(&dir.join("compare.csv"))?;
        if !args.quiet && !to_stdout {
            println!("written: compare.json, compare.csv in {}", dir.display());
        }
    }
    Ok(())
}
