//! `fetifeti study`: arguments and files; the studies themselves are in [`lab::study`].

use std::path::Path;
use std::time::Instant;

use clap::ValueEnum;

use super::args::{Study, StudyName};
use super::first_rank::on_first_rank;
use super::table1::ended;
use base::{Error, Result};
use fetifeti::settings::MethodSettings;
use lab::baselines::launch::Workspace;
use lab::study::{
    adaptive, benchmarks, hard_cases, hertz, kappa, scaling, speed_error, table1, walls,
};
use petsc::Session;
use report::destination::Destination;
use report::output;
use report::pace::left;
use report::tables::table::Table;

/// Runs a study and writes the results that the arguments ask for.
pub fn run(session: &Session, args: Study, petsc: &[String]) -> Result<()> {
    let name = args.name.to_possible_value().expect("no study is hidden");
    let task = StudyTask {
        session,
        name: name.get_name().to_string(),
        case: args.case,
        quick: args.quick,
        destination: args.results.into(),
    };
    on_first_rank(session, || task.destination.prepare())?;
    match args.name {
        StudyName::Adaptive => task.adaptive(),
        StudyName::Benchmarks => task.benchmarks(),
        StudyName::Hertz => task.hertz(),
        StudyName::HardCases => task.hard_cases(),
        StudyName::Kappa => task.kappa(),
        StudyName::Scaling => task.scaling(petsc),
        StudyName::SpeedError => task.speed_error(),
        StudyName::Table1 => task.table1(),
        StudyName::Walls => task.walls(),
    }
}

/// A study with its arguments.
struct StudyTask<'a> {
    session: &'a Session,
    name: String,
    /// The only case to run; `None`: all.
    case: Option<String>,
    quick: bool,
    destination: Destination,
}

impl StudyTask<'_> {
    fn hertz(&self) -> Result<()> {
        let report = hertz::run(self.session, self.quick, self.case(), &mut self.progress())?;
        self.finish(&report, &hertz::text(&report), |dir| {
            let mut files = tables(dir, &[("hertz", hertz::table(&report))])?;
            for case in &report.cases {
                let stem = format!("hertz_{}", case.case);
                hertz::figure(case).save(&dir.join(&stem))?;
                hertz::csv(case).write_csv(&dir.join(format!("{stem}.csv")))?;
                files.extend(["png", "svg", "csv"].map(|end| format!("{stem}.{end}")));
            }
            Ok(files)
        })?;
        match report.cases.iter().find(|c| !c.holds()) {
            None => Ok(()),
            Some(case) => Err(Error::not_converged(format!(
                "hertz, {}: half-width and peak are not within 2 % of the theory \
                 on the finest mesh, or do not come nearer to it",
                case.case
            ))),
        }
    }

    fn hard_cases(&self) -> Result<()> {
        let mut progress = self.progress();
        let report = hard_cases::run(self.session, self.quick, self.case(), &mut progress)?;
        self.finish(&report, &hard_cases::text(&report), |dir| {
            tables(dir, &[("hard-cases", hard_cases::table(&report))])
        })?;
        let wrong: Vec<&str> = report.wrong().map(|c| c.case.as_str()).collect();
        if wrong.is_empty() {
            return Ok(());
        }
        Err(Error::not_converged(format!(
            "hard-cases: wrong answers were called solutions: {}",
            wrong.join(", ")
        )))
    }

    fn adaptive(&self) -> Result<()> {
        let run = |dir: &Path| {
            let mut progress = self.progress();
            adaptive::run(self.session, self.quick, self.case(), dir, &mut progress)
        };
        let report = match &self.destination.out {
            Some(dir) => run(dir)?,
            // The user has not asked for the scenes: they go into a temporary directory.
            None => run(Workspace::new()?.dir())?,
        };
        self.finish(&report, &adaptive::text(&report), |dir| {
            let both = [
                ("adaptive", adaptive::table(&report)),
                ("adaptive-fine", adaptive::fine(&report)),
            ];
            let mut files = tables(dir, &both)?;
            files.extend(report.cases.iter().map(|c| format!("{}.toml", c.case)));
            Ok(files)
        })?;
        let failing = report.cases.iter().filter(|c| c.failing().count() > 0);
        let names: Vec<&str> = failing.map(|c| c.case.as_str()).collect();
        if names.is_empty() {
            return Ok(());
        }
        Err(Error::not_converged(format!(
            "adaptive: a bound is missed in {}",
            names.join(", ")
        )))
    }

    fn benchmarks(&self) -> Result<()> {
        let run = |dir: &Path| {
            let mut progress = self.progress();
            benchmarks::run(self.session, self.quick, self.case(), dir, &mut progress)
        };
        let report = match &self.destination.out {
            Some(dir) => run(dir)?,
            // The user has not asked for the scenes: they go into a temporary directory, on every rank its own.
            None => run(self.session.agree(Workspace::new())?.dir())?,
        };
        self.finish(&report, &benchmarks::text(&report), |dir| {
            let mut files = vec!["benchmarks.md".to_string()];
            output::write_text(&dir.join(&files[0]), &benchmarks::markdown(&report))?;
            for case in &report.cases {
                let stem = format!("benchmarks_{}", case.case);
                benchmarks::table(case).write_csv(&dir.join(format!("{stem}.csv")))?;
                files.push(format!("{stem}.csv"));
                if let Some(figure) = benchmarks::figure(case) {
                    figure.save(&dir.join(&stem))?;
                    files.extend(["png", "svg"].map(|end| format!("{stem}.{end}")));
                }
                files.extend(case.meshes().map(|m| m.scene.clone()));
            }
            Ok(files)
        })?;
        let missed = report.missed();
        if missed.is_empty() {
            return Ok(());
        }
        Err(Error::not_converged(format!(
            "benchmarks: tolerances are missed: {}",
            missed.join("; ")
        )))
    }

    fn kappa(&self) -> Result<()> {
        let exact = MethodSettings::default()
            .with_options(self.session)?
            .spectrum;
        let mut progress = self.progress();
        let report = kappa::run(self.session, self.quick, self.case(), exact, &mut progress)?;
        let all = [
            ("kappa", !report.rows.is_empty(), kappa::table(&report)),
            (
                "kappa-friction",
                !report.friction.is_empty(),
                kappa::friction::table(&report.friction),
            ),
        ];
        let shown = all.into_iter().filter(|(_, filled, _)| *filled);
        let shown: Vec<(&str, Table)> = shown.map(|(stem, _, table)| (stem, table)).collect();
        let texts: Vec<String> = shown.iter().map(|(_, table)| table.to_string()).collect();
        self.finish(&report, &texts.join("\n"), |dir| tables(dir, &shown))
    }

    fn scaling(&self, petsc: &[String]) -> Result<()> {
        let settings = scaling::ScalingSettings::from_options(self.session, self.quick, petsc)?;
        let mut progress = self.progress();
        let report = scaling::run(self.session, &settings, self.case(), &mut progress)?;
        self.finish(&report, &scaling::text(&report), |dir| {
            scaling::points_csv(&report).write_csv(&dir.join("scaling.csv"))?;
            scaling::prediction_csv(&report).write_csv(&dir.join("scaling-model.csv"))?;
            scaling::figure(&report).save(&dir.join("scaling"))?;
            scaling::model_figure(&report).save(&dir.join("scaling-model"))?;
            let files = ["scaling", "scaling-model"]
                .iter()
                .flat_map(|stem| ["csv", "png", "svg"].map(|end| format!("{stem}.{end}")));
            Ok(files.collect())
        })
    }

    fn speed_error(&self) -> Result<()> {
        let mut progress = self.progress();
        let report = speed_error::run(self.session, self.quick, self.case(), &mut progress)?;
        self.finish(&report, &speed_error::text(&report), |dir| {
            let mut files = tables(dir, &[("speed-error", speed_error::table(&report))])?;
            for case in &report.cases {
                let stem = format!("speed-error_{}", case.case);
                speed_error::figure(case).save(&dir.join(&stem))?;
                files.extend(["png", "svg"].map(|end| format!("{stem}.{end}")));
            }
            Ok(files)
        })
    }

    fn table1(&self) -> Result<()> {
        let rows = table1::rows(self.quick, self.case())?;
        let mut progress = self.progress();
        let report = table1::run(self.session, &rows, "study table1", &mut progress)?;
        let text = table1::table1(&report.rows).to_string();
        self.finish(&report, &text, |dir| table1::save(&report.rows, dir))?;
        ended(report.stopped)
    }

    fn walls(&self) -> Result<()> {
        let mut progress = self.progress();
        let report = walls::run(self.session, self.quick, self.case(), &mut progress)?;
        self.finish(&report, &walls::text(&report), |dir| {
            let mut files = tables(dir, &[("walls", walls::table(&report))])?;
            files.extend(walls::save(&report, dir)?);
            Ok(files)
        })?;
        match report.rows.iter().map(|r| r.unsolved().count()).sum() {
            0usize => Ok(()),
            n => Err(Error::not_converged(format!(
                "walls: number of scenes that were not solved: {n}"
            ))),
        }
    }

    fn case(&self) -> Option<&str> {
        self.case.as_deref()
    }

    /// Prints progress on rank 0, with what is left where the text begins with "3 of 10".
    fn progress(&self) -> impl FnMut(&str) + '_ {
        let start = Instant::now();
        move |what| {
            if self.session.rank() == 0 {
                let left = counted(what).and_then(|(k, n)| left(start.elapsed(), k - 1, n));
                let left = left.map_or(String::new(), |left| format!("; {left}"));
                let name = &self.name;
                self.destination.progress(&format!("{name}: {what}{left}"));
            }
        }
    }

    /// Prints and writes the results on rank 0; `more` writes tables and pictures into the directory and returns their
    /// names. Collective.
    fn finish<T: serde::Serialize>(
        &self,
        report: &T,
        text: &str,
        more: impl FnOnce(&Path) -> Result<Vec<String>>,
    ) -> Result<()> {
        on_first_rank(self.session, || {
            self.destination.progress("");
            self.destination.finish(&self.name, text, report, more)
        })
    }
}

/// The numbers of a text that begins with "3 of 10".
fn counted(text: &str) -> Option<(usize, usize)> {
    let (now, rest) = text.split_once(" of ")?;
    let all = rest.split(',').next()?;
    Some((now.parse().ok().filter(|&k| k > 0)?, all.parse().ok()?))
}

/// Writes tables as CSV; returns the names of the files.
fn tables(dir: &Path, tables: &[(&str, Table)]) -> Result<Vec<String>> {
    let write = |(stem, table): &(&str, Table)| {
        let name = format!("{stem}.csv");
        table.write_csv(&dir.join(&name)).map(|()| name)
    };
    tables.iter().map(write).collect()
}
