//! `fetifeti table1`: Lee's experiment, his numbers and ours.

use super::args::Table1;
use super::{not_converged, solve};
use crate::feti::settings::Adaptive;
use crate::feti::{MethodSettings, PcType, Spectrum};
use crate::petsc::Session;
use crate::report::json::{self, CoarseCorrected, PaperSide, Table1Row, Table1Side};
use crate::report::output;
use crate::report::plots::figure3;
use crate::report::tables::{paper, summary};
use crate::scene::{distribution, Faces, Scene};
use crate::{Error, FetiFeti, Result, Solution};

/// Computes the rows and writes what was asked for.
pub fn run(session: &Session, args: &Table1) -> Result<()> {
    solve::prepare(session, args.out.as_deref(), args.json.as_deref())?;
    let wanted: Vec<[usize; 3]> = if args.rows.is_empty() {
        paper::table1()
            .iter()
            .map(|r| [r.bodies, r.subdomains, r.elements])
            .collect()
    } else {
        args.rows.clone()
    };
    let mut rows = Vec::with_capacity(wanted.len());
    let mut stopped = None;
    for (done, &[bodies, subdomains, elements]) in wanted.iter().enumerate() {
        progress(session, args, done, wanted.len());
        let of_paper = paper::lookup(bodies, subdomains, elements);
        let mut side = |faces, paper: Option<PaperSide>| {
            let scene = session.agree(Scene::lee(bodies, subdomains, elements, faces))?;
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
    }
    progress(session, args, wanted.len(), wanted.len());
    let written = if session.rank() == 0 {
        write(args, &rows)
    } else {
        Ok(())
    };
    session.agree(written)?;
    stopped.map_or(Ok(()), Err)
}

/// M_D and M_C on one scene.
fn side(
    session: &Session,
    scene: &Scene,
    paper: Option<PaperSide>,
    stopped: &mut Option<Error>,
) -> Result<Table1Side> {
    let mut run = |pc| -> Result<(FetiFeti, Solution, Option<Spectrum>)> {
        let substructures = distribution::substructures(session, scene)?;
        let settings = MethodSettings {
            pc_type: Some(pc),
            // The paper's method and nothing else.
            adaptive: Adaptive::Off,
            ..MethodSettings::default()
        };
        let solver = FetiFeti::new(session, substructures, settings)?;
        let solution = solver.solve()?;
        if !solution.converged() {
            stopped.get_or_insert(not_converged(
                &scene.title,
                &solution.status,
                solution.iterations,
            ));
        }
        let exact = solver.spectrum()?;
        Ok((solver, solution, exact))
    };
    let (solver, plain, exact) = run(PcType::Dirichlet)?;
    let (_, lifted, exact_c) = run(PcType::CoarseCorrected)?;
    let facts = solver.facts();
    Ok(Table1Side {
        multipliers: facts.multipliers_local + facts.multipliers_active,
        local_multipliers: facts.multipliers_local,
        floating_bodies: facts.floating_bodies,
        iterations: plain.iterations,
        exact: exact.map(|s| s.kappa()),
        estimate: plain.estimate.map(|s| s.kappa()),
        lambda_min: exact.map(|s| s.lambda_min),
        lambda_max: exact.map(|s| s.lambda_max),
        paper,
        coarse_corrected: CoarseCorrected {
            exact: exact_c.map(|s| s.kappa()),
            estimate: lifted.estimate.map(|s| s.kappa()),
            lambda_min: exact_c.map(|s| s.lambda_min),
            lambda_max: exact_c.map(|s| s.lambda_max),
            iterations: lifted.iterations,
        },
    })
}

/// One line on stderr that overwrites itself, on a terminal only.
fn progress(session: &Session, args: &Table1, done: usize, all: usize) {
    use std::io::IsTerminal;
    if session.rank() == 0 && !args.quiet && std::io::stderr().is_terminal() {
        eprint!("\rtable1: {done} of {all} rows");
        if done == all {
            eprintln!();
        }
    }
}

fn write(args: &Table1, rows: &[Table1Row]) -> Result<()> {
    let to_stdout = args.json.as_deref().is_some_and(output::is_stdout);
    if !args.quiet && !to_stdout {
        output::print(&summary::table1(rows).to_string())?;
    }
    if let Some(file) = &args.json {
        json::write(file, &rows)?;
    }
    if let Some(dir) = &args.out {
        json::write(&dir.join("table1.json"), &rows)?;
        summary::table1_csv(rows).write_csv(&dir.join("table1.csv"))?;
        figure3::figure3(rows, &dir.join("figure3"))?;
        if !args.quiet && !to_stdout {
            output::print(&format!(
                "written: table1.json, table1.csv, figure3.png, figure3.svg in {}\n",
                dir.display()
            ))?;
        }
    }
    Ok(())
}
