//! The results of the study: the table, the nodal pressures as CSV, and their picture with the theory.

use super::{HertzContact, HertzMesh, HertzProblem, HertzReport};
use report::drawing::canvas::Colour;
use report::drawing::ticks::Scale;
use report::plots::plot::{Axis, Figure, LineStyle, Marker, Panel, Series};
use report::tables::table::Table;

/// All meshes of all problems.
pub fn table(report: &HertzReport) -> Table {
    let cases = report.cases.iter();
    let meshes = cases.flat_map(|c| c.meshes.iter().map(move |m| (c, m)));
    Table::of(meshes)
        .words("problem", |(c, _)| &c.case)
        .numbers("n", |(_, m)| m.elements)
        .numbers("dofs", |(_, m)| m.dofs)
        .numbers("nodes", |(_, m)| m.active)
        .numbers("force", |(_, m)| format!("{:.3e}", m.force))
        .numbers("a fit", |(_, m)| format!("{:.5}", m.half_width.fit))
        .numbers("a last", |(_, m)| format!("{:.5}", m.half_width.node))
        .numbers("a theory", |(_, m)| format!("{:.5}", m.half_width.theory))
        .numbers("error %", |(_, m)| {
            format!("{:+.2}", 100.0 * m.half_width.error)
        })
        .numbers("p0 fit", |(_, m)| format!("{:.5}", m.peak.fit))
        .numbers("p0 node", |(_, m)| format!("{:.5}", m.peak.node))
        .numbers("p0 theory", |(_, m)| format!("{:.5}", m.peak.theory))
        .numbers("error %", |(_, m)| format!("{:+.2}", 100.0 * m.peak.error))
        .numbers("p rms %", |(_, m)| format!("{:.2}", 100.0 * m.curve))
        .numbers("outer", |(_, m)| m.outer_iterations)
        .numbers("it", |(_, m)| m.iterations)
        .numbers("kkt", |(_, m)| format!("{:.0e}", m.kkt))
        .numbers("s", |(_, m)| format!("{:.2}", m.seconds))
        .table()
}

/// The table for terminals.
pub fn text(report: &HertzReport) -> String {
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
pub fn csv(case: &HertzProblem) -> Table {
    let meshes = case.meshes.iter();
    let nodes = meshes.flat_map(|m| m.pressure.iter().map(move |node| (m, node)));
    Table::of(nodes)
        .numbers("elements", |(m, _)| m.elements)
        .numbers("x", |(_, node)| format!("{:.12e}", node.x))
        .numbers("pressure", |(_, node)| format!("{:.12e}", node.p))
        .numbers("hertz", |(_, node)| format!("{:.12e}", node.theory))
        .table()
}

/// A figure of pressure over distance in units of the theory, and of the errors over the mesh.
pub fn figure(case: &HertzProblem) -> Figure {
    let hertz = HertzContact { a: 1.0, p0: 1.0 };
    let curve: Vec<(f64, f64)> = (0..=400)
        .map(|k| {
            let x = -1.5 + 3.0 * f64::from(k) / 400.0;
            (x, hertz.pressure(x))
        })
        .filter(|(x, _)| case.finest().pressure.iter().any(|n| n.x < 0.0) || *x >= 0.0)
        .collect();
    let mut series = vec![Series::new("Hertz", curve, Colour::CYCLE[7]).line_only()];
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
                .line(LineStyle::None),
        );
    }
    let [x, y] = ["x / a", "p / p_{0}"].map(|name| Axis::new(name, Scale::Linear));
    let pressure = Panel::new("Nodal pressure", x, y, series);
    let counts: Vec<f64> = case.meshes.iter().map(|m| m.elements as f64).collect();
    let errors = |label: &str, colour: usize, error: fn(&HertzMesh) -> f64| {
        let each = case.meshes.iter().map(|m| 100.0 * error(m).abs());
        let points = counts.iter().copied().zip(each).collect();
        Series::new(label, points, Colour::CYCLE[colour])
    };
    let limit = vec![(counts[0], 2.0), (counts[n - 1], 2.0)];
    let limit = Series::new("2 %", limit, Colour::CYCLE[7]);
    let convergence = vec![
        errors("half-width, fit", 0, |m| m.half_width.error),
        errors("peak, fit", 1, |m| m.peak.error).marker(Marker::Square, true, 4.0),
        errors("pressure, root mean square", 2, |m| m.curve).marker(Marker::Diamond, true, 4.0),
        errors("half-width, last node", 5, |m| {
            m.half_width.node / m.half_width.theory - 1.0
        })
        .marker(Marker::Circle, false, 4.0)
        .line(LineStyle::Dotted),
        errors("peak, largest node", 4, |m| {
            m.peak.node / m.peak.theory - 1.0
        })
        .marker(Marker::Square, false, 4.0)
        .line(LineStyle::Dotted),
        limit.line_only().line(LineStyle::Dashed),
    ];
    let x = Axis::new("elements per radius", Scale::Log).at(counts);
    let y = Axis::new("error in %", Scale::Log);
    let convergence = Panel::new("Distance from the theory", x, y, convergence);
    Figure::new(case.title.clone(), vec![pressure, convergence])
}
