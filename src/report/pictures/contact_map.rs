//! Pressure on the faces where solids may touch: maps of the interfaces with the largest forces, and all rows as CSV.

use super::marks::{self, ContactMark};
use super::outline::Mesh;
use super::paint::{axes, colour_bar, paint, sheet, View, BAR, LABELS, TEXT};
use super::values::{Field, Values};
use crate::report::drawing::canvas::{self, Anchor, Canvas, Point, TextStyle};
use crate::report::drawing::raster::Raster;
use crate::report::drawing::ticks::Scale;
use crate::report::interfaces;
use crate::report::output;
use crate::report::tables::summary::exactly;
use crate::report::tables::table::quoted;
use crate::{Error, Result};
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

/// The data of one interface, node by node.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ContactMap {
    /// `left|right` for two bodies, `left.top above` for an obstacle.
    pub name: String,
    /// The names of the coordinates `at`, such as `x` and `z`.
    pub labels: [String; 2],
    /// Position of the node in the map.
    pub at: Vec<[f64; 2]>,
    /// Faces of elements: four nodes each, in the order around the face.
    pub cells: Vec<[u32; 4]>,
    /// Parameters along the face.
    pub t: Vec<[f64; 2]>,
    /// Position in space.
    pub points: Vec<[f64; 3]>,
    /// Remaining distance between the sides.
    pub gap: Vec<f64>,
    /// Force at the node; positive where the sides press against each other.
    pub multiplier: Vec<f64>,
    /// The nodal area: the part of the side that belongs to the node.
    pub area: Vec<f64>,
    /// Whether the sides touch.
    pub active: Vec<bool>,
}

impl ContactMap {
    fn check(&self) -> Result<()> {
        let n = self.at.len();
        let lists = [
            (self.t.len(), "parameters"),
            (self.points.len(), "points"),
            (self.gap.len(), "gaps"),
            (self.multiplier.len(), "multipliers"),
            (self.area.len(), "areas"),
            (self.active.len(), "states"),
        ];
        interfaces::check_lengths(&self.name, n, "nodes", &lists)?;
        match self.cells.iter().flatten().find(|&&k| k as usize >= n) {
            Some(bad) => Err(Error::input(format!(
                "the interface '{}' has a face with node {bad}, expected one below {n}",
                self.name
            ))),
            None => Ok(()),
        }
    }

    /// Force per area by node; NaN where a node has no area.
    pub fn pressure(&self) -> Vec<f64> {
        interfaces::pressure(&self.multiplier, &self.area)
    }

    /// Sum of the multipliers.
    fn force(&self) -> f64 {
        self.multiplier.iter().sum()
    }

    /// The outlines of the faces in contact, and of all faces that may touch.
    fn outlines(&self) -> Vec<ContactMark> {
        let closed = |cell: &[u32; 4]| cell.iter().all(|&k| self.active[k as usize]);
        let boundary = |cells: &mut dyn Iterator<Item = &[u32; 4]>, closed: bool| {
            let mut edges: HashMap<(u32, u32), usize> = HashMap::new();
            for cell in cells {
                for k in 0..4 {
                    let (a, b) = (cell[k], cell[(k + 1) % 4]);
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

/// Writes `interfaces.png` and `interfaces.csv` into a directory; returns their paths. The CSV has all interfaces:
/// name, t, s (the second parameter), x, y, z, gap, multiplier, active (0 or 1), pressure, area.
///
/// # Errors
/// [`Error::Input`] when the arrays of an interface differ in length; [`Error::Environment`] with the path.
pub fn write(maps: &[ContactMap], title: &str, dir: &Path) -> Result<Vec<PathBuf>> {
    maps.iter().try_for_each(ContactMap::check)?;
    let png = dir.join("interfaces.png");
    draw(maps, title).write_png(&png)?;
    let csv = dir.join("interfaces.csv");
    output::write_file(&csv, |out| {
        writeln!(out, "name,t,s,x,y,z,gap,multiplier,active,pressure,area")?;
        for m in maps {
            let (name, pressure) = (quoted(&m.name), m.pressure());
            for (k, pressure) in pressure.into_iter().enumerate() {
                let ([t, s], [x, y, z]) = (m.t[k], m.points[k]);
                let first = [t, s, x, y, z, m.gap[k], m.multiplier[k]].map(|v| exactly(Some(v)));
                let last = [pressure, m.area[k]].map(|v| exactly(Some(v)));
                let active = u8::from(m.active[k]);
                writeln!(
                    out,
                    "{name},{},{active},{}",
                    first.join(","),
                    last.join(",")
                )?;
            }
        }
        Ok(())
    })?;
    Ok(vec![png, csv])
}

/// The maps of the interfaces with the largest forces; an interface without faces has none.
fn draw(maps: &[ContactMap], title: &str) -> Raster {
    let known = maps.iter().filter(|m| !m.cells.is_empty());
    let (order, title) = interfaces::largest(known, ContactMap::force, SHOWN, title);
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

fn panel(raster: &mut Raster, map: &ContactMap, outline: &[ContactMark], at: Point) {
    let zeros = vec![0; map.cells.len()];
    let mesh = Mesh {
        points: &map.at,
        quads: &map.cells,
        body: &zeros,
        subdomain: &zeros,
    };
    let (low, high) = mesh.bounds();
    let size = [0, 1].map(|d| (high[d] - low[d]).max(1e-300));
    let scale = (PANEL.0 / size[0]).min(PANEL.1 / size[1]);
    let (w, h) = (scale * size[0], scale * size[1]);
    let view = View {
        low,
        scale,
        origin: (at.0 + LEFT, at.1 + 2.4 * TEXT + h),
    };
    let name = canvas::shortened(
        &format!("{}: pressure", map.name),
        TEXT,
        true,
        PANEL.0 + LABELS,
    );
    let middle = (view.origin.0 + 0.5 * w.max(120.0), at.1 + 1.2 * TEXT);
    raster.text(middle, &name, &TextStyle::title(TEXT));
    let pressure = map.pressure();
    let field = Field {
        title: "pressure",
        values: Values::Nodal(&pressure),
        scale: Scale::Linear,
    };
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
mod tests {
    use super::*;
    use crate::report::output::tests::Scratch;

    /// An interface of n × n elements on the unit square with pressure max(1 − 4 r², 0) around its middle.
    fn sample(name: &str, n: usize, size: f64) -> ContactMap {
        let at: Vec<[f64; 2]> = (0..(n + 1) * (n + 1))
            .map(|k| [k % (n + 1), k / (n + 1)].map(|i| i as f64 / n as f64))
            .collect();
        let pressure = |p: &[f64; 2]| {
            let r = (p[0] - 0.5).powi(2) + (p[1] - 0.5).powi(2);
            size * (1.0 - 8.0 * r).max(0.0)
        };
        let edge = |x: f64| if x == 0.0 || x == 1.0 { 0.5 } else { 1.0 };
        let area: Vec<f64> = at
            .iter()
            .map(|p| edge(p[0]) * edge(p[1]) / (n * n) as f64)
            .collect();
        let multiplier = at.iter().zip(&area).map(|(p, a)| pressure(p) * a).collect();
        let cell = |k: usize| {
            let a = (k / n * (n + 1) + k % n) as u32;
            [a, a + 1, a + n as u32 + 2, a + n as u32 + 1]
        };
        ContactMap {
            name: name.into(),
            labels: ["x".into(), "z".into()],
            cells: (0..n * n).map(cell).collect(),
            t: at.clone(),
            points: at.iter().map(|p| [p[0], 1.0, p[1]]).collect(),
            gap: vec![0.0; at.len()],
            multiplier,
            active: at.iter().map(|p| pressure(p) > 0.0).collect(),
            area,
            at,
        }
    }

    #[test]
    fn pressure_is_force_over_area() {
        let map = sample("a|b", 8, 3.0);
        let largest = map.pressure().into_iter().fold(0.0, f64::max);
        assert!((largest - 3.0).abs() < 1e-12);
        let mut corner = map.clone();
        corner.area[0] = 0.0;
        assert!(corner.pressure()[0].is_nan());
    }

    #[test]
    fn outlines_run_around_the_zone_and_the_face() {
        let map = sample("a|b", 8, 1.0);
        let outline = map.outlines();
        let length = |closed: bool| -> f64 {
            let these = outline.iter().filter(|m| m.closed == closed);
            these
                .map(|m| (m.to[0] - m.from[0]).hypot(m.to[1] - m.from[1]))
                .sum()
        };
        // Nodes with r² < 1/8 around the middle: a cross of 4 × 4 cells without its corners, whose outline is as long
        // as the square's.
        assert!(
            (length(true) - 16.0 / 8.0).abs() < 1e-12,
            "{}",
            length(true)
        );
        assert!((length(false) - 4.0).abs() < 1e-12);
    }

    #[test]
    fn files_hold_everything_and_misfits_are_refused() {
        let dir = Scratch::new("contact-map");
        let maps: Vec<ContactMap> = (1..=8)
            .map(|k| sample(&format!("i{k}"), 3, f64::from(k)))
            .collect();
        let paths = write(&maps, "eight", &dir.0).unwrap();
        let csv = std::fs::read_to_string(&paths[1]).unwrap();
        let lines: Vec<&str> = csv.lines().collect();
        assert_eq!(lines.len(), 1 + 8 * 16);
        assert_eq!(
            lines[0],
            "name,t,s,x,y,z,gap,multiplier,active,pressure,area"
        );
        assert!(
            lines[1].starts_with("i1,0,0,0,1,0,0,0,0,0,"),
            "{}",
            lines[1]
        );
        write(&[], "", &dir.0).unwrap();
        let mut bad = sample("bad", 2, 1.0);
        bad.area.pop();
        let message = write(&[bad.clone()], "", &dir.0).unwrap_err().to_string();
        assert!(message.contains("'bad' lists 8 areas"), "{message}");
        bad.area.push(1.0);
        bad.cells[0][0] = 9;
        let message = write(&[bad], "", &dir.0).unwrap_err().to_string();
        assert!(message.contains("node 9"), "{message}");
    }
}
