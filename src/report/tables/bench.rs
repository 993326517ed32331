//! The benchmark as tables and as a picture.

use super::methods::{counted, outcome, outer, ranks_and_threads, without};
use super::summary::exactly;
use super::table::{count, fixed, scientific, Align, Table};
use crate::report::drawing::canvas::Colour;
use crate::report::drawing::ticks::Scale;
use crate::report::json::{BenchCase, BenchReport, BenchRow, Spread};
use crate::report::plots::plot::{Axis, Figure, Line, Marker, Panel, Series};

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
         parts: pieces of the domain that the method sees; ranks: MPI ranks (x threads); \
         MB: largest resident memory, summed over the ranks;\n\
         net: without what each rank holds before it has read the problem; \
         error: in the energy norm, against a refined direct solution.\n{}",
        cases.join("\n"),
        report.rounds,
        report.cores,
        match report.cases.iter().any(|c| c.contact.is_some()) {
            true => " (with contact the whole loop; last set: only the equations of our last active set)",
            false => "",
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
    let contact = case.contact.is_some();
    let header = [
        "method", "parts", "ranks", "outer", "it", "set-up s", "solve s", "recover", "total s",
        "min", "max", "ratio", "again s", "MB", "MB net", "error", "residual", "outcome",
    ];
    let dropped: &[usize] = if contact { &[] } else { &[3] };
    let last = if contact { 17 } else { 16 };
    let mut table = Table::new(without(dropped, header))
        .align(0, Align::Left)
        .align(last, Align::Left);
    let mut notes = String::new();
    for r in &case.methods {
        let note = |text: String| notes += &format!("{}: {text}\n", label(r));
        let (rescue, message) = (r.rescue.as_deref(), r.message.as_deref());
        let outcome = outcome(&r.converged_reason, rescue, message, note);
        let net = r
            .memory_mb
            .zip(r.memory_at_start_mb)
            .map(|(all, start)| all.median - start.median);
        let total = r.seconds.total;
        let cells = [
            r.method.clone(),
            count(r.subdomains),
            ranks_and_threads(r.ranks, r.threads),
            outer(r.contact),
            count(r.iterations),
            fixed(median(r.seconds.setup), 3),
            fixed(median(r.seconds.solve), 3),
            fixed(median(r.seconds.recover), 3),
            fixed(median(total), 3),
            fixed(total.map(|t| t.min), 3),
            fixed(total.map(|t| t.max), 3),
            fixed(r.ratio, 2),
            fixed(median(r.seconds.again), 3),
            fixed(median(r.memory_mb), 0),
            fixed(net, 0),
            scientific(r.error),
            scientific(r.residual),
            outcome,
        ];
        table.row(without(dropped, cells));
    }
    format!(
        "{}: {}, {} bodies, {} subdomains, {} unknowns, ‖b − Au‖ ≤ {} ‖b‖, {} rounds\n\n{table}{notes}{}\n",
        case.case,
        case.scene,
        case.bodies,
        case.subdomains,
        case.dofs,
        scientific(Some(case.rtol)),
        case.rounds,
        sum(case)
    )
}

/// One line about the fastest variant of ours and the fastest other method.
fn sum(case: &BenchCase) -> String {
    let [Some(ours), Some(other)] = [true, false].map(|ours| case.fastest(ours)) else {
        return String::new();
    };
    let seconds = |r: &BenchRow| fixed(median(r.seconds.total), 3);
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
    match (row.layout.as_str(), row.subdomains) {
        (layout @ ("threads" | "ranks"), _) => format!("{}, {layout}", row.method),
        (layout, Some(_)) => format!("{}, a part per {layout}", row.method),
        (_, None) => row.method.clone(),
    }
}

/// All rows for programs: full precision, empty cells for unknown values.
pub fn csv(report: &BenchReport) -> Table {
    let phases = ["setup", "solve", "recover", "total", "again"];
    let mut header: Vec<String> = ["case", "method", "layout", "subdomains", "ranks", "threads"]
        .map(String::from)
        .to_vec();
    for phase in phases {
        header.extend(["median", "min", "max"].map(|of| format!("{phase}_{of}")));
    }
    let tail = [
        "ratio",
        "memory_mb",
        "memory_at_start_mb",
        "kappa",
        "iterations",
        "outer_steps",
        "error",
        "residual",
        "rounds",
        "converged",
        "converged_reason",
        "rescue",
        "message",
    ];
    header.extend(tail.map(String::from));
    let mut table = Table::new(header);
    for case in &report.cases {
        for r in &case.methods {
            let s = &r.seconds;
            let mut cells = vec![
                case.case.clone(),
                r.method.clone(),
                r.layout.clone(),
                counted(r.subdomains),
                r.ranks.to_string(),
                r.threads.to_string(),
            ];
            for spread in [s.setup, s.solve, s.recover, s.total, s.again] {
                let of = |pick: fn(Spread) -> f64| exactly(spread.map(pick));
                cells.extend([of(|s| s.median), of(|s| s.min), of(|s| s.max)]);
            }
            cells.extend([
                exactly(r.ratio),
                exactly(median(r.memory_mb)),
                exactly(median(r.memory_at_start_mb)),
                exactly(r.kappa),
                counted(r.iterations),
                counted(r.contact.and_then(|c| c.outer)),
                exactly(r.error),
                exactly(r.residual),
                r.samples.iter().filter(|s| s.converged).count().to_string(),
                r.converged.to_string(),
                r.converged_reason.clone(),
                r.rescue.clone().unwrap_or_default(),
                r.message.clone().unwrap_or_default(),
            ]);
            table.row(cells);
        }
    }
    table
}

/// A figure of the error over the seconds of set-up and solve. Each case has a panel; each method has a marker at its
/// median, and a bar from its smallest to its largest total.
pub fn figure(report: &BenchReport) -> Figure {
    // A method has the same colour in all panels; a layout has the same shape.
    let mut methods: Vec<&str> = Vec::new();
    for row in report.cases.iter().flat_map(|c| &c.methods) {
        if !methods.contains(&row.method.as_str()) {
            methods.push(&row.method);
        }
    }
    let colour = |row: &BenchRow| {
        let k = methods.iter().position(|m| *m == row.method).unwrap_or(0);
        Colour::CYCLE[k % Colour::CYCLE.len()]
    };
    let marker = |row: &BenchRow| match row.layout.as_str() {
        "ranks" | "subdomain" => Marker::Square,
        "body" => Marker::Diamond,
        "core" if row.subdomains.is_some() => Marker::Triangle,
        _ => Marker::Circle,
    };
    let panel = |case: &BenchCase| {
        let mut series = Vec::new();
        for row in case.methods.iter().filter(|r| r.converged) {
            let (Some(total), Some(error)) = (row.seconds.total, row.error) else {
                continue;
            };
            let ends = vec![(total.min, error), (total.max, error)];
            series.push(Series::new("", ends, colour(row)).marker(Marker::None, false, 0.0));
            let name = match row.set_given() {
                true => format!("{} (set given)", label(row)),
                false => label(row),
            };
            series.push(
                Series::new(name, vec![(total.median, error)], colour(row))
                    .marker(marker(row), !row.set_given(), 4.5)
                    .line(Line::None),
            );
        }
        Panel {
            title: case.case.clone(),
            x: Axis::new("seconds, set-up and solve", Scale::Log),
            y: Axis::new("relative error, energy norm", Scale::Log),
            series,
            bands: Vec::new(),
        }
    };
    let panels: Vec<Panel> = report.cases.iter().map(panel).collect();
    Figure::new(
        "Error against seconds: medians, smallest and largest",
        panels,
    )
}

#[cfg(test)]
#[path = "../../../tests/inside/report/tables/bench.rs"]
mod tests;
