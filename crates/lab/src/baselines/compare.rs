//! `fetifeti compare`: every method once.

use std::path::PathBuf;
use std::time::Duration;

use mpi::point_to_point::{Destination as _, Source as _};
use mpi::traits::Communicator;

use super::launch::{Failure, Launcher, Workspace};
use super::methods::{facts, forwarded, judged, row, sentence, stopped, Methods, Ran};
use super::plan::{BaselinePlan, Layouts};
use super::table::BaselineCase;
use crate::baselines::table;
use base::Result;
use petsc::signals::Signals;
use petsc::{Options, Session};
use report::destination::Destination;
use report::json::CompareReport;
use report::tables::compare;
use scene::{distribution, Scene};

/// The arguments of a comparison: what is compared, and where the results go.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Comparison {
    /// The scene file.
    pub scene: PathBuf,
    /// Baselines to run beside ours; empty for all.
    pub with: Vec<String>,
    /// Where results go; the directory gets CSV and JSON.
    pub destination: Destination,
    /// PETSc's arguments, which are passed on to the jobs.
    pub petsc: Vec<String>,
}

/// Runs the comparison. Under mpirun only rank 0 starts jobs, the others wait. Collective.
///
/// Jobs are started with the running executable, which must be the `fetifeti` program.
///
/// # Errors
/// `Error::Input` for mistakes that are found before anything runs, and where the first job (ours) finds the problem
/// unsolvable; `Error::NotConverged` when ours does not converge; `Error::Environment` without mpirun. A baseline that
/// fails is no error but a row with a message.
pub fn compare(session: &Session, wanted: &Comparison) -> Result<()> {
    let scene = distribution::load(session, &wanted.scene)?;
    let baselines = session.agree(table::select(&wanted.with))?;
    let plan = BaselinePlan::new(session, &scene, &baselines, Layouts::Two)?;
    let all = Options::new(session, "");
    if all.has("help")? || all.has("h")? {
        for baseline in &baselines {
            baseline.set_options(session, plan.rtol, BaselineCase::of(session, &scene)?)?;
        }
    }
    on_first_rank(session, || run(session, wanted, &scene, &plan))
}

/// Does `work` on rank 0; the other ranks sleep until it is done, to leave the cores to the jobs. Collective.
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
fn run(session: &Session, wanted: &Comparison, scene: &Scene, plan: &BaselinePlan) -> Result<()> {
    let Comparison { destination, .. } = wanted;
    destination.prepare()?;
    // Temporary files go when a signal ends this.
    let _signals = Signals::watch();
    let progress = |what: &str| destination.progress(&format!("compare: {what}"));
    let launcher = Launcher {
        workspace: Workspace::new()?,
        limit: plan.limit,
        petsc: forwarded(&wanted.petsc),
        session: Some(session.clone()),
    };
    let file = std::fs::canonicalize(&wanted.scene).unwrap_or_else(|_| wanted.scene.clone());
    let mut methods = Methods::new(&launcher, plan, scene, file);
    let mut rows = Vec::new();
    // Numbers of the rows with a solution, and these solutions.
    let (mut solved, mut solutions) = (Vec::new(), Vec::new());
    for (k, run) in plan.runs.iter().enumerate() {
        progress(&run.title());
        let mut ran = methods.run(k, false)?;
        if !ran.printed.trim().is_empty() {
            destination.print(&format!("{}:\n{}\n", run.title(), ran.printed))?;
        }
        // If ours fails, there is a mistake in the scene or in this program, and the comparison ends.
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
    progress("direct solution");
    let verdict = methods.judge(solutions)?;
    sentence(&mut rows, |row| &mut row.run, solved, &verdict);
    destination.progress("");
    let mut report = CompareReport {
        facts: facts(scene, plan),
        cores: plan.cores,
        supports: methods.layout.loose(),
        rows,
    };
    judged(&mut report.facts, scene, &verdict);
    destination.finish("compare", &compare::text(&report), &report, |dir| {
        compare::csv(&report.rows).write_csv(&dir.join("compare.csv"))?;
        let mut written = vec!["compare.csv".into()];
        if let Some(steps) = compare::steps_csv(&report.rows) {
            steps.write_csv(&dir.join("compare_steps.csv"))?;
            written.push("compare_steps.csv".into());
        }
        Ok(written)
    })?;
    let rows = report.rows.iter();
    stopped(rows.map(|r| (&r.run, wanted.scene.display().to_string())))
}
