//! The results of the study: the table, the nodal pressures as CSV, and their picture with the theory.

use super::{CaseReport, Contact, Quantity, Report};
use crate::report::drawing::canvas::Colour;
use crate::report::drawing::ticks::Scale;
use crate::report::plots::plot::{Axis, Figure, Line, Marker, Panel, Series};
use crate::report::tables::table::{Align, Table};

/// All meshes of all problems.
pub fn table(report: &Report) -> Table {
    let header = [
        "problem",
        "n",
        "dofs",
        "nodes",
        "force",
        "a fit",
        "a last",
        "a theory",
        "error %",
        "p0 fit",
        "p0 node",
        "p0 theory",
        "error %",
        "p rms %",
        "outer",
        "it",
        "kkt",
        "s",
    ];
    let mut table = Table::new(header).align(0, Align::Left);
    for case in &report.cases {
        for m in &case.meshes {
            let triple = |q: &Quantity| {
                [
                    format!("{:.5}", q.fit),
                    format!("{:.5}", q.node),
                    format!("{:.5}", q.theory),
                    format!("{:+.2}", 100.0 * q.error),
                ]
            };
            let mut cells = vec![
                case.case.clone(),
                m.elements.to_string(),
                m.dofs.to_string(),
                m.active.to_string(),
                format!("{:.3e}", m.force),
            ];
            cells.extend(triple(&m.half_width));
            cells.extend(triple(&m.peak));
            cells.push(format!("{:.2}", 100.0 * m.curve));
            cells.extend([
                m.outer_iterations.to_string(),
                m.iterations.to_string(),
                format!("{:.0e}", m.kkt),
                format!("{:.2}", m.seconds),
            ]);
            table.row(cells);
        }
    }
    table
}

/// The table for terminals.
pub fn text(report: &Report) -> String {
    let orders: Vec<String> = report
        .cases
        .iter()
        .map(|c| format!("{} {:.2}", c.case, c.order))
        .collect();
    format!(
        "Hertz contact: n elements per radius; fit: p² = p0² (1 − x²/a²); \
         last, node: single nodes; theory for the measured force\n{}\n\
         order of convergence of the pressures: {}\n",
        table(report),
        orders.join(", ")
    )
}

/// The nodal pressures of all meshes of one problem.
pub fn csv(case: &CaseReport) -> Table {
    let mut table = Table::new(["elements", "x", "pressure", "hertz"]);
    for m in &case.meshes {
        for node in &m.pressure {
            table.row([
                m.elements.to_string(),
                format!("{:.12e}", node.x),
                format!("{:.12e}", node.p),
                format!("{:.12e}", node.theory),
            ]);
        }
    }
    table
}

/// A figure of pressure over distance in units of the theory, and of the errors over the mesh.
pub fn figure(case: &CaseReport) -> Figure {
    let hertz = Contact { a: 1.0, p0: 1.0 };
    let curve: Vec<(f64, f64)> = (0..=400)
        .map(|k| {
            let x = -1.5 + 3.0 * f64::from(k) / 400.0;
            (x, hertz.pressure(x))
        })
        .filter(|(x, _)| case.finest().pressure.iter().any(|n| n.x < 0.0) || *x >= 0.0)
        .collect();
    let mut series =
        vec![Series::new("Hertz", curve, Colour::CYCLE[7]).marker(Marker::None, true, 1.0)];
    let markers = [Marker::Triangle, Marker::Square, Marker::Circle];
    // The two coarsest meshes and the finest one: more curves would hide each other.
    let n = case.meshes.len();
    let shown = [0, 1.min(n - 1), n - 1];
    for (k, &m) in shown.iter().enumerate() {
        let mesh = &case.meshes[m];
        let (a, p0) = (mesh.half_width.theory, mesh.peak.theory);
        let points = mesh.pressure.iter().map(|n| (n.x / a, n.p / p0));
        let points = points.filter(|(x, _)| x.abs() <= 1.5).collect();
        let label = format!("n = {}", mesh.elements);
        series.push(
            Series::new(label, points, Colour::CYCLE[[4, 2, 0][k]])
                .marker(markers[k], k == 2, [5.0, 4.0, 2.6][k])
                .line(Line::None),
        );
    }
    let pressure = Panel {
        title: "Nodal pressure".into(),
        x: Axis::new("x / a", Scale::Linear),
        y: Axis::new("p / p_{0}", Scale::Linear),
        series,
        bands: Vec::new(),
    };
    let errors = |pick: fn(&super::Mesh) -> f64| {
        let list = case.meshes.iter();
        list.map(|m| (m.elements as f64, 100.0 * pick(m).abs()))
            .collect::<Vec<_>>()
    };
    let counts: Vec<f64> = case.meshes.iter().map(|m| m.elements as f64).collect();
    let mut limit = vec![(counts[0], 2.0)];
    limit.push((counts[n - 1], 2.0));
    let convergence = Panel {
        title: "Distance from the theory".into(),
        x: Axis::new("elements per radius", Scale::Log).at(counts),
        y: Axis::new("error in %", Scale::Log),
        series: vec![
            Series::new(
                "half-width, fit",
                errors(|m| m.half_width.error),
                Colour::CYCLE[0],
            ),
            Series::new("peak, fit", errors(|m| m.peak.error), Colour::CYCLE[1]).marker(
                Marker::Square,
                true,
                4.0,
            ),
            Series::new(
                "pressure, root mean square",
                errors(|m| m.curve),
                Colour::CYCLE[2],
            )
            .marker(Marker::Diamond, true, 4.0),
            Series::new(
                "half-width, last node",
                errors(|m| m.half_width.node / m.half_width.theory - 1.0),
                Colour::CYCLE[5],
            )
            .marker(Marker::Circle, false, 4.0)
            .line(Line::Dotted),
            Series::new(
                "peak, largest node",
                errors(|m| m.peak.node / m.peak.theory - 1.0),
                Colour::CYCLE[4],
            )
            .marker(Marker::Square, false, 4.0)
            .line(Line::Dotted),
            Series::new("2 %", limit, Colour::CYCLE[7])
                .marker(Marker::None, true, 1.0)
                .line(Line::Dashed),
        ],
        bands: Vec::new(),
    };
    Figure::new(case.title.clone(), vec![pressure, convergence])
}
