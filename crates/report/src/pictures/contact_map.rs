//! Pressure on the faces where solids may touch: maps of the interfaces with the largest forces, and all rows as CSV.

use super::marks::ContactMark;
use super::mesh::{bounds, PlaneMesh};
use super::paint::{axes, colour_bar, paint, sheet, View, BAR, LABELS, TEXT};
use super::pieces;
use super::values::ShownField;
use crate::drawing::canvas::{self, Anchor, Canvas, CanvasPoint, TextStyle};
use crate::drawing::raster::Raster;
use crate::drawing::ticks::Scale;
use crate::interfaces::{self, InterfaceNodes};
use crate::pictures::marks;
use base::{Error, Result};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Number of interfaces in the figure.
const SHOWN: usize = 6;
const LEFT: f64 = 66.0;
const GAP: f64 = 12.0;
/// Largest size of a map.
const PANEL: (f64, f64) = (300.0, 260.0);
/// Height below a map, for numbers and the name of the axis.
const BELOW: f64 = 44.0;

/// An interface of solids.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ContactMap {
    /// Its nodes, with areas.
    pub nodes: InterfaceNodes,
    /// The names of the coordinates `at`, such as `x` and `z`.
    pub labels: [String; 2],
    /// Position of the node in the map.
    pub at: Vec<[f64; 2]>,
    /// Faces of elements: four nodes each, in the order around the face; a triangle repeats its last one.
    pub cells: Vec<[u32; 4]>,
}

impl ContactMap {
    fn check(&self) -> Result<()> {
        let more = [
            (self.at.len(), "positions"),
            (self.nodes.area.len(), "areas"),
        ];
        self.nodes.check(&more)?;
        let n = self.at.len();
        match self.cells.iter().flatten().find(|&&k| k as usize >= n) {
            Some(bad) => Err(Error::input(format!(
                "the interface '{}' has a face with node {bad}, expected one below {n}",
                self.nodes.name
            ))),
            None => Ok(()),
        }
    }

    /// The outlines of the faces in contact, and of all faces that may touch.
    fn outlines(&self) -> Vec<ContactMark> {
        let closed = |cell: &[u32; 4]| cell.iter().all(|&k| self.nodes.active[k as usize]);
        let boundary = |cells: &mut dyn Iterator<Item = &[u32; 4]>, closed: bool| {
            let mut edges: HashMap<(u32, u32), usize> = HashMap::new();
            for cell in cells {
                for (a, b) in pieces::edges(*cell) {
                    *edges.entry((a.min(b), a.max(b))).or_default() += 1;
                }
            }
            let mark = |(a, b): (u32, u32)| ContactMark {
                from: self.at[a as usize],
                to: self.at[b as usize],
                closed,
            };
            let once = edges.into_iter().filter(|e| e.1 == 1);
            once.map(|e| mark(e.0)).collect::<Vec<_>>()
        };
        let mut out = boundary(&mut self.cells.iter().filter(|c| closed(c)), true);
        let touching = out.clone();
        let whole = boundary(&mut self.cells.iter(), false);
        let same = |a: &ContactMark, b: &ContactMark| a.from == b.from && a.to == b.to;
        out.extend(
            whole
                .into_iter()
                .filter(|m| !touching.iter().any(|t| same(t, m))),
        );
        out
    }
}

/// Writes `interfaces.png` and `interfaces.csv` into a directory; returns their paths. The CSV has all interfaces.
///
/// # Errors
/// [`ErrorKind::Input`](base::ErrorKind::Input) when the lists of an interface differ in length;
/// [`ErrorKind::Environment`](base::ErrorKind::Environment) with the path.
pub fn write(maps: &[ContactMap], title: &str, dir: &Path) -> Result<Vec<PathBuf>> {
    maps.iter().try_for_each(ContactMap::check)?;
    let [png, csv] = ["interfaces.png", "interfaces.csv"].map(|name| dir.join(name));
    draw(maps, title).write_png(&png)?;
    interfaces::csv(maps.iter().map(|m| &m.nodes), true).write_csv(&csv)?;
    Ok(vec![png, csv])
}

/// The maps of the interfaces with the largest forces; an interface without faces has none.
fn draw(maps: &[ContactMap], title: &str) -> Raster {
    let known = maps.iter().filter(|m| !m.cells.is_empty());
    let (order, title) = interfaces::largest(known, |m| &m.nodes, SHOWN, title);
    let columns = match order.len() {
        0 | 1 => 1,
        2 | 4 => 2,
        _ => 3,
    };
    let rows = order.len().div_ceil(columns).max(1);
    let outlines: Vec<Vec<ContactMark>> = order.iter().map(|m| m.outlines()).collect();
    let all: Vec<ContactMark> = outlines.iter().flatten().copied().collect();
    let cell = (
        LEFT + PANEL.0 + GAP + BAR + LABELS,
        2.4 * TEXT + PANEL.1 + BELOW,
    );
    let below = marks::legend_height(&all);
    let content = (columns as f64 * cell.0, rows as f64 * cell.1 + below);
    let (mut raster, width, top) = sheet(&title, content);
    for (k, (map, outline)) in order.iter().zip(&outlines).enumerate() {
        let at = (
            (k % columns) as f64 * cell.0,
            top + (k / columns) as f64 * cell.1,
        );
        panel(&mut raster, map, outline, at);
    }
    let middle = top + rows as f64 * cell.1 + 0.5 * below - 4.0;
    marks::legend(&mut raster, &all, (0.5 * width, middle));
    raster
}

fn panel(raster: &mut Raster, map: &ContactMap, outline: &[ContactMark], at: CanvasPoint) {
    let zeros = vec![0; map.cells.len()];
    let mesh = PlaneMesh {
        points: &map.at,
        shown: &map.at,
        corners: &map.cells,
        body: &zeros,
        subdomain: &zeros,
    };
    let [low, high] = bounds(map.at.iter().copied());
    let size = [0, 1].map(|d| (high[d] - low[d]).max(1e-300));
    let scale = (PANEL.0 / size[0]).min(PANEL.1 / size[1]);
    let (w, h) = (scale * size[0], scale * size[1]);
    let view = View {
        low,
        scale,
        origin: (at.0 + LEFT, at.1 + 2.4 * TEXT + h),
    };
    let name = canvas::shortened(
        &format!("{}: pressure", map.nodes.name),
        TEXT,
        true,
        PANEL.0 + LABELS,
    );
    let middle = (view.origin.0 + 0.5 * w.max(120.0), at.1 + 1.2 * TEXT);
    raster.text(middle, &name, &TextStyle::title(TEXT));
    let pressure = map.nodes.shown_pressure();
    let field = ShownField::nodal("pressure", &pressure);
    // The range always contains zero, the value outside contact.
    let (least, most) = field.range();
    let range = match (least, most) {
        (a, b) if a >= 0.0 && b > 0.0 && pressure.iter().any(|&p| p > 0.0) => (0.0, b),
        _ if pressure.iter().all(|p| p.is_nan() || *p == 0.0) => (0.0, 1.0),
        other => other,
    };
    paint(raster, &mesh, &field, range, &view);
    marks::draw(raster, outline, &view, 100.0);
    axes(raster, &view, low, high);
    let label = TextStyle::new(TEXT, Anchor::Middle);
    let (x, y) = view.origin;
    raster.text((x + 0.5 * w, y + 32.0), &map.labels[0], &label);
    raster.text((x - 44.0, y - 0.5 * h), &map.labels[1], &label);
    colour_bar(raster, (x + w + GAP, y), h.max(90.0), range, Scale::Linear);
}

#[cfg(test)]
#[path = "../../tests/pictures/contact_map.rs"]
mod tests;
