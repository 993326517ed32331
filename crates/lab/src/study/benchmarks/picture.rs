//! The results of the study: tables, and pictures of pressures and errors.

use super::{BenchmarkReport, BenchmarksReport, MeasuredValue, MeshResult, MeshSeries};
use report::drawing::canvas::Colour;
use report::drawing::ticks::Scale;
use report::plots::plot::{Axis, Figure, LineStyle, Marker, Panel, Series as Curve};
use report::tables::table::{condition, scientific, value, Table};

/// The names of the columns of a case and its rows.
fn cells(case: &BenchmarkReport) -> (Vec<String>, Vec<Vec<String>>) {
    let mut quantities: Vec<&MeasuredValue> = Vec::new();
    for v in case.meshes().flat_map(|m| &m.values) {
        if quantities.iter().all(|q| q.quantity != v.quantity) {
            quantities.push(v);
        }
    }
    let mut names: Vec<String> = ["series", "mesh", "dofs"].map(String::from).to_vec();
    for q in &quantities {
        match q.reference {
            Some(_) => names.extend([q.quantity.clone(), "reference".into(), "error".into()]),
            None => names.push(q.quantity.clone()),
        }
    }
    names.extend(["limit", "it", "κ", "steps", "s"].map(String::from));
    let row = |s: &MeshSeries, m: &MeshResult| {
        let mut row = vec![s.name.clone(), m.mesh.clone(), m.dofs.to_string()];
        for q in &quantities {
            let found = m.values.iter().find(|v| v.quantity == q.quantity);
            let error = found.map_or(String::new(), |v| scientific(Some(v.error)));
            if q.reference.is_some() {
                for x in [found.and_then(|v| v.ours), found.and_then(|v| v.reference)] {
                    row.push(x.map_or(String::new(), value));
                }
            }
            row.push(error);
        }
        // That of the first value; JSON has all.
        let limit = m.values.first().and_then(|v| v.limit);
        row.extend([
            scientific(limit),
            m.iterations.to_string(),
            condition(m.condition),
            m.outer_iterations.to_string(),
            format!("{:.2}", m.seconds),
        ]);
        row
    };
    let rows = case
        .series
        .iter()
        .flat_map(|s| s.meshes.iter().map(move |m| (s, m)));
    let rows = rows.map(|(s, m)| row(s, m)).collect();
    (names, rows)
}

/// All meshes of a case.
pub fn table(case: &BenchmarkReport) -> Table {
    let (names, rows) = cells(case);
    let mut columns = Table::of(rows);
    for (k, name) in names.into_iter().enumerate() {
        columns = if k < 2 {
            columns.words(name, |row| row[k].clone())
        } else {
            columns.numbers(name, |row| row[k].clone())
        };
    }
    columns.table()
}

/// The remarks on a case beside its table.
fn remarks(case: &BenchmarkReport) -> String {
    let orders = case.series.iter();
    let orders: Vec<String> = orders
        .filter_map(|s| Some(format!("{} {:.2}", s.name, s.order?)))
        .collect();
    let mut out = String::new();
    if !orders.is_empty() {
        let what = &case.series[0].meshes[0].values[0].quantity;
        out += &format!("Order of convergence ({what}): {}.\n", orders.join("; "));
    }
    for why in &case.skipped {
        out += &format!("Not run: {why}.\n");
    }
    out
}

/// The tables for terminals.
pub fn text(report: &BenchmarksReport) -> String {
    let mut out = String::new();
    for case in &report.cases {
        out += &format!(
            "{}: {}\nReference: {}\n{}{}\n",
            case.case,
            case.title,
            case.reference,
            table(case),
            remarks(case)
        );
    }
    let missed = report.missed();
    out += &if missed.is_empty() {
        "All tolerances are kept.\n".to_string()
    } else {
        format!("Tolerances that are missed:\n{}\n", missed.join("\n"))
    };
    out
}

/// The tables for a page.
pub fn markdown(report: &BenchmarksReport) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let mut out = String::new();
    for case in &report.cases {
        let (names, rows) = cells(case);
        out += &format!(
            "## {}\n\n{}.\nReference: {}.\n\n",
            case.case, case.title, case.reference
        );
        out += &line(&names);
        out += &line(&vec!["---".to_string(); names.len()]);
        rows.iter().for_each(|row| out += &line(row));
        out += &format!("\n{}\n", remarks(case));
    }
    out
}

/// The pressure on the finest mesh of every series beside the reference, and the error of the first value over the mesh
/// size; `None` for a case without pressures along a line.
pub fn figure(case: &BenchmarkReport) -> Option<Figure> {
    let finest = |s: &'_ MeshSeries| s.meshes.last().filter(|m| !m.curve.is_empty()).cloned();
    let with_curve: Vec<(usize, MeshResult)> = (case.series.iter().enumerate())
        .filter_map(|(k, s)| Some((k, finest(s)?)))
        .collect();
    with_curve.last()?;
    // Series that differ in the order of elements alone have one reference.
    let problem = |s: &MeshSeries| {
        s.name
            .split_once(", order")
            .map_or("", |(p, _)| p)
            .to_string()
    };
    let mut references: Vec<(String, Vec<(f64, f64)>)> = Vec::new();
    for series in &case.series {
        let nodes = series.meshes.iter().flat_map(|m| &m.curve);
        let points = nodes.map(|n| (n.x, n.reference));
        let name = problem(series);
        match references.iter_mut().find(|(known, _)| *known == name) {
            Some((_, known)) => known.extend(points),
            None => references.push((name, points.collect())),
        }
    }
    let reference = |(_, mut points): (String, Vec<(f64, f64)>)| {
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Curve::new("reference", points, Colour::CYCLE[7]).line_only()
    };
    let mut curves: Vec<Curve> = references.into_iter().map(reference).collect();
    let markers = [
        Marker::Circle,
        Marker::Square,
        Marker::Triangle,
        Marker::Diamond,
    ];
    let style = |k: usize| (markers[k % 4], Colour::CYCLE[k % 7]);
    for (k, mesh) in &with_curve {
        let (marker, colour) = style(*k);
        let points = mesh.curve.iter().map(|n| (n.x, n.p)).collect();
        let size = if k % 2 == 0 { 3.6 } else { 2.4 };
        curves.push(
            Curve::new(case.series[*k].name.clone(), points, colour)
                .marker(marker, k % 2 == 1, size)
                .line(LineStyle::None),
        );
    }
    let across = match case.case.as_str() {
        "rings" | "shrink-fit" | "belt" => "θ in degrees",
        "bar" => "x",
        _ => "x / a",
    };
    let ordinate = match case.case.as_str() {
        "rings" | "shrink-fit" | "punch" => "p / mean",
        "mindlin-cylinder" | "mindlin-sphere" | "roller-friction" => "τ / μ p_{0}",
        "bar" => "τ / μ p",
        "belt" => "τ R / μ T_{1}",
        _ => "p / p_{0}",
    };
    let [x, y] = [across, ordinate].map(|name| Axis::new(name, Scale::Linear));
    let kind = if ordinate.starts_with('τ') {
        "Shear stress"
    } else {
        "Pressure"
    };
    let pressure = Panel::new(format!("{kind}, finest meshes"), x, y, curves);
    let mut errors = Vec::new();
    let mut sizes = Vec::new();
    for (k, s) in case.series.iter().enumerate() {
        let of = |m: &MeshResult| Some((m.size, m.values.first()?.error.abs()));
        let points: Vec<(f64, f64)> = s.meshes.iter().filter_map(of).collect();
        sizes.extend(points.iter().map(|p| p.0));
        let (marker, colour) = style(k);
        errors.push(Curve::new(s.name.clone(), points, colour).marker(marker, k % 2 == 1, 4.0));
    }
    let what = &case.series[0].meshes[0].values[0].quantity;
    let panel = Panel::new(
        format!("Error: {what}"),
        Axis::new("mesh size", Scale::Log),
        Axis::new("relative error", Scale::Log),
        errors,
    );
    let mut figure = Figure::new("", vec![pressure, panel]);
    figure.panel_size = (400.0, 330.0);
    Some(figure)
}
