//! The tables.

use super::{AdaptiveReport, AdaptiveRun, Bddc, Fine, Record, USUAL};
use report::tables::table::{condition, count, fixed, scientific, Table};

/// All runs, one row for each τ.
pub fn table(report: &AdaptiveReport) -> Table {
    // An estimate is a lower bound.
    let plain = |c: &Record| match c.plain.exact {
        Some(_) => condition(c.plain.exact),
        None => format!("≥ {}", condition(c.plain.estimate)),
    };
    let bddc_seconds = |r: &AdaptiveRun| {
        let ran = r.bddc.as_ref().filter(|b| b.iterations.is_some());
        ran.map(|b| b.seconds)
    };
    let verdict = |r: &AdaptiveRun| {
        if r.fails.is_empty() {
            "OK".to_string()
        } else {
            r.fails.join("; ")
        }
    };
    let runs = report
        .cases
        .iter()
        .flat_map(|c| c.runs.iter().map(move |r| (c, r)));
    Table::of(runs)
        .words("case", |(c, _)| &c.case)
        .numbers("dofs", |(c, _)| c.dofs)
        .numbers("κ plain", |(c, _)| plain(c))
        .numbers("it", |(c, _)| c.plain.iterations)
        .numbers("s", |(c, _)| fixed(Some(c.plain.seconds), 2))
        .numbers("error", |(c, _)| scientific(c.plain.error))
        .numbers("MUMPS", |(c, _)| scientific(c.mumps))
        .numbers("last place", |(c, _)| scientific(c.last_place))
        .numbers("τ", |(_, r)| r.tau)
        .numbers("κ", |(_, r)| condition(r.kappa))
        .numbers("λ_min − 1", |(_, r)| {
            scientific(r.lambda_min.map(|l| l - 1.0))
        })
        .numbers("vectors", |(_, r)| r.vectors)
        .numbers("most", |(_, r)| r.most)
        .numbers("search s", |(_, r)| {
            fixed(r.searched.then_some(r.search), 2)
        })
        .numbers("it τ", |(_, r)| r.iterations)
        .numbers("s τ", |(_, r)| fixed(Some(r.seconds), 2))
        .numbers("error τ", |(_, r)| scientific(r.error))
        .numbers("attainable", |(_, r)| scientific(r.attainable))
        .numbers("BDDC it", |(_, r)| {
            count(r.bddc.as_ref().and_then(|b| b.iterations))
        })
        .numbers("BDDC κ", |(_, r)| {
            condition(r.bddc.as_ref().and_then(|b| b.kappa))
        })
        .numbers("BDDC s", |(_, r)| fixed(bddc_seconds(r), 2))
        .words("verdict", |(_, r)| verdict(r))
        .table()
}

/// Seconds on finer elements.
pub fn fine(report: &AdaptiveReport) -> Table {
    let cases = report.cases.iter();
    let ratio = |f: &Fine| Some(f.seconds / f.plain_seconds);
    Table::of(cases.filter_map(|c| Some((&c.case, c.fine.as_ref()?))))
        .words("case", |(case, _)| *case)
        .numbers("dofs", |(_, f)| f.dofs)
        .numbers("κ plain ≥", |(_, f)| condition(f.estimate))
        .numbers("it", |(_, f)| f.plain_iterations)
        .numbers("s", |(_, f)| fixed(Some(f.plain_seconds), 3))
        .numbers("vectors", |(_, f)| f.vectors)
        .numbers("search s", |(_, f)| {
            fixed((f.search > 0.0).then_some(f.search), 3)
        })
        .numbers("it τ", |(_, f)| f.iterations)
        .numbers("s τ", |(_, f)| fixed(Some(f.seconds), 3))
        .numbers("s τ / s", |(_, f)| fixed(ratio(f), 2))
        .table()
}

/// The table for terminals, with the messages of runs that failed.
pub fn text(report: &AdaptiveReport) -> String {
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
