//! `fetifeti study`: arguments and files; the studies themselves are in [`crate::study`].

use std::path::Path;

use super::args::{Study, StudyName};
use super::solve::prepare;
use crate::feti::MethodSettings;
use crate::petsc::Session;
use crate::report::{json, output};
use crate::study::{adaptive, hard_cases, hertz, kappa, kernels, scaling, speed_error};
use crate::{Error, Result};

/// Runs a study and writes what was asked for.
pub fn run(session: &Session, args: &Study, petsc: &[String]) -> Result<()> {
    prepare(session, args.out.as_deref(), args.json.as_deref())?;
    match args.name {
        StudyName::Adaptive => run_adaptive(session, args),
        StudyName::Hertz => run_hertz(session, args),
        StudyName::HardCases => run_hard_cases(session, args),
        StudyName::Kappa => run_kappa(session, args),
        StudyName::Scaling => run_scaling(session, args, petsc),
        StudyName::Kernels => run_kernels(session, args),
        StudyName::SpeedError => run_speed_error(session, args),
    }
}

fn run_hertz(session: &Session, args: &Study) -> Result<()> {
    let report = hertz::run(session, args.quick, args.case.as_deref(), &mut |what| {
        progress(session, args, what)
    })?;
    progress(session, args, "");
    let write = |dir: &Path| -> Result<Vec<String>> {
        let mut files = vec!["hertz.csv".to_string()];
        hertz::table(&report).write_csv(&dir.join("hertz.csv"))?;
        for case in &report.cases {
            let stem = format!("hertz_{}", case.case);
            hertz::figure(case).save(&dir.join(&stem))?;
            hertz::csv(case).write_csv(&dir.join(format!("{stem}.csv")))?;
            files.extend(["png", "svg", "csv"].map(|end| format!("{stem}.{end}")));
        }
        Ok(files)
    };
    finish(session, args, &report, &hertz::text(&report), write)?;
    match report.cases.iter().find(|c| !c.holds()) {
        None => Ok(()),
        Some(case) => Err(Error::NotConverged(format!(
            "hertz, {}: half-width and peak are not within 2 % of the theory on the finest mesh, or do not come nearer to it",
            case.case
        ))),
    }
}

fn run_hard_cases(session: &Session, args: &Study) -> Result<()> {
    let report = hard_cases::run(session, args.quick, args.case.as_deref(), &mut |what| {
        progress(session, args, what)
    })?;
    progress(session, args, "");
    let write = |dir: &Path| -> Result<Vec<String>> {
        hard_cases::table(&report).write_csv(&dir.join("hard-cases.csv"))?;
        Ok(vec!["hard-cases.csv".to_string()])
    };
    finish(session, args, &report, &hard_cases::text(&report), write)?;
    let wrong: Vec<&str> = report.wrong().map(|c| c.case.as_str()).collect();
    if wrong.is_empty() {
        return Ok(());
    }
    Err(Error::NotConverged(format!(
        "hard-cases: wrong answers were called solutions: {}",
        wrong.join(", ")
    )))
}

fn run_adaptive(session: &Session, args: &Study) -> Result<()> {
    let only = args.case.as_deref();
    let mut tell = |what: &str| progress(session, args, what);
    let report = match &args.out {
        Some(dir) => adaptive::run(session, args.quick, only, dir, &mut tell)?,
        None => {
            let scratch = Scratch::new("adaptive")?;
            adaptive::run(session, args.quick, only, &scratch.0, &mut tell)?
        }
    };
    progress(session, args, "");
    let write = |dir: &Path| -> Result<Vec<String>> {
        adaptive::table(&report).write_csv(&dir.join("adaptive.csv"))?;
        adaptive::fine(&report).write_csv(&dir.join("adaptive-fine.csv"))?;
        let tables = ["adaptive", "adaptive-fine"].map(|t| format!("{t}.csv"));
        let scenes = report.cases.iter().map(|c| format!("{}.toml", c.case));
        Ok(tables.into_iter().chain(scenes).collect())
    };
    finish(session, args, &report, &adaptive::text(&report), write)?;
    let failing = report.cases.iter().filter(|c| c.failing().count() > 0);
    let names: Vec<&str> = failing.map(|c| c.case.as_str()).collect();
    if names.is_empty() {
        return Ok(());
    }
    Err(Error::NotConverged(format!(
        "adaptive: a bound is missed in {}",
        names.join(", ")
    )))
}

/// A directory of this process for scenes that nobody asked for; it goes away with the value.
struct Scratch(std::path::PathBuf);

impl Scratch {
    fn new(name: &str) -> Result<Scratch> {
        let name = format!("fetifeti-study-{name}-{}", std::process::id());
        let dir = std::env::temp_dir().join(name);
        output::prepare_directory(&dir)?;
        Ok(Scratch(dir))
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // What cannot be removed stays in the system's directory for temporary files.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn run_kappa(session: &Session, args: &Study) -> Result<()> {
    let exact = MethodSettings::default().with_options(session)?.spectrum;
    let only = args.case.as_deref();
    let report = kappa::run(session, args.quick, only, exact, &mut |what| {
        progress(session, args, what)
    })?;
    progress(session, args, "");
    let table = kappa::table(&report);
    let write = |dir: &Path| -> Result<Vec<String>> {
        table.write_csv(&dir.join("kappa.csv"))?;
        Ok(vec!["kappa.csv".to_string()])
    };
    finish(session, args, &report, &table.to_string(), write)
}

fn run_scaling(session: &Session, args: &Study, petsc: &[String]) -> Result<()> {
    let settings = scaling::Settings::from_options(session, args.quick, petsc)?;
    let report = scaling::run(session, &settings, args.case.as_deref(), &mut |what| {
        progress(session, args, what)
    })?;
    progress(session, args, "");
    let write = |dir: &Path| -> Result<Vec<String>> {
        scaling::points_csv(&report).write_csv(&dir.join("scaling.csv"))?;
        scaling::prediction_csv(&report).write_csv(&dir.join("scaling-model.csv"))?;
        scaling::figure(&report).save(&dir.join("scaling"))?;
        scaling::model_figure(&report).save(&dir.join("scaling-model"))?;
        let files = ["scaling", "scaling-model"]
            .iter()
            .flat_map(|stem| ["csv", "png", "svg"].map(|end| format!("{stem}.{end}")));
        Ok(files.collect())
    };
    finish(session, args, &report, &scaling::text(&report), write)
}

fn run_kernels(session: &Session, args: &Study) -> Result<()> {
    let report = kernels::run(session, args.quick, args.case.as_deref(), &mut |what| {
        progress(session, args, what)
    })?;
    progress(session, args, "");
    let write = |dir: &Path| -> Result<Vec<String>> {
        kernels::table(&report).write_csv(&dir.join("kernels.csv"))?;
        kernels::summary(&report).write_csv(&dir.join("kernels-summary.csv"))?;
        Ok(["kernels", "kernels-summary"]
            .map(|t| format!("{t}.csv"))
            .into())
    };
    finish(session, args, &report, &kernels::text(&report), write)
}

fn run_speed_error(session: &Session, args: &Study) -> Result<()> {
    let report = speed_error::run(session, args.quick, args.case.as_deref(), &mut |what| {
        progress(session, args, what)
    })?;
    progress(session, args, "");
    let write = |dir: &Path| -> Result<Vec<String>> {
        speed_error::table(&report).write_csv(&dir.join("speed-error.csv"))?;
        let mut files = vec!["speed-error.csv".to_string()];
        for case in &report.cases {
            let stem = format!("speed-error_{}", case.case);
            speed_error::figure(case).save(&dir.join(&stem))?;
            files.extend(["png", "svg"].map(|end| format!("{stem}.{end}")));
        }
        Ok(files)
    };
    finish(session, args, &report, &speed_error::text(&report), write)
}

/// Prints and writes on rank 0; `write` puts tables and pictures into the directory and says which. Collective.
fn finish<T: serde::Serialize>(
    session: &Session,
    args: &Study,
    report: &T,
    text: &str,
    write: impl FnOnce(&Path) -> Result<Vec<String>>,
) -> Result<()> {
    let name = args.name.name();
    let all = || -> Result<()> {
        let quiet = args.quiet || args.json.as_deref().is_some_and(output::is_stdout);
        if !quiet {
            output::print(text)?;
        }
        if let Some(file) = &args.json {
            json::write(file, report)?;
        }
        if let Some(dir) = &args.out {
            let json = format!("{name}.json");
            json::write(&dir.join(&json), report)?;
            let mut files = vec![json];
            files.extend(write(dir)?);
            if !quiet {
                let list = files.join(", ");
                output::print(&format!("written: {list} in {}\n", dir.display()))?;
            }
        }
        Ok(())
    };
    session.agree(if session.rank() == 0 { all() } else { Ok(()) })
}

/// One line on stderr that overwrites itself, on a terminal only.
fn progress(session: &Session, args: &Study, what: &str) {
    use std::io::IsTerminal;
    if session.rank() == 0 && !args.quiet && std::io::stderr().is_terminal() {
        let text = match what {
            "" => String::new(),
            what => format!("{}: {what}", args.name.name()),
        };
        eprint!("\r\x1b[K{text}");
    }
}
