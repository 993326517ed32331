//! `study table1` and `fetifeti table1`: the experiment of Lee (2010), with the numbers of his Table 1 beside ours.
//!
//! Each row is solved in both columns, all of Γ and the middle third of every face, with M_D, the method of the paper,
//! and with M_C. Section 14 of `docs/theory.md` has the conventions.

mod figure;
pub mod paper;
mod record;
mod tables;

pub use figure::{figure, figure3};
pub use record::{PaperSide, PcResult, Table1Row, Table1Side};
pub use tables::{table1, table1_csv};

use std::path::Path;

use serde::{Deserialize, Serialize};

use base::{Error, Result};
use fetifeti::settings::{Adaptive, MergeKind, MethodSettings, PcType};
use fetifeti::solution::SetUpSummary;
use fetifeti::{FetiFeti, Status};
use petsc::Session;
use report::pace::Pace;
use scene::{distribution, fits, Faces, Scene};

/// Rows of the paper in the quick study: its first ones.
const QUICK: usize = 3;

/// The study.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Table1Report {
    /// "table1".
    pub study: String,
    /// The results by size.
    pub rows: Vec<Table1Row>,
    /// The first solve that stopped early; its row is there, and is no result.
    #[serde(skip)]
    pub stopped: Option<StoppedSolve>,
}

/// A solve that did not converge.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoppedSolve {
    /// The title of its scene.
    pub title: String,
    /// Why it stopped.
    pub status: Status,
    /// Its iterations.
    pub iterations: usize,
}

/// The rows of the study: those of the paper, its first ones, or the single one that is asked for.
///
/// # Errors
/// As [`row`].
pub fn rows(quick: bool, only: Option<&str>) -> Result<Vec<[usize; 3]>> {
    if let Some(text) = only {
        let no_case = |e| Error::input(format!("the study has no case \"{text}\"")).because(e);
        return row(text).map(|row| vec![row]).map_err(no_case);
    }
    let n = if quick { QUICK } else { usize::MAX };
    let printed = paper::table1().into_iter().take(n);
    Ok(printed
        .map(|r| [r.bodies, r.subdomains, r.elements])
        .collect())
}

/// Reads 1/H_b, H_b/H_s and H_s/h of a row, as in `2,4,2`.
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input) with what was expected.
pub fn row(text: &str) -> Result<[usize; 3]> {
    let counts: Option<Vec<usize>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
    match counts.as_deref() {
        Some(&[b, s, e]) if b >= 2 && s >= 1 && e >= 1 => Ok([b, s, e]),
        _ => Err(Error::input(
            "expected three counts of at least 1 (2 for the first) as in 2,4,2",
        )),
    }
}

/// Computes the rows; `argument` is what stands before a row on the command line, for messages about it. Collective.
///
/// # Errors
/// Those of the method, and a row that would not fit into the memory. A solve that stops early is no error.
pub fn run(
    session: &Session,
    rows: &[[usize; 3]],
    argument: &str,
    progress: &mut dyn FnMut(&str),
) -> Result<Table1Report> {
    let mut report = Table1Report {
        study: "table1".into(),
        ..Table1Report::default()
    };
    let mut pace = Pace::new(rows.len());
    for (done, &[bodies, subdomains, elements]) in rows.iter().enumerate() {
        progress(&format!("{done} of {} rows{}", rows.len(), pace.text()));
        let name = format!("{argument} {bodies},{subdomains},{elements}");
        let of_paper = paper::lookup(bodies, subdomains, elements);
        let mut side = |faces, paper: Option<PaperSide>| {
            let scene = fits::lee(session, &name, [bodies, subdomains, elements], faces);
            side(session, &session.agree(scene)?, paper, &mut report.stopped)
        };
        let row = Table1Row {
            bodies,
            subdomains,
            elements,
            whole_interface: side(Faces::Whole, of_paper.as_ref().map(|p| p.whole_interface))?,
            middle_third: side(
                Faces::MiddleThird,
                of_paper.as_ref().map(|p| p.middle_third),
            )?,
        };
        report.rows.push(row);
        pace.done();
    }
    Ok(report)
}

/// The results with M_D and M_C on one scene. Collective.
fn side(
    session: &Session,
    scene: &Scene,
    paper: Option<PaperSide>,
    stopped: &mut Option<StoppedSolve>,
) -> Result<Table1Side> {
    let mut run = |pc| -> Result<(SetUpSummary, PcResult)> {
        let substructures = distribution::substructures(session, scene)?;
        // The paper's method without additions.
        let settings = MethodSettings::default()
            .pc_type(pc)
            .merge(MergeKind::None)
            .adaptive(Adaptive::Off);
        let mut solver = FetiFeti::new(session, substructures, settings)?;
        let solution = solver.solve()?;
        if !solution.converged() {
            stopped.get_or_insert_with(|| StoppedSolve {
                title: scene.title.clone(),
                status: solution.status.clone(),
                iterations: solution.iterations,
            });
        }
        let exact = solver.spectrum()?;
        let result = PcResult {
            exact: exact.map(|s| s.kappa()),
            estimate: solution.estimate.map(|s| s.kappa()),
            lambda_min: exact.map(|s| s.lambda_min),
            lambda_max: exact.map(|s| s.lambda_max),
            iterations: solution.iterations,
        };
        Ok((solver.facts().clone(), result))
    };
    let (facts, dirichlet) = run(PcType::Dirichlet)?;
    let (_, coarse_corrected) = run(PcType::CoarseCorrected)?;
    Ok(Table1Side {
        multipliers: facts.multipliers_local + facts.multipliers_active,
        local_multipliers: facts.multipliers_local,
        floating_bodies: facts.floating_bodies,
        dirichlet,
        paper,
        coarse_corrected,
    })
}

/// Writes the table as CSV and the figure; returns the names of the files.
///
/// # Errors
/// A file that cannot be written.
pub fn save(rows: &[Table1Row], dir: &Path) -> Result<Vec<String>> {
    table1_csv(rows).write_csv(&dir.join("table1.csv"))?;
    figure3(rows, &dir.join("figure3"))?;
    Ok(["table1.csv", "figure3.png", "figure3.svg"]
        .map(String::from)
        .into())
}

#[cfg(test)]
#[path = "../../../tests/study/table1/rows.rs"]
mod tests;
