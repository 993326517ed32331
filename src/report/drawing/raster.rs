//! A canvas of pixels with exact-area anti-aliasing, written as PNG.

use super::canvas::{self, Anchor, Canvas, Colour, Point, TextStyle};
use crate::report::output;
use crate::Result;
use ab_glyph::{Font, ScaleFont};
use ab_glyph_rasterizer::{point, Rasterizer};
use std::path::Path;

/// Pixels in RGB, drawn on in logical pixels of `scale` × `scale` real ones.
pub struct Raster {
    width: usize,
    height: usize,
    scale: f64,
    pixels: Vec<u8>,
}

impl Raster {
    /// A white canvas of width × height logical pixels.
    pub fn new(width: f64, height: f64, scale: f64) -> Self {
        let (w, h) = (
            (width * scale).ceil() as usize,
            (height * scale).ceil() as usize,
        );
        Raster {
            width: w,
            height: h,
            scale,
            pixels: vec![255; 3 * w * h],
        }
    }

    /// Real pixels per logical pixel.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Size in real pixels: width, height.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// Sets one real pixel; what lies outside is ignored.
    pub fn set(&mut self, x: usize, y: usize, colour: Colour) {
        if x < self.width && y < self.height {
            let at = 3 * (y * self.width + x);
            self.pixels[at..at + 3].copy_from_slice(&[colour.0, colour.1, colour.2]);
        }
    }

    /// One real pixel.
    pub fn get(&self, x: usize, y: usize) -> Colour {
        let at = 3 * (y * self.width + x);
        Colour(self.pixels[at], self.pixels[at + 1], self.pixels[at + 2])
    }

    /// Writes the picture as PNG.
    ///
    /// # Errors
    /// [`crate::Error::Environment`] with the path.
    pub fn write_png(&self, path: &Path) -> Result<()> {
        output::write_file(path, |out| {
            let mut encoder = png::Encoder::new(out, self.width as u32, self.height as u32);
            encoder.set_color(png::ColorType::Rgb);
            encoder.set_depth(png::BitDepth::Eight);
            let mut writer = encoder.write_header().map_err(std::io::Error::other)?;
            writer
                .write_image_data(&self.pixels)
                .map_err(std::io::Error::other)?;
            writer.finish().map_err(std::io::Error::other)
        })
    }

    fn blend(&mut self, x: i64, y: i64, colour: Colour, coverage: f32) {
        if x < 0 || y < 0 || x >= self.width as i64 || y >= self.height as i64 {
            return;
        }
        let at = 3 * (y as usize * self.width + x as usize);
        let c = coverage.clamp(0.0, 1.0);
        for (pixel, ink) in self.pixels[at..at + 3]
            .iter_mut()
            .zip([colour.0, colour.1, colour.2])
        {
            *pixel = (f32::from(*pixel) * (1.0 - c) + f32::from(ink) * c).round() as u8;
        }
    }

    /// Fills the union of convex polygons of equal orientation, given in real pixels.
    fn fill(&mut self, shapes: &[Vec<Point>], colour: Colour) {
        let corners = || shapes.iter().flatten();
        let low = corners().fold((f64::MAX, f64::MAX), |m, p| (m.0.min(p.0), m.1.min(p.1)));
        let high = corners().fold((f64::MIN, f64::MIN), |m, p| (m.0.max(p.0), m.1.max(p.1)));
        if !(low.0 <= high.0
            && low.0.is_finite()
            && high.0.is_finite()
            && low.1.is_finite()
            && high.1.is_finite())
        {
            return;
        }
        // Only the part inside the picture is rasterised; shapes far outside must not cost memory.
        let (x0, y0) = (low.0.floor().max(-8.0), low.1.floor().max(-8.0));
        let (x1, y1) = (
            high.0.ceil().min(self.width as f64 + 8.0),
            high.1.ceil().min(self.height as f64 + 8.0),
        );
        if x1 <= x0 || y1 <= y0 {
            return;
        }
        let (w, h) = ((x1 - x0) as usize + 2, (y1 - y0) as usize + 2);
        let mut rasterizer = Rasterizer::new(w, h);
        let inside = |p: &Point| {
            point(
                (p.0.clamp(x0, x1) - x0) as f32,
                (p.1.clamp(y0, y1) - y0) as f32,
            )
        };
        for shape in shapes {
            for (k, p) in shape.iter().enumerate() {
                rasterizer.draw_line(inside(p), inside(&shape[(k + 1) % shape.len()]));
            }
        }
        rasterizer.for_each_pixel_2d(|x, y, c| {
            if c > 0.002 {
                self.blend(
                    x0 as i64 + i64::from(x),
                    y0 as i64 + i64::from(y),
                    colour,
                    c,
                );
            }
        });
    }

    fn scaled(&self, points: &[Point]) -> Vec<Point> {
        points
            .iter()
            .map(|p| (p.0 * self.scale, p.1 * self.scale))
            .collect()
    }
}

/// Reverses a polygon where needed so that all have the same orientation.
fn oriented(mut polygon: Vec<Point>) -> Vec<Point> {
    let n = polygon.len();
    let area: f64 = (0..n)
        .map(|k| {
            let (a, b) = (polygon[k], polygon[(k + 1) % n]);
            a.0 * b.1 - b.0 * a.1
        })
        .sum();
    if area < 0.0 {
        polygon.reverse();
    }
    polygon
}

/// Drops the points that lie straight between their neighbours: joins there would darken the line's soft rim.
fn straightened(points: Vec<Point>) -> Vec<Point> {
    let mut out: Vec<Point> = Vec::with_capacity(points.len());
    for p in points {
        while out.len() > 1 {
            let (a, b) = (out[out.len() - 2], out[out.len() - 1]);
            let (ahead, step) = ((b.0 - a.0, b.1 - a.1), (p.0 - b.0, p.1 - b.1));
            let cross = (ahead.0 * step.1 - ahead.1 * step.0).abs();
            let dot = ahead.0 * step.0 + ahead.1 * step.1;
            let length = ahead.0.hypot(ahead.1).max(step.0.hypot(step.1));
            if dot < 0.0 || cross > 1e-3 * length {
                break;
            }
            out.pop();
        }
        out.push(p);
    }
    out
}

/// Cuts a polyline into its strokes.
fn dashes(points: &[Point], dash: &[f64]) -> Vec<Vec<Point>> {
    if dash.is_empty() || dash.iter().any(|d| d.is_nan() || *d <= 0.0) {
        return vec![points.to_vec()];
    }
    let mut strokes = Vec::new();
    let (mut which, mut left) = (0, dash[0]);
    let mut current = vec![points[0]];
    for pair in points.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let length = (b.0 - a.0).hypot(b.1 - a.1);
        let mut done = 0.0;
        while done + left < length {
            done += left;
            let p = (
                a.0 + (b.0 - a.0) * done / length,
                a.1 + (b.1 - a.1) * done / length,
            );
            if which % 2 == 0 {
                current.push(p);
                strokes.push(std::mem::take(&mut current));
            } else {
                current = vec![p];
            }
            which += 1;
            left = dash[which % dash.len()];
        }
        left -= length - done;
        if which % 2 == 0 {
            current.push(b);
        }
    }
    if which % 2 == 0 && current.len() > 1 {
        strokes.push(current);
    }
    strokes
}

impl Canvas for Raster {
    fn polygon(&mut self, points: &[Point], fill: Colour) {
        let shape = oriented(self.scaled(points));
        self.fill(&[shape], fill);
    }

    fn line(&mut self, points: &[Point], width: f64, colour: Colour, dash: &[f64]) {
        if points.is_empty() {
            return;
        }
        let half = 0.5 * width * self.scale;
        for stroke in dashes(points, dash) {
            let stroke = straightened(self.scaled(&stroke));
            let mut shapes = Vec::new();
            for (k, pair) in stroke.windows(2).enumerate() {
                let (a, b) = (pair[0], pair[1]);
                let length = (b.0 - a.0).hypot(b.1 - a.1);
                if length == 0.0 {
                    continue;
                }
                let (nx, ny) = (-(b.1 - a.1) / length * half, (b.0 - a.0) / length * half);
                shapes.push(oriented(vec![
                    (a.0 + nx, a.1 + ny),
                    (b.0 + nx, b.1 + ny),
                    (b.0 - nx, b.1 - ny),
                    (a.0 - nx, a.1 - ny),
                ]));
                // Round joins.
                if k > 0 && half > 0.6 {
                    shapes.push(oriented(canvas::circle(a, half)));
                }
            }
            self.fill(&shapes, colour);
        }
    }

    fn text(&mut self, at: Point, text: &str, style: &TextStyle) {
        let size = style.size * self.scale;
        let runs = canvas::runs(text, size);
        let total: f64 = runs.iter().map(|r| canvas::run_width(r, style.bold)).sum();
        let mut x = match style.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -0.5 * total,
            Anchor::End => -total,
        };
        let origin = (at.0 * self.scale, at.1 * self.scale);
        let baseline = 0.5 * canvas::CAP_HEIGHT * size;
        for run in runs {
            let font = canvas::font(style.bold).as_scaled(canvas::px_scale(run.size, style.bold));
            let mut last = None;
            for c in run.text.chars() {
                let id = font.glyph_id(c);
                if let Some(last) = last {
                    x += f64::from(font.kern(last, id));
                }
                let (dx, dy) = (x, baseline - run.raise);
                x += f64::from(font.h_advance(id));
                last = Some(id);
                // Text that reads upwards is drawn at the origin and turned pixel by pixel.
                let place = if style.upwards {
                    (dx, dy)
                } else {
                    (origin.0 + dx, origin.1 + dy)
                };
                let glyph = id.with_scale_and_position(
                    font.scale(),
                    ab_glyph::point(place.0 as f32, place.1 as f32),
                );
                let Some(outline) = font.font.outline_glyph(glyph) else {
                    continue;
                };
                let bounds = outline.px_bounds();
                outline.draw(|px, py, c| {
                    let (gx, gy) = (
                        bounds.min.x as i64 + i64::from(px),
                        bounds.min.y as i64 + i64::from(py),
                    );
                    if style.upwards {
                        self.blend(
                            origin.0.round() as i64 + gy,
                            origin.1.round() as i64 - gx - 1,
                            style.colour,
                            c,
                        );
                    } else {
                        self.blend(gx, gy, style.colour, c);
                    }
                });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: Colour = Colour(255, 0, 0);

    #[test]
    fn polygons_cover_their_area() {
        let mut raster = Raster::new(10.0, 10.0, 2.0);
        assert_eq!(raster.size(), (20, 20));
        // A rectangle that covers logical pixels 2..4.25 × 3..5: whole pixels 4..8, and half of column 8.
        for order in [[0, 1, 2, 3], [3, 2, 1, 0]] {
            let corners = [(2.0, 3.0), (4.25, 3.0), (4.25, 5.0), (2.0, 5.0)];
            raster.polygon(&order.map(|k| corners[k]), Colour(0, 0, 0));
        }
        assert_eq!(raster.get(5, 7), Colour(0, 0, 0));
        assert_eq!(raster.get(3, 7), Colour::WHITE);
        assert_eq!(raster.get(5, 5), Colour::WHITE);
        let half = raster.get(8, 7).0; // drawn twice: a quarter of the white is left
        assert!((i32::from(half) - 64).abs() <= 1, "{half}");
        assert_eq!(raster.get(9, 7), Colour::WHITE);
    }

    #[test]
    fn lines_have_their_width_and_their_dashes() {
        let mut raster = Raster::new(20.0, 9.0, 1.0);
        raster.line(&[(0.0, 4.5), (20.0, 4.5)], 3.0, RED, &[4.0, 2.0]);
        assert_eq!(
            (raster.get(1, 3), raster.get(1, 5), raster.get(1, 6)),
            (RED, RED, Colour::WHITE)
        );
        assert_eq!(
            (raster.get(4, 4), raster.get(5, 4)),
            (Colour::WHITE, Colour::WHITE)
        );
        assert_eq!(raster.get(6, 4), RED);
        // A point on the way changes nothing, not even in the soft rim.
        let mut with = Raster::new(20.0, 9.0, 1.0);
        with.line(&[(1.0, 4.2), (9.3, 4.2), (18.0, 4.2)], 2.5, RED, &[]);
        let mut without = Raster::new(20.0, 9.0, 1.0);
        without.line(&[(1.0, 4.2), (18.0, 4.2)], 2.5, RED, &[]);
        assert_eq!(with.pixels, without.pixels);
        // Far outside: nothing is drawn and nothing fails.
        raster.line(&[(1e9, 1e9), (2e9, 1e9)], 1.0, RED, &[]);
        raster.polygon(&[(f64::NAN, 0.0), (1.0, 1.0), (2.0, 0.0)], RED);
    }

    #[test]
    fn text_sits_where_it_is_anchored() {
        let ink = |raster: &Raster| {
            let (w, h) = raster.size();
            let dark: Vec<(usize, usize)> = (0..w * h)
                .map(|k| (k % w, k / w))
                .filter(|&(x, y)| raster.get(x, y).0 < 128)
                .collect();
            let x = dark.iter().map(|p| p.0);
            let y = dark.iter().map(|p| p.1);
            (
                x.clone().min().unwrap(),
                x.max().unwrap(),
                y.clone().min().unwrap(),
                y.max().unwrap(),
            )
        };
        let mut flat = Raster::new(100.0, 100.0, 1.0);
        flat.text((50.0, 50.0), "HHHH", &TextStyle::new(20.0, Anchor::Middle));
        let (x0, x1, y0, y1) = ink(&flat);
        assert!(
            (x0 + x1).abs_diff(99) <= 2 && (y0 + y1).abs_diff(99) <= 2,
            "{x0} {x1} {y0} {y1}"
        );
        assert!((y1 - y0 + 1).abs_diff(15) <= 1); // capitals are 0.729 em high
        let mut turned = Raster::new(100.0, 100.0, 1.0);
        let style = TextStyle {
            upwards: true,
            ..TextStyle::new(20.0, Anchor::Start)
        };
        turned.text((50.0, 90.0), "HHHH", &style);
        let (tx0, tx1, ty0, ty1) = ink(&turned);
        assert!((tx1 - tx0).abs_diff(y1 - y0) <= 1 && (ty1 - ty0).abs_diff(x1 - x0) <= 1);
        assert!((ty1 as f64 - 88.0).abs() <= 2.0);
    }

    #[test]
    fn png_has_its_size() {
        let dir = crate::report::output::tests::Scratch::new("raster");
        let path = dir.0.join("a.png");
        let mut raster = Raster::new(7.0, 5.0, 2.0);
        raster.set(3, 2, RED);
        raster.write_png(&path).unwrap();
        let mut reader = png::Decoder::new(std::fs::File::open(&path).unwrap())
            .read_info()
            .unwrap();
        let mut pixels = vec![0; reader.output_buffer_size()];
        let info = reader.next_frame(&mut pixels).unwrap();
        assert_eq!((info.width, info.height), (14, 10));
        assert_eq!(&pixels[3 * (2 * 14 + 3)..][..3], &[255, 0, 0]);
    }
}
