//! Painting a field on a mesh of quadrilaterals: its position in the picture, cells, axes and colour bar.

use super::mesh::PlaneMesh;
use super::values::ShownField;
use crate::drawing::canvas::{self, Anchor, Canvas, CanvasPoint, Colour, TextStyle};
use crate::drawing::colormap::viridis;
use crate::drawing::raster::{self, Raster};
use crate::drawing::ticks::{self, Scale};

const TICK_TEXT: f64 = 11.5;

/// Width of the colour bar in logical pixels.
pub(super) const BAR: f64 = 14.0;

pub(super) const TEXT: f64 = 13.0;
/// Between the entries of a legend.
const ENTRY_GAP: f64 = 26.0;
const TITLE_TEXT: f64 = 15.0;
/// Width for the numbers at a colour bar.
pub(super) const LABELS: f64 = 74.0;

/// An empty picture with a title, for content of this size: the picture, its width, and the top of the content.
pub(super) fn sheet(title: &str, (width, height): (f64, f64)) -> (Raster, f64, f64) {
    let width = width.max(canvas::text_width(title, TITLE_TEXT, true) + 24.0);
    if title.is_empty() {
        return (Raster::new(width, 6.0 + height, 2.0), width, 6.0);
    }
    let top = 2.3 * TITLE_TEXT;
    let mut raster = Raster::new(width, top + height, 2.0);
    let at = (0.5 * width, 1.25 * TITLE_TEXT);
    raster.text(at, title, &TextStyle::title(TITLE_TEXT));
    (raster, width, top)
}

/// Draws samples of one width with their labels, side by side around a point; `draw` draws a sample to the right of a
/// point.
pub(super) fn legend<T>(
    raster: &mut Raster,
    entries: &[(T, &str)],
    sample: f64,
    middle: CanvasPoint,
    draw: impl Fn(&mut Raster, CanvasPoint, &T),
) {
    let mut x = middle.0 - 0.5 * legend_width(entries, sample);
    for (what, label) in entries {
        draw(raster, (x, middle.1), what);
        let style = TextStyle::new(TEXT, Anchor::Start);
        raster.text((x + sample + 8.0, middle.1), label, &style);
        x += entry_width(label, sample) + ENTRY_GAP;
    }
}

/// Width of the samples with their labels.
pub(super) fn legend_width<T>(entries: &[(T, &str)], sample: f64) -> f64 {
    let total: f64 = entries.iter().map(|e| entry_width(e.1, sample)).sum();
    total + ENTRY_GAP * entries.len().saturating_sub(1) as f64
}

fn entry_width(label: &str, sample: f64) -> f64 {
    sample + 8.0 + canvas::text_width(label, TEXT, false)
}

/// The position of the mesh in the picture.
pub(super) struct View {
    pub low: [f64; 2],
    pub scale: f64,
    pub origin: CanvasPoint,
}

impl View {
    /// The position of a point in logical pixels; y grows upwards in the mesh and downwards in the picture.
    pub fn place(&self, p: [f64; 2]) -> CanvasPoint {
        (
            self.origin.0 + self.scale * (p[0] - self.low[0]),
            self.origin.1 - self.scale * (p[1] - self.low[1]),
        )
    }

    /// Draws a polyline of the mesh.
    pub fn line(&self, raster: &mut Raster, points: &[[f64; 2]], width: f64, colour: Colour) {
        let points: Vec<CanvasPoint> = points.iter().map(|&p| self.place(p)).collect();
        raster.line(&points, width, colour, &[]);
    }
}

/// Paints all cells. Each is divided into four triangles around its centre, with linear interpolation on each.
pub(super) fn paint(
    raster: &mut Raster,
    mesh: &PlaneMesh,
    field: &ShownField,
    range: (f64, f64),
    view: &View,
) {
    let s = raster.scale();
    let shade = field.colour(range);
    for (cell, quad) in mesh.corners.iter().enumerate() {
        let corner = quad.map(|p| {
            let (x, y) = view.place(mesh.shown[p as usize]);
            [x * s, y * s]
        });
        let value = field.at(cell, *quad);
        let centre = [0, 1].map(|d| corner.iter().map(|c| c[d]).sum::<f64>() / 4.0);
        let mean = value.iter().sum::<f64>() / 4.0;
        for k in 0..4 {
            let l = (k + 1) % 4;
            let v = [value[k], value[l], mean];
            let size = raster.size();
            raster::triangle([corner[k], corner[l], centre], size, |x, y, a, b| {
                raster.set(x, y, shade(v[0] + a * (v[1] - v[0]) + b * (v[2] - v[0])));
            });
        }
    }
}

/// Draws ticks along the lower and the left side.
pub(super) fn axes(raster: &mut Raster, view: &View, low: [f64; 2], high: [f64; 2]) {
    let wanted = |length: f64| ((length * view.scale / 70.0) as usize).clamp(1, 8);
    let y = view.origin.1 + 2.0;
    for t in ticks::ticks(low[0], high[0], Scale::Linear, wanted(high[0] - low[0])) {
        let x = view.place([t.at, low[1]]).0;
        raster.line(&[(x, y), (x, y + 4.0)], 1.0, Colour::INK, &[]);
        raster.text(
            (x, y + 12.0),
            &t.label,
            &TextStyle::new(TICK_TEXT, Anchor::Middle),
        );
    }
    let x = view.origin.0 - 2.0;
    for t in ticks::ticks(low[1], high[1], Scale::Linear, wanted(high[1] - low[1])) {
        let y = view.place([low[0], t.at]).1;
        raster.line(&[(x - 4.0, y), (x, y)], 1.0, Colour::INK, &[]);
        raster.text(
            (x - 7.0, y),
            &t.label,
            &TextStyle::new(TICK_TEXT, Anchor::End),
        );
    }
}

/// Draws the colour bar with its numbers.
pub(super) fn colour_bar(
    raster: &mut Raster,
    at: CanvasPoint,
    height: f64,
    range: (f64, f64),
    scale: Scale,
) {
    let steps = 256;
    for k in 0..steps {
        // Each strip extends under the next one, so that no background shows between them.
        let (a, b) = (
            f64::from(k) / f64::from(steps),
            f64::from((k + 2).min(steps)) / f64::from(steps),
        );
        let (ya, yb) = (at.1 - a * height, at.1 - b * height);
        let strip = [(at.0, ya), (at.0 + BAR, ya), (at.0 + BAR, yb), (at.0, yb)];
        raster.polygon(&strip, viridis((f64::from(k) + 0.5) / f64::from(steps)));
    }
    let corners = [
        (0.0, 0.0),
        (BAR, 0.0),
        (BAR, -height),
        (0.0, -height),
        (0.0, 0.0),
    ];
    raster.line(
        &corners.map(|c| (at.0 + c.0, at.1 + c.1)),
        0.8,
        Colour::INK,
        &[],
    );
    let (low, high) = (scale.forward(range.0), scale.forward(range.1));
    for t in ticks::ticks(
        range.0,
        range.1,
        scale,
        ((height / 32.0) as usize).clamp(2, 7),
    ) {
        let y = at.1 - height * (scale.forward(t.at) - low) / (high - low);
        let length = if t.label.is_empty() { 2.5 } else { 4.0 };
        raster.line(
            &[(at.0 + BAR, y), (at.0 + BAR + length, y)],
            1.0,
            Colour::INK,
            &[],
        );
        raster.text(
            (at.0 + BAR + 7.0, y),
            &t.label,
            &TextStyle::new(TICK_TEXT, Anchor::Start),
        );
    }
}
