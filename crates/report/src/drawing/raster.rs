//! A canvas of pixels, rasterised by tiny-skia and written as PNG.

use super::canvas::{Canvas, CanvasPoint, Colour, TextStyle};
use crate::drawing::canvas;
use crate::output;
use ab_glyph::{Font, OutlineCurve};
use base::Result;
use tiny_skia::{
    FillRule, LineJoin, Paint, Path, PathBuilder, Pixmap, PremultipliedColorU8, Stroke, StrokeDash,
    Transform,
};

/// An RGB picture. Coordinates are logical pixels, of `scale` × `scale` real pixels each.
pub struct Raster {
    scale: f64,
    pixels: Pixmap,
}

impl Raster {
    /// A white canvas of width × height logical pixels.
    pub fn new(width: f64, height: f64, scale: f64) -> Self {
        let [width, height] = [width, height].map(|x| (x * scale).ceil().max(1.0) as u32);
        let mut pixels = Pixmap::new(width, height).expect("a picture fits into the memory");
        pixels.fill(tiny_skia::Color::WHITE);
        Raster { scale, pixels }
    }

    /// Real pixels per logical pixel.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Size in real pixels: width, height.
    pub fn size(&self) -> (usize, usize) {
        (self.pixels.width() as usize, self.pixels.height() as usize)
    }

    /// Sets one real pixel; pixels outside the picture are ignored.
    pub fn set(&mut self, x: usize, y: usize, Colour(r, g, b): Colour) {
        let (width, height) = self.size();
        if x < width && y < height {
            let opaque = PremultipliedColorU8::from_rgba(r, g, b, u8::MAX);
            self.pixels.pixels_mut()[y * width + x] = opaque.expect("nothing exceeds full opacity");
        }
    }

    /// Writes the picture as PNG.
    ///
    /// # Errors
    /// [`base::ErrorKind::Environment`] with the path.
    pub fn write_png(&self, path: &std::path::Path) -> Result<()> {
        output::write_file(path, |out| {
            let mut encoder = png::Encoder::new(out, self.pixels.width(), self.pixels.height());
            encoder.set_color(png::ColorType::Rgb);
            let opaque = self.pixels.data().chunks_exact(4);
            let rgb: Vec<u8> = opaque.flat_map(|p| [p[0], p[1], p[2]]).collect();
            let mut writer = encoder.write_header().map_err(std::io::Error::other)?;
            writer
                .write_image_data(&rgb)
                .map_err(std::io::Error::other)?;
            writer.finish().map_err(std::io::Error::other)
        })
    }

    /// Fills closed curves.
    fn fill(&mut self, path: PathBuilder, colour: Colour) {
        if let Some(path) = finished(path) {
            let (paint, transform) = (paint(colour), self.transform());
            self.pixels
                .fill_path(&path, &paint, FillRule::Winding, transform, None);
        }
    }

    /// From logical to real pixels.
    fn transform(&self) -> Transform {
        Transform::from_scale(self.scale as f32, self.scale as f32)
    }
}

/// Calls `visit` for every pixel whose centre lies in the triangle p, with its column and row, and with a and b such
/// that the centre is p₀ + a (p₁ − p₀) + b (p₂ − p₀). Used for fields of many small cells, which are coloured pixel by
/// pixel.
pub fn triangle(
    p: [[f64; 2]; 3],
    (width, height): (usize, usize),
    mut visit: impl FnMut(usize, usize, f64, f64),
) {
    let edge = |k: usize, d: usize| p[k][d] - p[0][d];
    let det = edge(1, 0) * edge(2, 1) - edge(2, 0) * edge(1, 1);
    if det == 0.0 || !det.is_finite() {
        return;
    }
    let bound = |d: usize, limit: usize| {
        let low = p[0][d].min(p[1][d]).min(p[2][d]) - 0.5;
        let high = p[0][d].max(p[1][d]).max(p[2][d]) - 0.5;
        let end = (high.floor().max(-1.0) + 1.0).min(limit as f64);
        (low.ceil().max(0.0) as usize, end as usize)
    };
    let ((x0, x1), (y0, y1)) = (bound(0, width), bound(1, height));
    for y in y0..y1 {
        for x in x0..x1 {
            let (dx, dy) = (x as f64 + 0.5 - p[0][0], y as f64 + 0.5 - p[0][1]);
            let a = (dx * edge(2, 1) - dy * edge(2, 0)) / det;
            let b = (dy * edge(1, 0) - dx * edge(1, 1)) / det;
            // The tolerance closes the seams between triangles.
            if a >= -1e-9 && b >= -1e-9 && a + b <= 1.0 + 1e-9 {
                visit(x, y, a, b);
            }
        }
    }
}

fn paint(Colour(r, g, b): Colour) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(r, g, b, u8::MAX);
    paint
}

fn polyline(points: &[CanvasPoint]) -> PathBuilder {
    let mut path = PathBuilder::new();
    for (k, p) in points.iter().enumerate() {
        let (x, y) = (p.0 as f32, p.1 as f32);
        match k {
            0 => path.move_to(x, y),
            _ => path.line_to(x, y),
        }
    }
    path
}

/// The finished path; `None` if it has no extent, or if coordinates are not finite or too large: tiny-skia does not
/// accept such paths.
fn finished(path: PathBuilder) -> Option<Path> {
    let drawable = |x: f32| x.abs() < 1e9;
    let path = path.finish()?;
    let all = path.points().iter().all(|p| drawable(p.x) && drawable(p.y));
    all.then_some(path)
}

impl Canvas for Raster {
    fn polygon(&mut self, points: &[CanvasPoint], fill: Colour) {
        let mut path = polyline(points);
        path.close();
        self.fill(path, fill);
    }

    fn line(&mut self, points: &[CanvasPoint], width: f64, colour: Colour, dash: &[f64]) {
        if let Some(path) = finished(polyline(points)) {
            let stroke = Stroke {
                width: width as f32,
                line_join: LineJoin::Round,
                dash: StrokeDash::new(dash.iter().map(|&d| d as f32).collect(), 0.0),
                ..Stroke::default()
            };
            let transform = self.transform();
            self.pixels
                .stroke_path(&path, &paint(colour), &stroke, transform, None);
        }
    }

    fn text(&mut self, at: CanvasPoint, text: &str, style: &TextStyle) {
        let font = canvas::font(style.bold);
        let runs = canvas::runs(text, style.size);
        let total: f64 = runs.iter().map(|r| canvas::run_width(r, style.bold)).sum();
        let mut start = -style.anchor.share() * total;
        let mut path = PathBuilder::new();
        for run in runs {
            let unit = run.size / canvas::em(style.bold);
            let baseline = 0.5 * canvas::CAP_HEIGHT * style.size - run.raise;
            let (glyphs, width) = canvas::glyphs(&run, style.bold);
            for (id, x) in glyphs {
                let place = |p: ab_glyph::Point| {
                    let (right, down) = (
                        start + x + unit * f64::from(p.x),
                        baseline - unit * f64::from(p.y),
                    );
                    let (x, y) = if style.upwards {
                        (at.0 + down, at.1 - right)
                    } else {
                        (at.0 + right, at.1 + down)
                    };
                    (x as f32, y as f32)
                };
                let outline = font.outline(id);
                add_outline(&mut path, outline.iter().flat_map(|o| &o.curves), place);
            }
            start += width;
        }
        self.fill(path, style.colour);
    }
}

/// Adds the outline of a glyph: closed curves, each listed from its start to its start.
fn add_outline<'a>(
    path: &mut PathBuilder,
    curves: impl Iterator<Item = &'a OutlineCurve>,
    place: impl Fn(ab_glyph::Point) -> (f32, f32),
) {
    let mut last = None;
    for curve in curves {
        let (OutlineCurve::Line(start, end)
        | OutlineCurve::Quad(start, _, end)
        | OutlineCurve::Cubic(start, _, _, end)) = *curve;
        if last != Some(start) {
            let (x, y) = place(start);
            path.move_to(x, y);
        }
        last = Some(end);
        let (x, y) = place(end);
        match *curve {
            OutlineCurve::Line(..) => path.line_to(x, y),
            OutlineCurve::Quad(_, a, _) => {
                let (ax, ay) = place(a);
                path.quad_to(ax, ay, x, y);
            }
            OutlineCurve::Cubic(_, a, b, _) => {
                let ((ax, ay), (bx, by)) = (place(a), place(b));
                path.cubic_to(ax, ay, bx, by, x, y);
            }
        }
    }
}

#[cfg(test)]
#[path = "../../tests/drawing/raster.rs"]
mod tests;
