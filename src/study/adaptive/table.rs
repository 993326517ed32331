//! The tables.

use super::{Bddc, Record, Report, USUAL};
use crate::report::tables::table::{count, fixed, scientific, Align, Table};

/// All runs, one row for each τ.
pub fn table(report: &Report) -> Table {
    let header = [
        "case",
        "dofs",
        "κ plain",
        "it",
        "s",
        "error",
        "MUMPS",
        "last place",
        "τ",
        "κ",
        "λ_min − 1",
        "vectors",
        "most",
        "search s",
        "it τ",
        "s τ",
        "error τ",
        "attainable",
        "BDDC it",
        "BDDC κ",
        "BDDC s",
        "verdict",
    ];
    let last = header.len() - 1;
    let mut table = Table::new(header)
        .align(0, Align::Left)
        .align(last, Align::Left);
    for record in &report.cases {
        for row in rows(record) {
            table.row(row);
        }
    }
    table
}

fn rows(record: &Record) -> Vec<Vec<String>> {
    let plain = &record.plain;
    // An estimate is a lower bound.
    let kappa = match plain.exact {
        Some(_) => number(plain.exact),
        None => format!("≥ {}", number(plain.estimate)),
    };
    let mut out = Vec::new();
    for run in &record.runs {
        let bddc = run.bddc.as_ref();
        out.push(vec![
            record.case.clone(),
            record.dofs.to_string(),
            kappa.clone(),
            plain.iterations.to_string(),
            fixed(Some(plain.seconds), 2),
            scientific(plain.error),
            scientific(record.mumps),
            scientific(record.last_place),
            run.tau.to_string(),
            number(run.kappa),
            scientific(run.lambda_min.map(|l| l - 1.0)),
            run.vectors.to_string(),
            run.most.to_string(),
            fixed(run.searched.then_some(run.search), 2),
            run.iterations.to_string(),
            fixed(Some(run.seconds), 2),
            scientific(run.error),
            scientific(run.attainable),
            count(bddc.and_then(|b| b.iterations)),
            number(bddc.and_then(|b| b.kappa)),
            fixed(
                bddc.filter(|b| b.iterations.is_some()).map(|b| b.seconds),
                2,
            ),
            match run.fails.is_empty() {
                true => "OK".to_string(),
                false => run.fails.join("; "),
            },
        ]);
    }
    out
}

/// Seconds on finer elements.
pub fn fine(report: &Report) -> Table {
    let header = [
        "case",
        "dofs",
        "κ plain ≥",
        "it",
        "s",
        "vectors",
        "search s",
        "it τ",
        "s τ",
        "s τ / s",
    ];
    let mut table = Table::new(header).align(0, Align::Left);
    for (record, f) in report
        .cases
        .iter()
        .filter_map(|r| r.fine.as_ref().map(|f| (r, f)))
    {
        let ratio = f.seconds / f.plain_seconds;
        table.row(vec![
            record.case.clone(),
            f.dofs.to_string(),
            number(f.estimate),
            f.plain_iterations.to_string(),
            fixed(Some(f.plain_seconds), 3),
            f.vectors.to_string(),
            fixed((f.search > 0.0).then_some(f.search), 3),
            f.iterations.to_string(),
            fixed(Some(f.seconds), 3),
            fixed(ratio.is_finite().then_some(ratio), 2),
        ]);
    }
    table
}

/// A condition number; in fixed notation while it is small.
pub(super) fn number(x: Option<f64>) -> String {
    match x {
        Some(v) if v < 1e4 => fixed(x, 2),
        _ => scientific(x),
    }
}

/// The table for terminals, with the messages of runs that failed.
pub fn text(report: &Report) -> String {
    let mut out = format!(
        "Adaptive deflation: rtol {:e}, seconds are medians of {} runs; errors in the energy norm \
         against a direct solution; attainable: the error where rounding stops the iteration\n{}\n",
        report.rtol,
        report.repeats,
        table(report)
    );
    if report.cases.iter().any(|c| c.fine.is_some()) {
        out += &format!("Finer elements, τ = {USUAL}\n{}\n", fine(report));
    }
    for record in &report.cases {
        if let Some(message) = record.fine.as_ref().and_then(|f| f.message.as_ref()) {
            out += &format!("{}, finer elements: {message}\n", record.case);
        }
        if let Some(message) = &record.plain.message {
            out += &format!("{}, off: {message}\n", record.case);
        }
        for run in &record.runs {
            if run.capped > 0 {
                out += &format!(
                    "{}, τ = {}: the search ended early in {} bodies\n",
                    record.case, run.tau, run.capped
                );
            }
            let said = |b: &Bddc| b.message.clone();
            if let Some(message) = run.bddc.as_ref().and_then(said) {
                out += &format!("{}, PCBDDC at {}: {message}\n", record.case, run.tau);
            }
        }
    }
    let all = report.cases.iter().map(|c| c.runs.len()).sum::<usize>();
    let failing: usize = report.cases.iter().map(|c| c.failing().count()).sum();
    out + &format!("{} of {all} runs are OK\n", all - failing)
}
