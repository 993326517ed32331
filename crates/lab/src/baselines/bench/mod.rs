//! `fetifeti bench`: speed against error, over several rounds.
//!
//! ```text
//!     round 1: ours, bddc, …, mumps, then the judge;   round 2: ours, bddc, …, mumps;   …
//! ```
//!
//! The methods take turns, so that other load on the machine affects all of them alike. Errors are measured once, on
//! the solutions of the first round. A method that fails in one round is not run again.

mod cases;
mod shapes;
mod unstructured;

use std::path::PathBuf;

use super::compare::on_first_rank;
use super::launch::{interrupted, Launcher, Workspace};
use super::methods::{facts, forwarded, judged, row, sentence, stopped, Left, Methods, Ran};
use super::plan::{BaselinePlan, Layouts};
use super::table::Baseline;
use crate::baselines::methods;
use crate::baselines::table;
use base::{Error, Result};
use cases::{NamedScene, CASES};
use petsc::signals::Signals;
use petsc::Session;
use report::destination::Destination;
use report::json::{BenchCase, BenchReport, BenchRow, BenchSample, MethodRun};
use report::output;
use report::pace::Pace;
use report::tables::bench as tables;
use scene::{distribution, fits, Scene};

/// The arguments of a benchmark: what is run, and where the results go.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Benchmark {
    /// Names of cases, or scene files; empty for all cases.
    pub cases: Vec<String>,
    /// How often every method is run.
    pub rounds: usize,
    /// Baselines to run beside ours; empty for all.
    pub with: Vec<String>,
    /// Smaller cases.
    pub quick: bool,
    /// Where results go; the directory gets tables, a picture and scenes. If the destination is quiet, no progress is
    /// printed either.
    pub destination: Destination,
    /// PETSc's arguments, which are passed on to the jobs.
    pub petsc: Vec<String>,
}

/// The directory of a named case and its files.
type CaseFiles = (Workspace, Vec<String>);

/// A case of this benchmark.
struct BenchInput {
    name: String,
    /// The scene file.
    file: PathBuf,
    /// It lives as long as the case; `None` for a file of the user.
    home: Option<CaseFiles>,
    scene: Scene,
    plan: BaselinePlan,
}

/// Runs the benchmark. Under mpirun only rank 0 starts jobs, the others wait. Collective.
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input) for mistakes that are found before anything runs, and for a scene that
/// ours finds unsolvable; [`ErrorKind::NotConverged`](base::ErrorKind::NotConverged) at the end where ours did not
/// converge; [`ErrorKind::Environment`](base::ErrorKind::Environment) without mpirun or disk. A baseline that fails is
/// no error but a row with a message.
pub fn bench(session: &Session, wanted: &Benchmark) -> Result<()> {
    let baselines = session.agree(table::select(&wanted.with))?;
    let mut names = wanted.cases.clone();
    if names.is_empty() {
        names.extend(CASES.iter().map(|c| c.name.to_string()));
    }
    // Files of cases go when a signal ends this.
    let _signals = Signals::watch();
    let cases: Result<Vec<BenchInput>> = names
        .iter()
        .map(|name| {
            session.agree(interrupted())?;
            BenchInput::new(session, name, wanted.quick, &baselines)
        })
        .collect();
    let cases = cases?;
    on_first_rank(session, || run(session, wanted, &cases))
}

/// The cases, one line each.
pub fn cases() -> String {
    let width = CASES.iter().map(|c| c.name.len()).max().unwrap_or(0);
    let line = |c: &NamedScene| format!("{:width$}  {}\n", c.name, c.description);
    CASES.iter().map(line).collect()
}

impl BenchInput {
    /// A case by its name, or a scene file of the user. Collective.
    fn new(
        session: &Session,
        name: &str,
        quick: bool,
        baselines: &[&'static Baseline],
    ) -> Result<BenchInput> {
        // Every process writes files of its own.
        let read = || -> Result<(String, PathBuf, Option<CaseFiles>, Scene)> {
            if let Some(named) = NamedScene::find(name) {
                let home = Workspace::new()?;
                let (file, names) = named.write(home.dir(), quick)?;
                let scene = fits::load(session, &file)?;
                return Ok((name.to_string(), file, Some((home, names)), scene));
            }
            let file = PathBuf::from(name);
            if !name.ends_with(".toml") && !file.is_file() {
                let known: Vec<&str> = CASES.iter().map(|c| c.name).collect();
                return Err(Error::input(format!(
                    "bench has no case \"{name}\", expected a scene file or some of {}",
                    known.join(", ")
                )));
            }
            let scene = fits::load(session, &file)?;
            let stem = file.file_stem().map(|s| s.to_string_lossy().into_owned());
            let full = std::fs::canonicalize(&file).unwrap_or(file);
            let name = stem.unwrap_or_else(|| name.to_string());
            Ok((name, full, None, scene))
        };
        let (name, file, home, scene) = session.agree(read())?;
        let plan = distribution::with_options(session, &scene.options, || {
            BaselinePlan::new(session, &scene, baselines, Layouts::Three)
        })?;
        Ok(BenchInput {
            name,
            file,
            home,
            scene,
            plan,
        })
    }
}

/// On rank 0: case by case, round by round.
fn run(session: &Session, wanted: &Benchmark, cases: &[BenchInput]) -> Result<()> {
    let Benchmark { destination, .. } = wanted;
    destination.prepare()?;
    let mut report = BenchReport {
        schema: BenchReport::SCHEMA.into(),
        version: env!("CARGO_PKG_VERSION").into(),
        blas: blas(),
        cores: cases.first().map_or(1, |c| c.plan.cores),
        rounds: wanted.rounds,
        quick: wanted.quick,
        cases: Vec::new(),
    };
    let done = rounds(session, wanted, cases, &mut report);
    if let (Err(error), Some(_)) = (&done, Signals::noted()) {
        // The results so far are results.
        write(destination, cases, &report)?;
        return Err(error.clone());
    }
    done?;
    write(destination, cases, &report)?;
    let cases = report.cases.iter();
    stopped(cases.flat_map(|c| c.methods.iter().map(|r| (&r.run, c.case.clone()))))
}

/// All rounds of all cases, into the report as they come.
fn rounds(
    session: &Session,
    wanted: &Benchmark,
    cases: &[BenchInput],
    report: &mut BenchReport,
) -> Result<()> {
    let Benchmark { destination, .. } = wanted;
    let each = cases.iter().map(|c| wanted.rounds * c.plan.runs.len());
    let mut pace = Pace::new(each.sum());
    for (k, case) in cases.iter().enumerate() {
        let launcher = Launcher {
            workspace: Workspace::new()?,
            limit: case.plan.limit,
            petsc: forwarded(&wanted.petsc),
            session: Some(session.clone()),
        };
        let mut methods = Methods::new(&launcher, &case.plan, &case.scene, case.file.clone());
        methods.again = true;
        report.cases.push(blank(case));
        let mut sequence = 0;
        for round in 1..=wanted.rounds {
            let now = &mut report.cases[k];
            let first = one_round(
                wanted,
                case,
                &mut methods,
                now,
                (round, &mut sequence),
                &mut pace,
            );
            now.rounds = round - 1;
            now.sum_up();
            let first = first?;
            if round == 1 {
                progress(wanted, &format!("{}, direct solution", case.name));
                let (numbers, solutions): (Vec<usize>, Vec<_>) = first.into_iter().unzip();
                let verdict = methods.judge(solutions)?;
                judged(&mut now.facts, &case.scene, &verdict);
                sentence(&mut now.methods, |row| &mut row.run, numbers, &verdict);
            }
            now.rounds = round;
            now.sum_up();
            // Results are written as they come: a long run that is interrupted keeps them.
            if !destination.json_on_stdout() {
                destination.write_json("bench.json", report)?;
            }
        }
    }
    Ok(())
}

/// Runs every method that has not failed so far. Returns the numbers of the methods that have left a solution, with the
/// solutions and their active sets.
fn one_round(
    wanted: &Benchmark,
    case: &BenchInput,
    methods: &mut Methods,
    now: &mut BenchCase,
    (round, sequence): (usize, &mut usize),
    pace: &mut Pace,
) -> Result<Vec<(usize, Left)>> {
    let mut solutions = Vec::new();
    for (k, run) in case.plan.runs.iter().enumerate() {
        let known = &now.methods[k].run;
        if known.message.is_some() {
            pace.skip();
            continue;
        }
        let mut ran = methods.run(k, known.rescue.is_some())?;
        *sequence += 1;
        let title = format!("{} ({})", run.title(), run.layout);
        if !ran.printed.trim().is_empty() {
            wanted
                .destination
                .print(&format!("{title}:\n{}\n", ran.printed))?;
        }
        match &ran.outcome {
            // A mistake in the scene concerns every method.
            Err(failure) if run.baseline.is_none() && failure.code == Some(2) => {
                return Err(failure.clone().into_error());
            }
            _ => {}
        }
        if let Some(solution) = ran.solution.take() {
            solutions.push((k, solution));
        }
        let sample = sample(&ran, round, *sequence);
        let seconds = match (sample.seconds.setup, sample.seconds.solve) {
            (Some(setup), Some(solve)) => format!("{setup:.3} s + {solve:.3} s"),
            _ => "failed".to_string(),
        };
        let of = format!("round {round} of {}", wanted.rounds);
        pace.done();
        let left = pace.text();
        progress(
            wanted,
            &format!("{}, {of}, {title}: {seconds}{left}", case.name),
        );
        record(&mut now.methods[k], row(run, ran).run, sample);
    }
    Ok(solutions)
}

/// The record of a case before its first round.
fn blank(case: &BenchInput) -> BenchCase {
    let rows = case.plan.runs.iter().map(|run| BenchRow {
        run: methods::blank(run),
        ..BenchRow::default()
    });
    BenchCase {
        case: case.name.clone(),
        facts: facts(&case.scene, &case.plan),
        rounds: 0,
        methods: rows.collect(),
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
        seconds: methods::seconds(o),
        recover: o.recover,
        again: o.again,
        outer: o.contact.as_ref().and_then(|c| c.steps),
        iterations: o.iterations,
        memory_mb: Some(o.memory / 1e6),
        memory_at_start_mb: Some(o.memory_at_start / 1e6),
        converged: o.message.is_none(),
        ..blank
    }
}

/// Enters a run into its row. Facts that do not change from round to round are those of the first round, unless a later
/// round fails.
fn record(row: &mut BenchRow, ran: MethodRun, sample: BenchSample) {
    let known = std::mem::take(&mut row.run);
    let message = ran.message.clone();
    row.run = match sample.round {
        1 => ran,
        _ => MethodRun {
            converged: ran.converged,
            converged_reason: ran.converged_reason,
            ..known
        },
    };
    row.run.message = message.map(|m| format!("round {}: {m}", sample.round));
    row.samples.push(sample);
}

/// The file of the BLAS of this process. Jobs run the same program and load the same BLAS.
fn blas() -> Option<String> {
    let maps = std::fs::read_to_string("/proc/self/maps").ok()?;
    let mut files = maps.lines().filter_map(|l| l.split_whitespace().nth(5));
    let is_blas = |file: &str| {
        let name = file.rsplit('/').next().unwrap_or(file);
        name.starts_with("lib") && name.contains("blas") && name.contains(".so")
    };
    files.find(|f| is_blas(f)).map(String::from)
}

/// Prints a line on stderr for every run.
fn progress(wanted: &Benchmark, what: &str) {
    if !wanted.destination.quiet {
        eprintln!("bench: {what}");
    }
}

fn write(destination: &Destination, cases: &[BenchInput], report: &BenchReport) -> Result<()> {
    destination.finish("bench", &tables::text(report), report, |dir| {
        tables::csv(report).write_csv(&dir.join("bench.csv"))?;
        tables::figure(report).save(&dir.join("bench"))?;
        let mut files = ["csv", "png", "svg"]
            .map(|end| format!("bench.{end}"))
            .to_vec();
        // Copies: to make a mesh of a million nodes again takes seconds.
        for (home, names) in cases.iter().filter_map(|c| c.home.as_ref()) {
            for name in names {
                let bytes = std::fs::read(home.file(name))
                    .map_err(|e| Error::environment(format!("cannot read {name}")).because(e))?;
                output::write_file(&dir.join(name), |out| out.write_all(&bytes))?;
            }
            files.extend_from_slice(names);
        }
        Ok(files)
    })
}
