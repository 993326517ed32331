//! Load steps: a figure of energy, contact force and active rows over time, and all data as CSV.

use super::plot::{Axis, Figure, Marker, Panel, Series};
use crate::drawing::canvas::Colour;
use crate::drawing::ticks::Scale;
use crate::json::contact::LoadStep;
use crate::tables::table::Table;
use base::Result;
use std::path::{Path, PathBuf};

/// Up to this number of steps, each gets a marker.
const MARKED: usize = 60;

/// The figure.
pub fn figure(steps: &[LoadStep], title: &str) -> Figure {
    let panel = |label: &str, colour: usize, value: fn(&LoadStep) -> f64| {
        let points = steps.iter().map(|s| (s.t, value(s))).collect();
        let marker = if steps.len() <= MARKED {
            Marker::Circle
        } else {
            Marker::None
        };
        let series = Series::new("", points, Colour::CYCLE[colour]).marker(marker, true, 3.0);
        let [x, y] = ["t", ""].map(|name| Axis::new(name, Scale::Linear));
        Panel::new(label, x, y, vec![series])
    };
    let mut figure = Figure::new(
        title,
        vec![
            panel("energy", 0, |s| s.energy),
            panel("contact force", 1, |s| s.contact_force),
            panel("active inequalities", 2, |s| s.active as f64),
        ],
    );
    // A count starts at zero and has no fractions.
    let most = steps.iter().map(|s| s.active).max().unwrap_or(0).max(1);
    let count = &mut figure.panels[2].y;
    count.range = Some((0.0, 1.08 * most as f64));
    count.ticks = counts(most);
    figure.panel_size = (330.0, 270.0);
    figure
}

/// At most seven round whole numbers from 0 to `most`.
fn counts(most: usize) -> Vec<f64> {
    let decades = (0..).map(|k| 10_usize.pow(k));
    let step = decades
        .flat_map(|d| [d, 2 * d, 5 * d])
        .find(|step| most / step <= 6)
        .unwrap_or(most);
    (0..=most / step).map(|k| (k * step) as f64).collect()
}

/// The table for programs: full precision, empty cells for unknown values.
pub fn csv(steps: &[LoadStep]) -> Table {
    Table::of(steps)
        .exact("t", |s| s.t)
        .exact("outer_iterations", |s| s.outer_iterations)
        .exact("iterations", |s| s.iterations)
        .exact("active", |s| s.active)
        .exact("energy", |s| s.energy)
        .exact("contact_force", |s| s.contact_force)
        .table()
}

/// Writes `steps.png`, `steps.svg` and `steps.csv` into a directory; returns their paths.
///
/// # Errors
/// [`base::ErrorKind::Environment`] with the path.
pub fn write(steps: &[LoadStep], title: &str, dir: &Path) -> Result<Vec<PathBuf>> {
    let mut paths = figure(steps, title).save(&dir.join("steps"))?;
    let table = dir.join("steps.csv");
    csv(steps).write_csv(&table)?;
    paths.push(table);
    Ok(paths)
}

#[cfg(test)]
#[path = "../../tests/plots/load_steps.rs"]
mod tests;
