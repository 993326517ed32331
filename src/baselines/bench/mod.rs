//! `fetifeti bench`: speed against error, over several rounds.
//!
//! ```text
//!     round 1: ours, bddc, …, mumps, then the judge;   round 2: ours, bddc, …, mumps;   …
//! ```
//!
//! What else the machine does meets all methods alike, since they take turns. Errors are judged once, on the solutions of the first round; a method that
//! fails in some round is not run again.

mod cases;

use std::path::PathBuf;

use super::compare::{on_first_rank, prepare};
use super::launch::{Launcher, Workspace};
use super::methods::{forwarded, inequalities, row, sentence, Left, Methods, Ran};
use super::plan::{Layouts, Plan, Run};
use super::table::{self, Baseline};
use crate::cli::args::Bench;
use crate::petsc::{Options, Session};
use crate::report::json::{self, BenchCase, BenchReport, BenchRow, BenchSample, CompareRow};
use crate::report::output;
use crate::report::tables::bench as tables;
use crate::scene::{Numbering, Scene};
use crate::{Error, Result};
use cases::{Named, CASES};

/// A case that is to be run.
struct Case {
    name: String,
    /// Where the scene is; `None`: in `text` only.
    file: Option<PathBuf>,
    text: String,
    scene: Scene,
    plan: Plan,
}

/// Runs the benchmark. Under mpirun only rank 0 starts jobs, the others wait. Collective.
///
/// # Errors
/// [`Error::Input`] for what can be known before anything runs, and for a scene that ours finds unsolvable; [`Error::NotConverged`] at
/// the end where ours did not converge; [`Error::Environment`] without mpirun or disk. A baseline that fails is no error but a row with a message.
pub fn bench(session: &Session, args: &Bench, petsc: &[String]) -> Result<()> {
    if args.list {
        let said = match session.rank() {
            0 => output::print(&list()),
            _ => Ok(()),
        };
        return session.agree(said);
    }
    let baselines = session.agree(table::select(&args.with))?;
    let mut names = args.cases.clone();
    if names.is_empty() {
        names.extend(CASES.iter().map(|c| c.name.to_string()));
    }
    let cases: Result<Vec<Case>> = names
        .iter()
        .map(|name| Case::new(session, name, args.quick, &baselines))
        .collect();
    let cases = cases?;
    let ready = match session.rank() {
        0 => prepare(args.out.as_deref(), args.json.as_deref()),
        _ => Ok(()),
    };
    session.agree(ready)?;
    on_first_rank(session, || run(args, &cases, petsc))
}

/// The cases, a line each.
fn list() -> String {
    let width = CASES.iter().map(|c| c.name.len()).max().unwrap_or(0);
    let line = |c: &Named| format!("{:width$}  {}\n", c.name, c.description);
    CASES.iter().map(line).collect()
}

impl Case {
    /// A case by its name, or a scene file of the user. Collective.
    fn new(
        session: &Session,
        name: &str,
        quick: bool,
        baselines: &[&'static Baseline],
    ) -> Result<Case> {
        let read = || -> Result<(String, Option<PathBuf>, String, Scene)> {
            if let Some(named) = Named::find(name) {
                let text = named.scene(quick);
                let scene = Scene::parse(&format!("{name}.toml"), &text)?;
                return Ok((name.to_string(), None, text, scene));
            }
            let file = PathBuf::from(name);
            if !name.ends_with(".toml") && !file.is_file() {
                let known: Vec<&str> = CASES.iter().map(|c| c.name).collect();
                return Err(Error::input(format!(
                    "bench has no case \"{name}\", expected a scene file or some of {}",
                    known.join(", ")
                )));
            }
            let scene = Scene::load(&file)?;
            let stem = file.file_stem().map(|s| s.to_string_lossy().into_owned());
            let full = std::fs::canonicalize(&file).unwrap_or(file);
            let name = stem.unwrap_or_else(|| name.to_string());
            Ok((name, Some(full), String::new(), scene))
        };
        let (name, file, text, scene) = session.agree(read())?;
        // The options of a scene are for this scene only: the plan sees them, the next case does not.
        let options = Options::new(session, "");
        let mut set = Vec::new();
        for (option, value) in &scene.options {
            if options.set_default(option, value)? {
                set.push(option);
            }
        }
        let plan = Plan::new(session, &scene, baselines, Layouts::Three);
        for option in set {
            options.clear_value(option)?;
        }
        Ok(Case {
            name,
            file,
            text,
            scene,
            plan: plan?,
        })
    }
}

/// On rank 0: case by case, round by round.
fn run(args: &Bench, cases: &[Case], petsc: &[String]) -> Result<()> {
    let to_stdout = args.json.as_deref().is_some_and(output::is_stdout);
    let quiet = args.quiet || to_stdout;
    let mut report = BenchReport {
        schema: BenchReport::SCHEMA.into(),
        version: env!("CARGO_PKG_VERSION").into(),
        blas: blas(),
        cores: cases.first().map_or(1, |c| c.plan.cores),
        rounds: args.rounds,
        quick: args.quick,
        cases: Vec::new(),
    };
    for (k, case) in cases.iter().enumerate() {
        let launcher = Launcher {
            workspace: Workspace::new()?,
            limit: case.plan.limit,
            petsc: forwarded(petsc),
        };
        let file = match &case.file {
            Some(file) => file.clone(),
            None => {
                let file = launcher.workspace.file(&format!("{}.toml", case.name));
                output::write_text(&file, &case.text)?;
                file
            }
        };
        let mut methods = Methods::new(&launcher, &case.plan, &case.scene, file);
        methods.again = true;
        report.cases.push(blank(case));
        let mut sequence = 0;
        for round in 1..=args.rounds {
            let now = &mut report.cases[k];
            let first = one_round(args, quiet, case, &mut methods, now, (round, &mut sequence))?;
            if round == 1 {
                progress(args, &format!("{}, direct solution", case.name));
                let (numbers, solutions): (Vec<usize>, Vec<_>) = first.into_iter().unzip();
                let verdict = methods.judge(solutions)?;
                now.reference_residual = verdict.reference.and_then(|r| r.residual);
                now.contact = inequalities(&case.scene, &verdict);
                for (k, judgement) in numbers.into_iter().zip(&verdict.solutions) {
                    let row = &mut now.methods[k];
                    let mut judged = CompareRow {
                        contact: row.contact,
                        ..CompareRow::default()
                    };
                    sentence(&mut judged, judgement);
                    (row.error, row.residual) = (judged.error, judged.residual);
                    row.contact = judged.contact;
                }
            }
            now.rounds = round;
            now.sum_up();
            // A long run that is ended from outside leaves what it has.
            if !to_stdout {
                write_json(args, &report)?;
            }
        }
    }
    write(args, cases, &report, quiet)?;
    let stopped = report.cases.iter().flat_map(|c| {
        let rows = c.methods.iter();
        rows.filter(|r| r.is_ours() && !r.converged_reason.starts_with("CONVERGED"))
            .map(move |r| (c, r))
    });
    match stopped.into_iter().next() {
        None => Ok(()),
        Some((case, row)) => Err(Error::NotConverged(format!(
            "fetifeti on {}: {}",
            case.case,
            row.message.as_deref().unwrap_or(&row.converged_reason)
        ))),
    }
}

/// Runs every method that has not failed so far. Returns the numbers of those that have left a solution, with the solutions and their active
/// sets.
fn one_round(
    args: &Bench,
    quiet: bool,
    case: &Case,
    methods: &mut Methods,
    now: &mut BenchCase,
    (round, sequence): (usize, &mut usize),
) -> Result<Vec<(usize, Left)>> {
    let mut solutions = Vec::new();
    for (k, run) in case.plan.runs.iter().enumerate() {
        let known = &now.methods[k];
        if known.message.is_some() {
            continue;
        }
        let mut ran = methods.run(k, known.rescue.is_some())?;
        *sequence += 1;
        let title = format!("{} ({})", run.title(), run.layout);
        if !quiet && !ran.printed.trim().is_empty() {
            output::print(&format!("{title}:\n{}\n", ran.printed))?;
        }
        match &ran.outcome {
            // A mistake in the scene is one for every method.
            Err(failure) if run.baseline.is_none() && failure.code == Some(2) => {
                return Err(failure.clone().into_error());
            }
            _ => {}
        }
        if let Some(solution) = ran.solution.take() {
            solutions.push((k, solution));
        }
        let sample = sample(&ran, round, *sequence);
        let seconds = match (sample.setup, sample.solve) {
            (Some(setup), Some(solve)) => format!("{setup:.3} s + {solve:.3} s"),
            _ => "failed".to_string(),
        };
        let of = format!("round {round} of {}", args.rounds);
        progress(args, &format!("{}, {of}, {title}: {seconds}", case.name));
        record(&mut now.methods[k], row(run, ran), sample);
    }
    Ok(solutions)
}

/// A case before its first round.
fn blank(case: &Case) -> BenchCase {
    let row = |run: &Run| BenchRow {
        method: run.name().into(),
        layout: run.layout.into(),
        subdomains: run.parts,
        ranks: run.ranks,
        threads: run.threads,
        ..BenchRow::default()
    };
    BenchCase {
        case: case.name.clone(),
        scene: case.scene.title.clone(),
        bodies: case.scene.n_bodies(),
        subdomains: case.scene.n_subdomains(),
        dofs: Numbering::new(&case.scene).len() as usize,
        rtol: case.plan.rtol,
        rounds: 0,
        reference_residual: None,
        contact: None,
        methods: case.plan.runs.iter().map(row).collect(),
    }
}

/// The seconds and megabytes of one run.
fn sample(ran: &Ran, round: usize, sequence: usize) -> BenchSample {
    let blank = BenchSample {
        round,
        sequence,
        ..BenchSample::default()
    };
    let Ok(o) = &ran.outcome else {
        return blank;
    };
    BenchSample {
        assemble: Some(o.assemble),
        setup: Some(o.setup),
        solve: Some(o.solve),
        recover: o.recover,
        total: Some(o.setup + o.solve),
        again: o.again,
        outer: o.contact.as_ref().and_then(|c| c.steps),
        iterations: o.iterations,
        memory_mb: Some(o.memory / 1e6),
        memory_at_start_mb: Some(o.memory_at_start / 1e6),
        converged: o.message.is_none(),
        ..blank
    }
}

/// Enters a run into its row: what does not change from round to round is that of the first one, unless a later one fails.
fn record(row: &mut BenchRow, ran: CompareRow, sample: BenchSample) {
    if sample.round == 1 {
        row.kappa = ran.kappa;
        row.iterations = ran.iterations;
        row.residual = ran.residual;
        row.contact = ran.contact;
        row.rtol = ran.rtol;
        row.rescue = ran.rescue;
    }
    row.converged = ran.converged;
    row.converged_reason = ran.converged_reason;
    let several = |m: String| format!("round {}: {m}", sample.round);
    row.message = ran.message.map(several);
    row.samples.push(sample);
}

/// The file of this process's BLAS: jobs are the same program and load the same one.
fn blas() -> Option<String> {
    let maps = std::fs::read_to_string("/proc/self/maps").ok()?;
    let mut files = maps.lines().filter_map(|l| l.split_whitespace().nth(5));
    let is_blas = |file: &str| {
        let name = file.rsplit('/').next().unwrap_or(file);
        name.starts_with("lib") && name.contains("blas") && name.contains(".so")
    };
    files.find(|f| is_blas(f)).map(String::from)
}

/// A line on stderr for every run.
fn progress(args: &Bench, what: &str) {
    if !args.quiet {
        eprintln!("bench: {what}");
    }
}

fn write_json(args: &Bench, report: &BenchReport) -> Result<()> {
    if let Some(file) = &args.json {
        json::write(file, report)?;
    }
    if let Some(dir) = &args.out {
        json::write(&dir.join("bench.json"), report)?;
    }
    Ok(())
}

fn write(args: &Bench, cases: &[Case], report: &BenchReport, quiet: bool) -> Result<()> {
    if !quiet {
        output::print(&tables::text(report))?;
    }
    write_json(args, report)?;
    let Some(dir) = &args.out else {
        return Ok(());
    };
    tables::csv(report).write_csv(&dir.join("bench.csv"))?;
    tables::figure(report).save(&dir.join("bench"))?;
    let mut files = ["json", "csv", "png", "svg"]
        .map(|end| format!("bench.{end}"))
        .to_vec();
    for case in cases.iter().filter(|c| c.file.is_none()) {
        let name = format!("{}.toml", case.name);
        output::write_text(&dir.join(&name), &case.text)?;
        files.push(name);
    }
    if !quiet {
        let list = files.join(", ");
        output::print(&format!("written: {list} in {}\n", dir.display()))?;
    }
    Ok(())
}
