//! Figures of the study: runs over ranks and bodies, and the model by phase.

use super::{
    IterationSeconds, ScalingPoint, ScalingProblem, ScalingReport, ScalingSeries as Runs,
    SetupSeconds,
};
use report::drawing::canvas::Colour;
use report::drawing::ticks::Scale;
use report::plots::plot::{Axis, Figure, LineStyle, Marker, Panel, Series};

/// Ranks of the runs.
const RANKS: [f64; 3] = [1.0, 2.0, 4.0];

fn colour(k: usize) -> Colour {
    Colour::CYCLE[k % Colour::CYCLE.len()]
}

/// Measured and modelled seconds of set-up and solve over ranks; hollow where there are more ranks than cores.
fn over_ranks(report: &ScalingReport, runs: Runs, title: &str) -> Panel {
    let mut series = Vec::new();
    for (k, problem) in [ScalingProblem::Tied, ScalingProblem::Contact]
        .into_iter()
        .enumerate()
    {
        let points = report.points.iter();
        let of = points.filter(|p| p.series == runs && p.problem == problem);
        let of: Vec<&ScalingPoint> = of.collect();
        if of.is_empty() {
            continue;
        }
        let marker = [Marker::Circle, Marker::Square][k];
        let at = |crowded: bool| {
            let these = of.iter().filter(|p| p.oversubscribed == crowded);
            these
                .map(|p| (p.ranks as f64, p.total[0] + p.total[1]))
                .collect::<Vec<_>>()
        };
        let model = |p: &&ScalingPoint| (p.ranks as f64, p.model.total(p.iterations as f64));
        let name = problem.name();
        // The model does not include the steps of the contact loop.
        if problem == ScalingProblem::Tied {
            let curve = of.iter().map(model).collect();
            series.push(
                Series::new(format!("{name}, model"), curve, colour(k))
                    .line_only()
                    .line(LineStyle::Dashed),
            );
        }
        let label = format!("{name}, more ranks than cores");
        series.push(
            Series::new(label, at(true), colour(k))
                .marker(marker, false, 4.5)
                .line(LineStyle::None),
        );
        series.push(
            Series::new(name, at(false), colour(k))
                .marker(marker, true, 4.5)
                .line(LineStyle::Full),
        );
    }
    let x = Axis::new("ranks", Scale::Log).at(RANKS);
    let y = Axis::new("seconds, set-up and solve", Scale::Log);
    Panel::new(title, x, y, series)
}

/// Iterations over the number of subdomains, a curve for each size of body.
fn iterations(report: &ScalingReport) -> Panel {
    let runs = || report.points.iter().filter(|p| p.series == Runs::Bodies);
    let mut sizes: Vec<usize> = runs().map(|p| p.subdomains / p.bodies).collect();
    sizes.dedup();
    let markers = [Marker::Diamond, Marker::Triangle, Marker::Square];
    let curve = |(k, &size): (usize, &usize)| {
        let of = runs().filter(|p| p.subdomains == size * p.bodies);
        let points = of.map(|p| (p.subdomains as f64, p.iterations as f64));
        let label = match size {
            1 => "bodies of 1 subdomain".to_string(),
            n => format!("bodies of {n} subdomains"),
        };
        Series::new(label, points.collect(), colour(k + 2)).marker(
            markers[k % markers.len()],
            true,
            4.5,
        )
    };
    let series = sizes.iter().enumerate().map(curve).collect();
    let mut y = Axis::new("iterations", Scale::Linear);
    let most = runs().map(|p| p.iterations).max().unwrap_or(0);
    y.range = Some((0.0, 1.15 * most as f64));
    let x = Axis::new("subdomains", Scale::Log);
    Panel::new("Bodies of one size, tied", x, y, series)
}

/// The figure of the runs.
pub fn figure(report: &ScalingReport) -> Figure {
    Figure::new(
        "Seconds over ranks, iterations over subdomains",
        vec![
            over_ranks(report, Runs::Strong, "Strong: one scene"),
            over_ranks(report, Runs::Weak, "Weak: four bodies per rank"),
            iterations(report),
        ],
    )
}

/// The names of the phases. The index of a phase is its place in the palette, the same in all panels.
fn phases() -> Vec<&'static str> {
    let mut all = SetupSeconds::NAMES.to_vec();
    let more = IterationSeconds::NAMES.iter();
    all.extend(more.filter(|n| !SetupSeconds::NAMES.contains(n)));
    all
}

/// The name as text with subscripts.
fn label(name: &str) -> String {
    name.replace("S_Π", "S_{Π}").replace("Z_c", "Z_{c}")
}

fn phase_colour(name: &str) -> Colour {
    let k = phases().iter().position(|p| *p == name).unwrap_or(0);
    // There is one phase more than colours in the cycle.
    Colour::CYCLE.get(k).copied().unwrap_or(Colour::INK)
}

/// Milliseconds of an iteration by phase over bodies of four subdomains: markers are measured, lines modelled.
fn measured_phases(report: &ScalingReport) -> Panel {
    let of = report.points.iter();
    let of = of.filter(|p| p.series == Runs::Bodies && p.subdomains == 4 * p.bodies);
    let of: Vec<&ScalingPoint> = of.collect();
    let mut series = Vec::new();
    for (k, name) in IterationSeconds::NAMES.iter().enumerate() {
        let curve = |seconds: &dyn Fn(&ScalingPoint) -> f64| {
            let points = of.iter().map(|p| (p.bodies as f64, 1e3 * seconds(p)));
            points.filter(|p| p.1 > 0.0).collect::<Vec<_>>()
        };
        let modelled = curve(&|p| p.model.iteration.all()[k]);
        if modelled.is_empty() {
            continue;
        }
        let line = Series::new(label(name), modelled, phase_colour(name));
        series.push(line.line_only());
        let dots = Series::new("", curve(&|p| p.iteration.all()[k]), phase_colour(name));
        series.push(dots.marker(Marker::Circle, true, 3.5).line(LineStyle::None));
    }
    let x = Axis::new("bodies of 2 x 2 subdomains", Scale::Log);
    let y = Axis::new("milliseconds per iteration", Scale::Log);
    Panel::new("One rank: measured, and fitted (lines)", x, y, series)
}

/// Predicted seconds over ranks by phase.
fn predicted(report: &ScalingReport, iteration: bool) -> Panel {
    let rows = &report.predictions[0].rows;
    let mut series = Vec::new();
    let names: Vec<&str> = if iteration {
        IterationSeconds::NAMES.to_vec()
    } else {
        SetupSeconds::NAMES.to_vec()
    };
    for (k, name) in names.iter().enumerate() {
        let of = |row: &super::PredictedRow| {
            if iteration {
                1e3 * row.seconds.iteration.all()[k]
            } else {
                row.seconds.setup.all()[k]
            }
        };
        let points: Vec<(f64, f64)> = rows.iter().map(|r| (r.ranks as f64, of(r))).collect();
        if points.iter().any(|p| p.1 > 0.0) {
            let line = Series::new(label(name), points, phase_colour(name));
            series.push(line.line_only());
        }
    }
    let (title, y) = if iteration {
        ("Predicted iteration", "milliseconds per iteration")
    } else {
        ("Predicted set-up", "seconds")
    };
    let x = Axis::new("ranks, a body on each", Scale::Log);
    Panel::new(title, x, Axis::new(y, Scale::Log), series)
}

/// The figure of the model: the runs it is fitted to, and the predictions for the stated network.
pub fn model_figure(report: &ScalingReport) -> Figure {
    let network = report.predictions[0].network;
    Figure::new(
        format!(
            "The model by phase; network: {:.1} µs per message, {:.1} GB/s",
            1e6 * network.alpha,
            1e-9 / network.beta
        ),
        vec![
            measured_phases(report),
            predicted(report, false),
            predicted(report, true),
        ],
    )
}
