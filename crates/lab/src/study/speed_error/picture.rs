//! Work-precision plots: error over seconds, a curve per method.

use super::{SpeedErrorReport, SpeedErrorRun, SpeedErrorScene};
use report::drawing::canvas::Colour;
use report::drawing::ticks::Scale;
use report::plots::plot::{Axis, Figure, LineStyle, Marker, Panel, Series};
use report::tables::table::{count, scientific, Table};

/// All runs.
pub fn table(report: &SpeedErrorReport) -> Table {
    let cases = report.cases.iter();
    let runs = cases.flat_map(|c| c.runs.iter().map(move |r| (&c.case, r)));
    Table::of(runs)
        .words("scene", |(case, _)| *case)
        .words("method", |(_, r)| &r.method)
        .numbers("n", |(_, r)| r.elements)
        .numbers("dofs", |(_, r)| r.dofs)
        .numbers("rtol", |(_, r)| format!("{:e}", r.rtol))
        .numbers("ranks", |(_, r)| r.ranks)
        .numbers("threads", |(_, r)| r.threads)
        .numbers("it", |(_, r)| count(r.iterations))
        .numbers("set-up s", |(_, r)| format!("{:.4}", r.setup))
        .numbers("solve s", |(_, r)| format!("{:.4}", r.solve))
        .numbers("solver error", |(_, r)| scientific(Some(r.solver_error)))
        .numbers("error", |(_, r)| format!("{:.3e}", r.error))
        .numbers("converged", |(_, r)| if r.converged { "yes" } else { "no" })
        .table()
}

/// The table for terminals.
pub fn text(report: &SpeedErrorReport) -> String {
    format!(
        "Error and seconds on {} cores; n: elements across a subdomain; \
         error: of mesh and solver, relative, in the energy norm\n{}",
        report.cores,
        table(report)
    )
}

/// The runs that no other run of the method beats in both error and seconds, by seconds.
fn front(runs: &[&SpeedErrorRun], seconds: fn(&SpeedErrorRun) -> f64) -> Vec<(f64, f64)> {
    let mut points: Vec<(f64, f64)> = runs.iter().map(|r| (seconds(r), r.error)).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut best = f64::INFINITY;
    points.retain(|p| {
        let better = p.1 < best;
        best = best.min(p.1);
        better
    });
    points
}

/// Error over seconds: set-up and solve, and the solve alone.
pub fn figure(case: &SpeedErrorScene) -> Figure {
    let markers = [
        Marker::Circle,
        Marker::Square,
        Marker::Diamond,
        Marker::Triangle,
    ];
    let panel = |title: &str, seconds: fn(&SpeedErrorRun) -> f64| {
        let mut series = Vec::new();
        for (k, method) in case.methods().iter().enumerate() {
            let runs = case.fastest(method);
            let (colour, marker) = (
                Colour::CYCLE[k % Colour::CYCLE.len()],
                markers[k % markers.len()],
            );
            let all = runs.iter().map(|r| (seconds(r), r.error)).collect();
            series.push(
                Series::new("", all, colour)
                    .marker(marker, false, 3.0)
                    .line(LineStyle::None),
            );
            series.push(
                Series::new(method.clone(), front(&runs, seconds), colour)
                    .marker(marker, true, 3.6),
            );
        }
        let [x, y] =
            ["seconds", "relative error, energy norm"].map(|name| Axis::new(name, Scale::Log));
        Panel::new(title, x, y, series)
    };
    Figure::new(
        case.title.clone(),
        vec![
            panel("Set-up and solve", |r| r.setup + r.solve),
            panel("Solve alone", |r| r.solve),
        ],
    )
}
