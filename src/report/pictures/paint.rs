//! Painting a field on a mesh of quadrilaterals: where it lies in the picture, its cells, axes and colour bar.

use super::field::{Field, Values};
use super::outline::Mesh;
use crate::report::drawing::canvas::{Anchor, Canvas, Colour, Point, TextStyle};
use crate::report::drawing::colormap::viridis;
use crate::report::drawing::raster::Raster;
use crate::report::drawing::ticks::{self, Scale};

const TICK_TEXT: f64 = 11.5;

/// Width of the colour bar in logical pixels.
pub(super) const BAR: f64 = 14.0;

/// Where the mesh lies in the picture.
pub(super) struct View {
    pub low: [f64; 2],
    pub scale: f64,
    pub origin: Point,
}

impl View {
    /// Logical pixels of a point; y grows upwards in the mesh and downwards in the picture.
    pub fn place(&self, p: [f64; 2]) -> Point {
        (
            self.origin.0 + self.scale * (p[0] - self.low[0]),
            self.origin.1 - self.scale * (p[1] - self.low[1]),
        )
    }
}

/// Paints all cells: each as four triangles around its centre, linear on each of them.
pub(super) fn paint(
    raster: &mut Raster,
    mesh: &Mesh,
    field: &Field,
    range: (f64, f64),
    view: &View,
) {
    let s = raster.scale();
    let (low, high) = (field.scale.forward(range.0), field.scale.forward(range.1));
    let shade = |v: f64| {
        if field.scale.shows(v) {
            viridis((field.scale.forward(v) - low) / (high - low))
        } else {
            viridis(f64::NAN)
        }
    };
    for (cell, quad) in mesh.quads.iter().enumerate() {
        let corner = quad.map(|p| {
            let (x, y) = view.place(mesh.points[p as usize]);
            (x * s, y * s)
        });
        let value = match field.values {
            Values::Nodal(v) => quad.map(|p| v[p as usize]),
            Values::Cell(v) => [v[cell]; 4],
        };
        let centre = (
            corner.iter().map(|c| c.0).sum::<f64>() / 4.0,
            corner.iter().map(|c| c.1).sum::<f64>() / 4.0,
        );
        let mean = value.iter().sum::<f64>() / 4.0;
        for k in 0..4 {
            let l = (k + 1) % 4;
            triangle(
                raster,
                [corner[k], corner[l], centre],
                [value[k], value[l], mean],
                &shade,
            );
        }
    }
}

/// Paints the pixels whose centres lie in a triangle given in real pixels.
fn triangle(raster: &mut Raster, p: [Point; 3], v: [f64; 3], shade: &impl Fn(f64) -> Colour) {
    let det = (p[1].0 - p[0].0) * (p[2].1 - p[0].1) - (p[2].0 - p[0].0) * (p[1].1 - p[0].1);
    if det == 0.0 || !det.is_finite() {
        return;
    }
    let (w, h) = raster.size();
    let bound = |c: [f64; 3], limit: usize| {
        let low = c[0].min(c[1]).min(c[2]) - 0.5;
        let high = c[0].max(c[1]).max(c[2]) - 0.5;
        (
            low.ceil().max(0.0) as usize,
            (high.floor().max(-1.0) + 1.0).min(limit as f64) as usize,
        )
    };
    let (x0, x1) = bound(p.map(|q| q.0), w);
    let (y0, y1) = bound(p.map(|q| q.1), h);
    for y in y0..y1 {
        for x in x0..x1 {
            let (dx, dy) = (x as f64 + 0.5 - p[0].0, y as f64 + 0.5 - p[0].1);
            let a = (dx * (p[2].1 - p[0].1) - dy * (p[2].0 - p[0].0)) / det;
            let b = (dy * (p[1].0 - p[0].0) - dx * (p[1].1 - p[0].1)) / det;
            // The slack closes the seams between triangles.
            if a >= -1e-9 && b >= -1e-9 && a + b <= 1.0 + 1e-9 {
                raster.set(x, y, shade(v[0] + a * (v[1] - v[0]) + b * (v[2] - v[0])));
            }
        }
    }
}

/// The numbers at both ends of the colour bar; a constant field gets the middle colour.
pub(super) fn colour_range(field: &Field) -> (f64, f64) {
    let shown = field
        .values
        .numbers()
        .iter()
        .copied()
        .filter(|&v| field.scale.shows(v));
    let (low, high) = shown.fold((f64::INFINITY, f64::NEG_INFINITY), |m, v| {
        (m.0.min(v), m.1.max(v))
    });
    if low > high {
        return (1.0, 2.0);
    }
    if high - low > 1e-10 * high.abs().max(low.abs()) {
        return (low, high);
    }
    match field.scale {
        Scale::Linear if low == 0.0 => (-1.0, 1.0),
        Scale::Linear => (low - 0.5 * low.abs(), low + 0.5 * low.abs()),
        Scale::Log => (low / 2.0, low * 2.0),
    }
}

/// Ticks along the lower and the left side.
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

/// The colours with their numbers.
pub(super) fn colour_bar(
    raster: &mut Raster,
    at: Point,
    height: f64,
    range: (f64, f64),
    scale: Scale,
) {
    let steps = 256;
    for k in 0..steps {
        // Each strip reaches under the next one, so that no ground shines through between them.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constant_and_foreign_values_have_a_colour() {
        let values = [3.0, 3.0];
        let field = Field {
            title: "",
            values: Values::Cell(&values),
            scale: Scale::Linear,
        };
        let (low, high) = colour_range(&field);
        assert!(low < 3.0 && high > 3.0);
        let nothing = [f64::NAN, -1.0];
        assert_eq!(
            colour_range(&Field {
                values: Values::Cell(&nothing),
                scale: Scale::Log,
                ..field
            }),
            (1.0, 2.0)
        );
    }
}
