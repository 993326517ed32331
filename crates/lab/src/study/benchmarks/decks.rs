//! `hueeber1` to `hueeber4` of Debian's package calculix-ccx-test: whole decks, as the program itself solves them,
//! beside CalculiX's printed displacements and, where `ccx` is installed, CalculiX itself.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use flate2::read::GzDecoder;
use std::io::Read;

use super::report::{MeasuredValue, MeshResult, MeshSeries};
use super::runner::Runner;
use crate::baselines::launch;
use base::{Error, Result};
use deck::{read_dat, DatTable};
use report::json::SolveReport;

/// Where the package puts its decks.
const DECKS: &str = "/usr/share/doc/calculix-ccx-test/examples/test";

/// The decks, and the largest permitted difference of their displacements.
const NUMBERS: [usize; 4] = [1, 2, 3, 4];
const LIMIT: f64 = 1e-3;

/// The decks, and why some of them or CalculiX did not run. On one rank only: the program starts others.
pub fn run(runner: &mut Runner) -> Result<(Vec<MeshSeries>, Vec<String>)> {
    let mut skipped = Vec::new();
    if runner.session.size() > 1 {
        skipped.push("it starts programs, which it does on one rank only".to_string());
        return Ok((Vec::new(), skipped));
    }
    let ccx = launch_ccx(Path::new("."), &["-v"]).is_some();
    if !ccx {
        skipped.push("`ccx` is not installed (package calculix-ccx): no times beside it".into());
    }
    let mut list = Vec::new();
    for k in NUMBERS {
        let name = format!("hueeber{k}");
        let packed =
            ["inp", "dat.ref"].map(|end| Path::new(DECKS).join(format!("{name}.{end}.gz")));
        if !packed.iter().all(|p| p.is_file()) {
            skipped.push(format!(
                "{name}: {} is missing (package calculix-ccx-test)",
                packed[0].display()
            ));
            continue;
        }
        (runner.progress)(&name);
        let [deck, printed] = packed.map(|p| unpacked(&p));
        let (deck, printed) = (deck?, printed?);
        report::output::write_text(&runner.dir.join(format!("{name}.inp")), &deck)?;
        let found = solve(runner, &name)?;
        let mut values = vec![MeasuredValue::error(
            "from the printed u",
            distance(&found.tables, &read_dat(&printed)),
        )
        .within(Some(LIMIT))];
        if ccx {
            values.extend(beside_ccx(runner, &name, &deck, &found)?);
        }
        let report = &found.report;
        list.push(MeshResult {
            mesh: name.clone(),
            size: 1.0,
            scene: format!("{name}.inp"),
            dofs: report.dofs,
            values,
            curve: Vec::new(),
            outer_iterations: report.outer_iterations,
            iterations: report.iterations.total,
            condition: report.condition.estimate.map(|s| s.kappa),
            kkt: Some(report.kkt.largest()),
            converged: true,
            seconds: found.seconds,
        });
    }
    Ok((vec![MeshSeries::new("CalculiX's decks", list)], skipped))
}

/// A deck, as the program solved it.
struct SolvedDeck {
    tables: Vec<DatTable>,
    report: SolveReport,
    /// Of the whole process.
    seconds: f64,
}

/// `fetifeti solve` in a process of its own.
fn solve(runner: &Runner, name: &str) -> Result<SolvedDeck> {
    let out = runner.dir.join(name);
    let json = out.join("report.json");
    let mut command = Command::new(launch::own()?);
    command
        .arg("solve")
        .arg(runner.dir.join(format!("{name}.inp")))
        .arg("--quiet")
        .arg("--out")
        .arg(&out);
    launch::without_mpi(&mut command);
    let clock = Instant::now();
    let done = command
        .stdin(Stdio::null())
        .output()
        .map_err(|e| Error::environment("the program cannot be started").because(e))?;
    let seconds = clock.elapsed().as_secs_f64();
    if !done.status.success() {
        let said = String::from_utf8_lossy(&done.stderr);
        return Err(Error::not_converged(format!("{name}: {}", said.trim())));
    }
    Ok(SolvedDeck {
        tables: read_dat(&text(&out.join(format!("{name}.dat")))?),
        report: launch::read(&text(&json)?)?,
        seconds,
    })
}

/// The seconds of CalculiX on the same deck beside ours.
fn beside_ccx(
    runner: &Runner,
    name: &str,
    deck: &str,
    found: &SolvedDeck,
) -> Result<Vec<MeasuredValue>> {
    let mut values = Vec::new();
    let times = if runner.quick { 1 } else { 3 };
    let mut theirs = Vec::new();
    let mut ours = vec![found.seconds];
    let write = |stem: &str, deck: &str| {
        report::output::write_text(&runner.dir.join(format!("{stem}.inp")), deck)
    };
    let job = format!("{name}-ccx");
    write(&job, deck)?;
    for k in 0..times {
        if k > 0 {
            ours.push(solve(runner, name)?.seconds);
        }
        theirs.extend(launch_ccx(runner.dir, &["-i", &job]));
    }
    if theirs.len() == times {
        let seconds = median(theirs);
        values.push(MeasuredValue {
            quantity: "seconds, ours and ccx".into(),
            ours: Some(median(ours)),
            reference: Some(seconds),
            error: 0.0,
            limit: None,
        });
    }
    Ok(values)
}

/// Runs `ccx` and returns its seconds; `None` where it is missing or fails.
fn launch_ccx(dir: &Path, args: &[&str]) -> Option<f64> {
    let mut command = Command::new("ccx");
    command
        .args(args)
        .current_dir(dir)
        .env("OMP_NUM_THREADS", "1");
    let clock = Instant::now();
    let done = command.stdin(Stdio::null()).output().ok()?;
    // `ccx -v` ends with another code than 0.
    (args == ["-v"] || done.status.success()).then(|| clock.elapsed().as_secs_f64())
}

/// The largest difference of a displacement, relative to the largest displacement of its table.
fn distance(ours: &[DatTable], theirs: &[DatTable]) -> f64 {
    let mut worst = 0.0_f64;
    for (a, b) in ours.iter().zip(theirs) {
        let size = b
            .rows
            .iter()
            .flat_map(|r| r.vector)
            .fold(0.0, |m: f64, x| m.max(x.abs()));
        for row in &b.rows {
            let Some(own) = a.rows.iter().find(|r| r.id == row.id) else {
                return f64::NAN;
            };
            for (x, y) in own.vector.iter().zip(row.vector) {
                worst = worst.max((x - y).abs() / size);
            }
        }
    }
    if ours.len() == theirs.len() && !theirs.is_empty() {
        worst
    } else {
        f64::NAN
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn text(path: &Path) -> Result<String> {
    std::fs::read_to_string(path)
        .map_err(|e| Error::environment(format!("cannot read {}", path.display())).because(e))
}

fn unpacked(path: &PathBuf) -> Result<String> {
    let refused = |e: std::io::Error| {
        Error::environment(format!("cannot read {}", path.display())).because(e)
    };
    let file = std::fs::File::open(path).map_err(refused)?;
    let mut bytes = Vec::new();
    GzDecoder::new(file)
        .read_to_end(&mut bytes)
        .map_err(refused)?;
    // Titles may have letters of another alphabet in another coding.
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
