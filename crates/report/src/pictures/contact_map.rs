//! Pressure on the faces where solids may touch: maps of the interfaces with the largest forces, and all rows as CSV.

use super::arrows::{self, Arrow};
use super::marks::{ContactMark, Touch};
use super::mesh::{bounds, PlaneMesh};
use super::paint::{axes, colour_bar, paint, sheet, View, BAR, LABELS, TEXT};
use super::pieces;
use super::values::ShownField;
use crate::drawing::canvas::{self, Anchor, Canvas, CanvasPoint, TextStyle};
use crate::drawing::raster::Raster;
use crate::drawing::ticks::{self, Scale};
use crate::interfaces::{self, InterfaceNodes};
use crate::pictures::marks;
use base::linalg::vec3::{dot, minus, norm};
use base::{Error, Result};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

/// Number of interfaces in the figure.
const SHOWN: usize = 6;
const LEFT: f64 = 66.0;
const GAP: f64 = 12.0;
/// Length of the longest arrow in logical pixels.
const LONGEST: f64 = 24.0;
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

    /// How a face touches, where all its nodes do: it slips where some slip, and sticks where others stick.
    fn touch(&self, cell: &[u32; 4]) -> Touch {
        let of = |&k: &u32| {
            let state = self.nodes.friction.get(k as usize).map(|f| f.state);
            Touch::of_state(state, self.nodes.active[k as usize])
        };
        let touches = cell.map(|k| of(&k));
        let some = |touch: Touch| touches.contains(&touch);
        match () {
            () if some(Touch::Open) => Touch::Open,
            () if some(Touch::Slips) => Touch::Slips,
            () if some(Touch::Sticks) => Touch::Sticks,
            () => Touch::Closed,
        }
    }

    /// The outlines of the faces in contact, of each kind, and of all faces that may touch.
    fn outlines(&self) -> Vec<ContactMark> {
        let boundary = |cells: &mut dyn Iterator<Item = &[u32; 4]>, touch: Touch| {
            let mut edges: HashMap<(u32, u32), usize> = HashMap::new();
            for cell in cells {
                for (a, b) in pieces::edges(*cell) {
                    *edges.entry((a.min(b), a.max(b))).or_default() += 1;
                }
            }
            let mark = |(a, b): (u32, u32)| ContactMark {
                from: self.at[a as usize],
                to: self.at[b as usize],
                touch,
            };
            let once = edges.into_iter().filter(|e| e.1 == 1);
            once.map(|e| mark(e.0)).collect::<Vec<_>>()
        };
        // A line between two kinds is drawn once, as that of the first of them.
        let mut out: Vec<ContactMark> = Vec::new();
        for touch in [Touch::Sticks, Touch::Slips, Touch::Closed, Touch::Open] {
            let is = |c: &&[u32; 4]| touch == Touch::Open || self.touch(c) == touch;
            let more = boundary(&mut self.cells.iter().filter(is), touch);
            let key = |m: &ContactMark| [m.from, m.to].map(|p| p.map(f64::to_bits));
            let drawn: HashSet<_> = out.iter().map(key).collect();
            out.extend(more.into_iter().filter(|m| !drawn.contains(&key(m))));
        }
        out
    }

    /// The shear stresses on the first body, in the directions of the map, where the sides touch.
    fn shear(&self) -> Vec<Arrow> {
        let mut done = vec![self.nodes.friction.is_empty(); self.at.len()];
        let mut out = Vec::new();
        for cell in &self.cells {
            for (corner, &k) in cell.iter().enumerate() {
                let k = k as usize;
                if std::mem::replace(&mut done[k], true) || !self.nodes.active[k] {
                    continue;
                }
                let others = [cell[(corner + 1) % 4], cell[(corner + 3) % 4]];
                let others = others.map(|o| {
                    if o as usize == k {
                        cell[(corner + 2) % 4]
                    } else {
                        o
                    }
                });
                let stress = self.in_map(k, others.map(|o| o as usize));
                let at = self.at[k];
                out.extend(stress.map(|stress| Arrow { at, stress }));
            }
        }
        out
    }

    /// The shear stress at a node in the directions of the map, which two neighbours give; it keeps its absolute value.
    fn in_map(&self, k: usize, others: [usize; 2]) -> Option<[f64; 2]> {
        let shear = self.nodes.friction[k].shear;
        let edges = others.map(|o| minus(self.nodes.points[o], self.nodes.points[k]));
        // Its components along the edges, a and b, from their scalar products.
        let [aa, ab, bb] = [[0, 0], [0, 1], [1, 1]].map(|[i, j]| dot(edges[i], edges[j]));
        let along = edges.map(|e| dot(e, shear));
        let determinant = aa * bb - ab * ab;
        let a = (bb * along[0] - ab * along[1]) / determinant;
        let b = (aa * along[1] - ab * along[0]) / determinant;
        let edge = |o: usize, c: usize| self.at[o][c] - self.at[k][c];
        let shown = [0, 1].map(|c| a * edge(others[0], c) + b * edge(others[1], c));
        let length = norm(shear) / shown[0].hypot(shown[1]);
        length.is_finite().then(|| shown.map(|s| length * s))
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
    // Arrows of one length are one stress in all maps.
    let shear: Vec<Arrow> = order.iter().flat_map(|m| m.shear()).collect();
    let largest = arrows::largest(&shear, LONGEST);
    let label = largest.map(|s| format!("shear stress, at most {}", ticks::number(s)));
    let (wide_legend, below) = marks::legend_size(&all, label.as_deref());
    let wide = (columns as f64 * cell.0).max(wide_legend);
    let content = (wide, rows as f64 * cell.1 + below);
    let (mut raster, width, top) = sheet(&title, content);
    for (k, (map, outline)) in order.iter().zip(&outlines).enumerate() {
        let at = (
            (k % columns) as f64 * cell.0,
            top + (k / columns) as f64 * cell.1,
        );
        panel(&mut raster, map, outline, largest, at);
    }
    let middle = top + rows as f64 * cell.1 + 0.5 * below - 4.0;
    marks::legend(&mut raster, &all, label.as_deref(), (0.5 * width, middle));
    raster
}

/// Draws a map with arrows for its shear stresses; the length of arrows is that of the `largest` stress of all maps.
fn panel(
    raster: &mut Raster,
    map: &ContactMap,
    outline: &[ContactMark],
    largest: Option<f64>,
    at: CanvasPoint,
) {
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
    if let Some(largest) = largest {
        arrows::draw(raster, &map.shear(), &view, LONGEST / largest);
    }
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
