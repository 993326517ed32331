//! PETSc's own solvers on the same problem: PCBDDC, KSPFETIDP, GAMG, hypre's BoomerAMG and MUMPS beside ours.
//!
//! ```text
//! Scene ──> System (A u = b, one unknown per tied point) ──> KSP by a row of option strings ──> Outcome
//!      └──> FetiFeti ───────────────────────────────────────────────────────────────────────> Outcome
//!                                             all solutions ──> judge (direct solution) ─────> Verdict
//! ```
//!
//! In elasticity u is taken in blocks of nodes, along the normals of contact (`layout`, `frame`), and solvers are told the rigid motions (`near`).
//! With inequalities the solvers of the assembled problem stand inside an active-set loop (`outer`); the domain decompositions of PETSc
//! solve the equations of the last active set.
//!
//! Every method runs in a process group of its own, started by mpirun, so that neither its memory nor its time is another's. All are
//! driven to the same relative residual of the assembled problem.

mod attempt;
mod contact;
mod frame;
mod groups;
mod job;
mod judge;
mod launch;
mod layout;
mod linear;
mod motions;
mod near;
mod ours;
mod outer;
mod plan;
mod reduced;
mod rows;
pub(crate) mod single;
mod system;
mod table;
mod unknowns;

use std::path::{Path, PathBuf};
use std::time::Duration;

use mpi::point_to_point::{Destination, Source};
use mpi::traits::Communicator;

use crate::cli::args::Compare;
use crate::cli::problem;
use crate::petsc::{Options, Session};
use crate::report::json::{
    self, CompareContact, CompareInequalities, CompareReport, CompareRow, CompareSeconds,
};
use crate::report::{compare, output};
use crate::scene::{Numbering, Scene};
use crate::{Error, Result};
pub(crate) use job::Outcome;
use job::{Job, Task};
use judge::{Judgement, Verdict};
use launch::{Failure, Launcher, Workspace};
use layout::Layout;
use plan::{Plan, Run};
use table::Case;

pub use job::run as run_job;
pub use table::BASELINES;

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
    let plan = Plan::new(session, &scene, &baselines)?;
    let all = Options::new(session, "");
    if all.has("help")? || all.has("h")? {
        for baseline in &baselines {
            baseline.set_options(session, plan.rtol, Case::of(&scene))?;
        }
    }
    let ready = if session.rank() == 0 {
        prepare(args)
    } else {
        Ok(())
    };
    session.agree(ready)?;
    let finished = if session.rank() == 0 {
        run(args, &scene, &plan, petsc)
    } else {
        Ok(())
    };
    wait_for_first(session);
    session.agree(finished)
}

/// Finds out before the work whether results can be written.
fn prepare(args: &Compare) -> Result<()> {
    if let Some(dir) = &args.out {
        output::prepare_directory(dir)?;
    }
    args.json.as_deref().map_or(Ok(()), output::prepare_file)
}

/// Rank 0 tells the others that it is done; they sleep until then, for the cores belong to the jobs.
fn wait_for_first(session: &Session) {
    let comm = session.comm();
    if session.rank() == 0 {
        for rank in 1..session.size() {
            comm.process_at_rank(rank as i32).send(&1_i32);
        }
        return;
    }
    let first = comm.process_at_rank(0);
    while first.immediate_probe().is_none() {
        std::thread::sleep(Duration::from_millis(50));
    }
    let (_, _): (i32, _) = first.receive();
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
    let mut rows = Vec::new();
    // Numbers of the rows that have a solution; the solutions.
    let (mut solved, mut solutions) = (Vec::new(), Vec::new());
    // The active set of the last contact loop: methods that solve equations only take it.
    let mut active: Vec<usize> = Vec::new();
    let layout = Layout::new(scene);
    for (k, run) in plan.runs.iter().enumerate() {
        let name = run.baseline.map_or("fetifeti", |b| b.name);
        if let (Some(_), Some(trouble)) = (run.baseline, &layout.trouble) {
            let message = format!("not for this scene: {trouble}");
            rows.push(row(name, run, Err(message)));
            continue;
        }
        let solution = launcher.workspace.file(&format!("{k}.u"));
        let solve = |rescue: bool| -> Result<std::result::Result<Outcome, Failure>> {
            progress(args, &format!("{name} on {} ranks", run.ranks));
            let job = Job {
                scene: file.clone(),
                result: launcher.workspace.file(&format!("{k}-{rescue}.json")),
                rtol: plan.rtol,
                inner: plan.inner,
                task: run.task(&solution, rescue, &active),
            };
            let finished = launcher.run(&format!("{k}-{rescue}"), &job, run.ranks)?;
            if !quiet && !finished.printed.trim().is_empty() {
                println!("{name} on {} ranks:\n{}", run.ranks, finished.printed);
            }
            finished
                .record
                .map(|text| read(&text))
                .map_or_else(|f| Ok(Err(f)), |o| o.map(Ok))
        };
        let mut outcome = solve(false)?;
        let mut rescue = None;
        match run.baseline {
            // What ours cannot solve is a mistake in the scene or here, and the comparison ends.
            None => outcome = Ok(outcome.map_err(Failure::into_error)?),
            Some(b) if !b.rescue.is_empty() && worth_a_second_try(&outcome) => {
                rescue = Some(b.rescue_options());
                outcome = solve(true)?;
            }
            Some(_) => {}
        }
        if let Ok(outcome) = &outcome {
            let contact = outcome.contact.as_ref();
            if contact.is_some_and(|c| c.steps.is_some()) && run.baseline.is_none() {
                active = contact.map(|c| c.active.clone()).unwrap_or_default();
            }
            let rows = contact.map(|c| c.active.clone()).unwrap_or_default();
            solved.push(k);
            solutions.push((solution, rows));
        }
        rows.push(CompareRow {
            rescue,
            ..row(name, run, outcome.map_err(|failure| failure.message))
        });
    }
    progress(args, "direct solution");
    let verdict = match layout.trouble {
        None => judge(&launcher, plan, &file, solutions)?,
        Some(_) => Verdict {
            rows: layout.forms.len(),
            ..Verdict::default()
        },
    };
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
        supports: layout.loose(),
        reference_residual: verdict.reference.and_then(|r| r.residual),
        contact: scene.has_contact().then(|| inequalities(scene, &verdict)),
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

/// Writes into a row what the judge says.
fn sentence(row: &mut CompareRow, judgement: &Judgement) {
    row.error = judgement.error;
    row.residual = judgement.residual;
    if let Some(contact) = &mut row.contact {
        contact.differ = judgement.differ;
        contact.feasibility = judgement.feasibility;
        contact.min_multiplier = judgement.min_multiplier;
    }
}

fn inequalities(scene: &Scene, verdict: &Verdict) -> CompareInequalities {
    let reference = verdict.reference;
    CompareInequalities {
        rows: verdict.rows,
        active: reference.map(|_| verdict.active),
        outer: verdict.steps,
        feasibility: reference.and_then(|r| r.feasibility),
        min_multiplier: reference.and_then(|r| r.min_multiplier),
        load_steps: scene.n_steps(),
    }
}

/// Whether a method broke down, rather than took too long or met the limits of rounding.
fn worth_a_second_try(outcome: &std::result::Result<Outcome, Failure>) -> bool {
    match outcome {
        Ok(outcome) => !outcome.reason.starts_with("CONVERGED"),
        Err(failure) => failure.code.is_some(),
    }
}

/// PETSc's arguments for the jobs: what asks for a text about the whole program is for the parent.
fn forwarded(petsc: &[String]) -> Vec<String> {
    const PARENTS: [&str; 4] = ["-help", "-h", "-options_left", "-version"];
    let mut forwarded = Vec::new();
    let mut drop_value = false;
    for arg in petsc {
        let is_option = arg.starts_with('-') && arg.parse::<f64>().is_err();
        if is_option {
            drop_value = PARENTS.contains(&arg.as_str());
        }
        if !drop_value {
            forwarded.push(arg.clone());
        }
    }
    forwarded
}

/// The direct solution's verdict on every solution; an empty one when it cannot be had.
fn judge(
    launcher: &Launcher,
    plan: &Plan,
    scene: &Path,
    solutions: Vec<(PathBuf, Vec<usize>)>,
) -> Result<Verdict> {
    let job = Job {
        scene: scene.to_path_buf(),
        result: launcher.workspace.file("verdict.json"),
        rtol: plan.rtol,
        inner: plan.inner,
        task: Task::Judge { solutions },
    };
    match launcher.run("judge", &job, plan.cores)?.record {
        Ok(text) => read(&text),
        Err(failure) => {
            eprintln!(
                "Warning: no direct solution, so no errors: {}",
                failure.message
            );
            Ok(Verdict::default())
        }
    }
}

fn read<T: serde::de::DeserializeOwned>(text: &str) -> Result<T> {
    serde_json::from_str(text)
        .map_err(|e| Error::environment(format!("a job has written an unreadable result: {e}")))
}

fn row(name: &str, run: &Run, outcome: std::result::Result<Outcome, String>) -> CompareRow {
    let blank = CompareRow {
        method: name.to_string(),
        subdomains: run.parts,
        ranks: run.ranks,
        threads: run.threads,
        ..CompareRow::default()
    };
    match outcome {
        Err(message) => CompareRow {
            message: Some(message),
            ..blank
        },
        Ok(o) => CompareRow {
            kappa: o.kappa,
            iterations: o.iterations,
            seconds: CompareSeconds {
                assemble: Some(o.assemble),
                setup: Some(o.setup),
                solve: Some(o.solve),
                total: Some(o.setup + o.solve),
            },
            memory_mb: Some(o.memory / 1e6),
            memory_at_start_mb: Some(o.memory_at_start / 1e6),
            residual: o.residual,
            contact: o.contact.map(|c| CompareContact {
                outer: c.steps,
                active: c.active.len(),
                ..CompareContact::default()
            }),
            rtol: o.rtol,
            converged: o.message.is_none(),
            converged_reason: o.reason,
            message: o.message,
            ..blank
        },
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
