//! `fetifeti table1`: Lee's experiment, with his numbers and ours.

use super::args::Table1;
use super::first_rank::on_first_rank;
use super::solve::not_converged;
use base::{Error, Result};
use fetifeti::settings::{Adaptive, MethodSettings, PcType};
use fetifeti::solution::SetUpSummary;
use fetifeti::FetiFeti;
use petsc::Session;
use report::destination::Destination;
use report::json::{PaperSide, PcResult, Table1Row, Table1Side};
use report::pace::Pace;
use report::plots::figure3;
use report::tables::{paper, summary};
use scene::{distribution, fits, Faces, Scene};

/// Computes the rows and writes the results that the arguments ask for.
pub fn run(session: &Session, args: Table1) -> Result<()> {
    let destination = Destination::from(args.results);
    on_first_rank(session, || destination.prepare())?;
    let wanted: Vec<[usize; 3]> = if args.rows.is_empty() {
        paper::table1()
            .iter()
            .map(|r| [r.bodies, r.subdomains, r.elements])
            .collect()
    } else {
        args.rows
    };
    let mut rows = Vec::with_capacity(wanted.len());
    let mut stopped = None;
    let mut pace = Pace::new(wanted.len());
    for (done, &[bodies, subdomains, elements]) in wanted.iter().enumerate() {
        if session.rank() == 0 {
            let left = pace.text();
            destination.progress(&format!("table1: {done} of {} rows{left}", wanted.len()));
        }
        let of_paper = paper::lookup(bodies, subdomains, elements);
        let mut side = |faces, paper: Option<PaperSide>| {
            let scene = session.agree(fits::lee(session, [bodies, subdomains, elements], faces))?;
            side(session, &scene, paper, &mut stopped)
        };
        rows.push(Table1Row {
            bodies,
            subdomains,
            elements,
            whole_interface: side(Faces::Whole, of_paper.as_ref().map(|p| p.whole_interface))?,
            middle_third: side(
                Faces::MiddleThird,
                of_paper.as_ref().map(|p| p.middle_third),
            )?,
        });
        pace.done();
    }
    on_first_rank(session, || {
        destination.progress("");
        let text = summary::table1(&rows).to_string();
        destination.finish("table1", &text, &rows, |dir| {
            summary::table1_csv(&rows).write_csv(&dir.join("table1.csv"))?;
            figure3::figure3(&rows, &dir.join("figure3"))?;
            Ok(["table1.csv", "figure3.png", "figure3.svg"]
                .map(String::from)
                .into())
        })
    })?;
    stopped.map_or(Ok(()), Err)
}

/// The results with M_D and M_C on one scene.
fn side(
    session: &Session,
    scene: &Scene,
    paper: Option<PaperSide>,
    stopped: &mut Option<Error>,
) -> Result<Table1Side> {
    let mut run = |pc| -> Result<(SetUpSummary, PcResult)> {
        let substructures = distribution::substructures(session, scene)?;
        // The paper's method without additions.
        let settings = MethodSettings::default()
            .pc_type(pc)
            .adaptive(Adaptive::Off);
        let mut solver = FetiFeti::new(session, substructures, settings)?;
        let solution = solver.solve()?;
        if !solution.converged() {
            stopped.get_or_insert(not_converged(
                &scene.title,
                &solution.status,
                solution.iterations,
            ));
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
