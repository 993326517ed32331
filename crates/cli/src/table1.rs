//! `fetifeti table1`: arguments and files; the measurement itself is [`lab::study::table1`].

use super::args::Table1;
use super::first_rank::on_first_rank;
use super::solve::not_converged;
use base::Result;
use lab::study::table1::{self, StoppedSolve};
use petsc::Session;
use report::destination::Destination;

/// Computes the rows and writes the results that the arguments ask for.
pub fn run(session: &Session, args: Table1) -> Result<()> {
    let destination = Destination::from(args.results);
    on_first_rank(session, || destination.prepare())?;
    let rows = if args.rows.is_empty() {
        table1::rows(false, None)?
    } else {
        args.rows
    };
    let mut progress = |what: &str| {
        if session.rank() == 0 {
            destination.progress(&format!("table1: {what}"));
        }
    };
    let report = table1::run(session, &rows, "--rows", &mut progress)?;
    on_first_rank(session, || {
        destination.progress("");
        let text = table1::table1(&report.rows).to_string();
        destination.finish("table1", &text, &report.rows, |dir| {
            table1::save(&report.rows, dir)
        })
    })?;
    ended(report.stopped)
}

/// The error for the first solve that stopped early, if there is one.
pub(super) fn ended(stopped: Option<StoppedSolve>) -> Result<()> {
    match stopped {
        None => Ok(()),
        Some(s) => Err(not_converged(&s.title, &s.status, s.iterations)),
    }
}
