//! The benchmark as tables and as a picture.

use super::methods::{options, outcome, outer, ranks_and_threads, LAYOUTS};
use super::table::{count, fixed, scientific, Table};
use crate::drawing::canvas::Colour;
use crate::drawing::ticks::Scale;
use crate::json::{BenchCase, BenchReport, BenchRow, Spread};
use crate::plots::plot::{Axis, Figure, LineStyle, Marker, Panel, Series};

/// All cases for terminals.
pub fn text(report: &BenchReport) -> String {
    let cases: Vec<String> = report.cases.iter().map(case_text).collect();
    format!(
        "{}\n{} rounds were asked for; in each of them every method ran once, \
         in the order of the rows, each run in processes of its own, on {} cores.\n\
         Seconds are medians over the rounds; assembly is not in them. \
         recover: the part of the solve for the way from multipliers to u;\n\
         total: set-up and solve, with its smallest and largest value; \
         ratio: the total over that of the fastest of ours;\n\
         again: the solve for a second load, with what was set up for the first{}.\n\
         {LAYOUTS}\n\
         parts: pieces of the domain that the method sees; ranks: MPI ranks (x threads); \
         MB: largest resident memory, summed over the ranks;\n\
         net: without what each rank holds before it has read the problem; \
         error: in the energy norm, against a refined direct solution.\n{}",
        cases.join("\n"),
        report.rounds,
        report.cores,
        if report.cases.iter().any(|c| c.facts.contact.is_some()) {
            " (with contact the whole loop; last set: only the equations of our last active set)"
        } else {
            ""
        },
        match &report.blas {
            Some(file) => format!("BLAS of all methods: {file}\n"),
            None => String::new(),
        }
    )
}

fn median(spread: Option<Spread>) -> Option<f64> {
    spread.map(|s| s.median)
}

/// One case with its caption.
fn case_text(case: &BenchCase) -> String {
    let contact = case.facts.contact.is_some();
    let mut notes = String::new();
    let mut note = |r: &BenchRow, text: String| notes += &format!("{}: {text}\n", label(r));
    let net = |r: &BenchRow| Some(median(r.memory_mb)? - median(r.memory_at_start_mb)?);
    let table = Table::of(&case.methods)
        .words("method", |r| &r.run.method)
        .words("layout", |r| &r.run.layout)
        .numbers("parts", |r| count(r.run.subdomains))
        .numbers("ranks", |r| ranks_and_threads(&r.run))
        .when(contact, |t| t.numbers("outer", |r| outer(&r.run)))
        .numbers("it", |r| count(r.run.iterations))
        .numbers("set-up s", |r| fixed(median(r.seconds.phases.setup), 3))
        .numbers("solve s", |r| fixed(median(r.seconds.phases.solve), 3))
        .numbers("recover", |r| fixed(median(r.seconds.recover), 3))
        .numbers("total s", |r| fixed(r.total(), 3))
        .numbers("min", |r| fixed(r.seconds.phases.total.map(|t| t.min), 3))
        .numbers("max", |r| fixed(r.seconds.phases.total.map(|t| t.max), 3))
        .numbers("ratio", |r| fixed(r.ratio, 2))
        .numbers("again s", |r| fixed(median(r.seconds.again), 3))
        .numbers("MB", |r| fixed(median(r.memory_mb), 0))
        .numbers("MB net", |r| fixed(net(r), 0))
        .numbers("error", |r| scientific(r.run.error))
        .numbers("residual", |r| scientific(r.run.residual))
        .words("outcome", |r| outcome(&r.run, |text| note(r, text)))
        .table();
    format!(
        "{}: {}, {} bodies, {} subdomains, {} unknowns, ‖b − Au‖ ≤ {} ‖b‖, {} rounds\n\n{table}{notes}{}\n{}\n",
        case.case,
        case.facts.scene,
        case.facts.bodies,
        case.facts.subdomains,
        case.facts.dofs,
        scientific(Some(case.facts.rtol)),
        case.rounds,
        sum(case),
        options(case.methods.iter().map(|r| &r.run)),
    )
}

/// One line about the fastest variant of ours and the fastest other method.
fn sum(case: &BenchCase) -> String {
    let [Some(ours), Some(other)] = [true, false].map(|ours| case.fastest(ours)) else {
        return String::new();
    };
    let seconds = |r: &BenchRow| fixed(r.total(), 3);
    format!(
        "Fastest of ours: {} s ({}); fastest other: {} s ({}), {} times as long.\n",
        seconds(ours),
        label(ours),
        seconds(other),
        label(other),
        fixed(other.ratio, 2)
    )
}

/// A method with its layout; the label is the same in every case.
fn label(row: &BenchRow) -> String {
    match (row.run.layout.as_str(), row.run.subdomains) {
        (layout @ ("threads" | "ranks"), _) => format!("{}, {layout}", row.run.method),
        (layout, Some(_)) => format!("{}, a part per {layout}", row.run.method),
        (_, None) => row.run.method.clone(),
    }
}

/// All rows for programs: full precision, empty cells for unknown values.
pub fn csv(report: &BenchReport) -> Table {
    let cases = report.cases.iter();
    let rows = cases.flat_map(|case| case.methods.iter().map(move |row| (case, row)));
    let mut table = Table::of(rows)
        .exact("case", |(c, _)| c.case.as_str())
        .exact("method", |(_, r)| r.run.method.as_str())
        .exact("layout", |(_, r)| r.run.layout.as_str())
        .exact("subdomains", |(_, r)| r.run.subdomains)
        .exact("ranks", |(_, r)| r.run.ranks)
        .exact("threads", |(_, r)| r.run.threads);
    let phases = ["setup", "solve", "recover", "total", "again"];
    for (k, phase) in phases.into_iter().enumerate() {
        let spread = |r: &BenchRow| {
            let (s, phases) = (r.seconds, r.seconds.phases);
            [phases.setup, phases.solve, s.recover, phases.total, s.again][k]
        };
        table = table
            .exact(format!("{phase}_median"), |(_, r)| median(spread(r)))
            .exact(format!("{phase}_min"), |(_, r)| spread(r).map(|s| s.min))
            .exact(format!("{phase}_max"), |(_, r)| spread(r).map(|s| s.max));
    }
    let converged = |r: &BenchRow| r.samples.iter().filter(|s| s.converged).count();
    table
        .exact("ratio", |(_, r)| r.ratio)
        .exact("memory_mb", |(_, r)| median(r.memory_mb))
        .exact("memory_at_start_mb", |(_, r)| median(r.memory_at_start_mb))
        .exact("kappa", |(_, r)| r.run.kappa)
        .exact("iterations", |(_, r)| r.run.iterations)
        .exact("outer_steps", |(_, r)| r.run.contact.and_then(|c| c.outer))
        .exact("error", |(_, r)| r.run.error)
        .exact("residual", |(_, r)| r.run.residual)
        .exact("rounds", |(_, r)| converged(r))
        .exact("converged", |(_, r)| r.run.converged)
        .exact("converged_reason", |(_, r)| r.run.converged_reason.as_str())
        .exact("options", |(_, r)| r.run.options.as_str())
        .exact("given", |(_, r)| r.run.given.as_str())
        .exact("rescue", |(_, r)| r.run.rescue.as_deref())
        .exact("message", |(_, r)| r.run.message.as_deref())
        .table()
}

/// A figure of the error over the seconds of set-up and solve. Each case has a panel; each method has a marker at its
/// median, and a bar from its smallest to its largest total.
pub fn figure(report: &BenchReport) -> Figure {
    // A method has the same colour in all panels; a layout has the same shape.
    let mut methods: Vec<&str> = Vec::new();
    for row in report.cases.iter().flat_map(|c| &c.methods) {
        if !methods.contains(&row.run.method.as_str()) {
            methods.push(&row.run.method);
        }
    }
    let colour = |row: &BenchRow| {
        let k = methods
            .iter()
            .position(|m| *m == row.run.method)
            .unwrap_or(0);
        Colour::CYCLE[k % Colour::CYCLE.len()]
    };
    let marker = |row: &BenchRow| match row.run.layout.as_str() {
        "ranks" | "subdomain" => Marker::Square,
        "body" | "packed" => Marker::Diamond,
        "core" if row.run.subdomains.is_some() => Marker::Triangle,
        _ => Marker::Circle,
    };
    let panel = |case: &BenchCase| {
        let mut series = Vec::new();
        for row in case.methods.iter().filter(|r| r.run.converged) {
            let (Some(total), Some(error)) = (row.seconds.phases.total, row.run.error) else {
                continue;
            };
            let ends = vec![(total.min, error), (total.max, error)];
            series.push(Series::new("", ends, colour(row)).line_only());
            let given = row.run.set_given();
            let name = if given {
                format!("{} (set given)", label(row))
            } else {
                label(row)
            };
            series.push(
                Series::new(name, vec![(total.median, error)], colour(row))
                    .marker(marker(row), !given, 4.5)
                    .line(LineStyle::None),
            );
        }
        let x = Axis::new("seconds, set-up and solve", Scale::Log);
        let y = Axis::new("relative error, energy norm", Scale::Log);
        Panel::new(&case.case, x, y, series)
    };
    let panels: Vec<Panel> = report.cases.iter().map(panel).collect();
    Figure::new(
        "Error against seconds: medians, smallest and largest",
        panels,
    )
}

#[cfg(test)]
#[path = "../../tests/tables/bench.rs"]
mod tests;
