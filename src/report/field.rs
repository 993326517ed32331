//! Pictures of fields on meshes of quadrilaterals: u and ρ side by side with colour bars, bodies outlined.
//!
//! Cells are painted pixel by pixel, so that a million of them cost a fraction of a second. Points may be listed once per body
//! or once per subdomain: lines between bodies and subdomains are found from the coordinates.

use super::canvas::{self, Anchor, Canvas, Colour, Point, TextStyle};
use super::colormap::viridis;
use super::raster::Raster;
use super::ticks::{self, Scale};
use crate::{Error, Result};
use std::path::Path;

pub use super::outline::Mesh;

/// Numbers to show.
#[derive(Debug, Clone, Copy)]
pub enum Values<'a> {
    /// One per point, interpolated in the cells.
    Nodal(&'a [f64]),
    /// One per cell.
    Cell(&'a [f64]),
}

impl<'a> Values<'a> {
    fn numbers(self) -> &'a [f64] {
        match self {
            Values::Nodal(v) | Values::Cell(v) => v,
        }
    }
}

/// One picture: what it is called and what it shows.
#[derive(Debug, Clone, Copy)]
pub struct Field<'a> {
    /// Written above it.
    pub title: &'a str,
    /// What it shows.
    pub values: Values<'a>,
    /// Scale of the colours.
    pub scale: Scale,
}

/// Writes u (nodal) and ρ (per cell) side by side as PNG; ρ on a logarithmic scale where it varies by more than 100.
///
/// # Errors
/// [`Error::Input`] when an array does not fit the mesh; [`Error::Environment`] with the path.
pub fn write_solution(mesh: &Mesh, u: &[f64], rho: &[f64], title: &str, path: &Path) -> Result<()> {
    let (low, high) = extremes(rho);
    let scale = if low > 0.0 && high > 100.0 * low {
        Scale::Log
    } else {
        Scale::Linear
    };
    let fields = [
        Field {
            title: "solution u",
            values: Values::Nodal(u),
            scale: Scale::Linear,
        },
        Field {
            title: "coefficient ρ",
            values: Values::Cell(rho),
            scale,
        },
    ];
    write(mesh, &fields, title, path)
}

/// Writes any fields of one mesh as PNG: side by side, or under each other where the mesh is wide.
///
/// # Errors
/// [`Error::Input`] when an array does not fit the mesh; [`Error::Environment`] with the path.
pub fn write(mesh: &Mesh, fields: &[Field], title: &str, path: &Path) -> Result<()> {
    mesh.check()?;
    for field in fields {
        let (expected, what) = match field.values {
            Values::Nodal(_) => (mesh.points.len(), "points"),
            Values::Cell(_) => (mesh.quads.len(), "cells"),
        };
        let found = field.values.numbers().len();
        if found != expected {
            return Err(Error::input(format!(
                "the field '{}' has {found} numbers, expected one for each of {expected} {what}",
                field.title
            )));
        }
    }
    draw(mesh, fields, title).write_png(path)
}

const TEXT: f64 = 13.0;
const TICK_TEXT: f64 = 11.5;
const TITLE_TEXT: f64 = 15.0;
const LEFT: f64 = 52.0;
const BAR_GAP: f64 = 12.0;
const BAR: f64 = 14.0;
const LABELS: f64 = 74.0;

/// Where the mesh lies in the picture.
struct View {
    low: [f64; 2],
    scale: f64,
    origin: Point,
}

impl View {
    /// Logical pixels of a point; y grows upwards in the mesh and downwards in the picture.
    fn place(&self, p: [f64; 2]) -> Point {
        (
            self.origin.0 + self.scale * (p[0] - self.low[0]),
            self.origin.1 - self.scale * (p[1] - self.low[1]),
        )
    }
}

fn draw(mesh: &Mesh, fields: &[Field], title: &str) -> Raster {
    let (low, high) = mesh.bounds();
    let size = [
        (high[0] - low[0]).max(1e-300),
        (high[1] - low[1]).max(1e-300),
    ];
    let aspect = size[0] / size[1];
    let wide = aspect > 1.7;
    let scale = if wide {
        860.0 / size[0]
    } else {
        (400.0 / size[0]).min(520.0 / size[1])
    };
    let (w, h) = (scale * size[0], scale * size[1]);
    // A colour bar needs some height, a title some width, whatever the shape of the mesh.
    let cell = (
        LEFT + w.max(120.0) + BAR_GAP + BAR + LABELS,
        h.max(90.0) + 2.4 * TEXT + 34.0,
    );
    let n = fields.len().max(1) as f64;
    let (columns, rows) = if wide { (1.0, n) } else { (n, 1.0) };
    let top = if title.is_empty() {
        6.0
    } else {
        2.3 * TITLE_TEXT
    };
    let width = (columns * cell.0).max(canvas::text_width(title, TITLE_TEXT, true) + 24.0);
    let mut raster = Raster::new(width, top + rows * cell.1, 2.0);
    if !title.is_empty() {
        let style = TextStyle {
            bold: true,
            ..TextStyle::new(TITLE_TEXT, Anchor::Middle)
        };
        raster.text((0.5 * width, 1.25 * TITLE_TEXT), title, &style);
    }
    let lines = mesh.lines();
    for (k, field) in fields.iter().enumerate() {
        let at = if wide {
            (0.0, top + k as f64 * cell.1)
        } else {
            (k as f64 * cell.0, top)
        };
        let view = View {
            low,
            scale,
            origin: (at.0 + LEFT, at.1 + 2.4 * TEXT + h),
        };
        let style = TextStyle {
            bold: true,
            ..TextStyle::new(TEXT, Anchor::Middle)
        };
        raster.text(
            (view.origin.0 + 0.5 * w.max(60.0), at.1 + 1.2 * TEXT),
            field.title,
            &style,
        );

        let range = colour_range(field);
        paint(&mut raster, mesh, field, range, &view);

        // Where subdomains are only a few pixels wide their lines would hide the field.
        let spacing = |count: usize| (w * h / count.max(1) as f64).sqrt();
        let between_subdomains = spacing(mesh.count(mesh.subdomain));
        if between_subdomains > 7.0 {
            for line in &lines.subdomains {
                let line: Vec<Point> = line.iter().map(|&p| view.place(p)).collect();
                raster.line(
                    &line,
                    (0.02 * between_subdomains).clamp(0.35, 0.7),
                    Colour::WHITE,
                    &[],
                );
            }
        }
        let body_line = (0.02 * spacing(mesh.count(mesh.body))).clamp(0.4, 1.5);
        for line in &lines.bodies {
            let line: Vec<Point> = line.iter().map(|&p| view.place(p)).collect();
            raster.line(&line, body_line, Colour(0, 0, 0), &[]);
        }
        axes(&mut raster, &view, low, high);
        colour_bar(
            &mut raster,
            (view.origin.0 + w + BAR_GAP, view.origin.1),
            h.max(90.0),
            range,
            field.scale,
        );
    }
    raster
}

/// Ticks along the lower and the left side.
fn axes(raster: &mut Raster, view: &View, low: [f64; 2], high: [f64; 2]) {
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

fn colour_bar(raster: &mut Raster, at: Point, height: f64, range: (f64, f64), scale: Scale) {
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

fn extremes(values: &[f64]) -> (f64, f64) {
    let finite = values.iter().filter(|v| v.is_finite());
    finite.fold((f64::INFINITY, f64::NEG_INFINITY), |m, &v| {
        (m.0.min(v), m.1.max(v))
    })
}

/// The numbers at both ends of the colour bar; a constant field gets the middle colour.
fn colour_range(field: &Field) -> (f64, f64) {
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

/// Paints all cells: each as four triangles around its centre, linear on each of them.
fn paint(raster: &mut Raster, mesh: &Mesh, field: &Field, range: (f64, f64), view: &View) {
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

#[cfg(test)]
mod tests {
    use super::super::outline::tests::grid;
    use super::*;

    #[test]
    fn colours_stand_for_values() {
        // u = x on the unit square: the left end is dark violet, the right end yellow, the middle teal.
        let mesh = grid(2, 2, 4, false);
        let u: Vec<f64> = mesh.points.iter().map(|p| p[0]).collect();
        let picture = draw(
            &mesh.view(),
            &[Field {
                title: "u",
                values: Values::Nodal(&u),
                scale: Scale::Linear,
            }],
            "",
        );
        let (_, origin) = (0, (LEFT, 6.0 + 2.4 * TEXT + 400.0));
        let at = |x: f64, y: f64| {
            let p = ((origin.0 + 400.0 * x) * 2.0, (origin.1 - 400.0 * y) * 2.0);
            picture.get(p.0 as usize, p.1 as usize)
        };
        let near = |a: Colour, b: Colour| {
            [(a.0, b.0), (a.1, b.1), (a.2, b.2)]
                .iter()
                .all(|(x, y)| x.abs_diff(*y) <= 3)
        };
        for (x, y) in [(0.06, 0.3), (0.31, 0.8), (0.45, 0.45), (0.9, 0.1)] {
            assert!(
                near(at(x, y), viridis(x)),
                "{:?} at {x}, {y}, expected {:?}",
                at(x, y),
                viridis(x)
            );
        }
        // The line between the bodies.
        assert_eq!(at(0.5, 0.3), Colour(0, 0, 0));
    }

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

    #[test]
    fn arrays_of_the_wrong_length_are_refused() {
        let mesh = grid(1, 1, 2, false);
        let (u, rho) = (
            vec![0.0; mesh.points.len()],
            vec![1.0; mesh.quads.len() + 1],
        );
        let message = write_solution(&mesh.view(), &u, &rho, "", Path::new("/dev/null"))
            .unwrap_err()
            .to_string();
        assert!(
            message.contains("'coefficient ρ' has 5 numbers"),
            "{message}"
        );
    }

    #[test]
    fn a_million_cells_are_quick() {
        let mesh = grid(2, 2, 256, false); // 2×2 bodies of 2×2 subdomains of 256²: 1024² cells
        let u: Vec<f64> = mesh.points.iter().map(|p| p[0] * p[1]).collect();
        let rho = vec![1.0; mesh.quads.len()];
        let dir = super::super::output::tests::Scratch::new("field");
        let start = std::time::Instant::now();
        write_solution(&mesh.view(), &u, &rho, "", &dir.0.join("u.png")).unwrap();
        let seconds = start.elapsed().as_secs_f64();
        println!("{seconds:.2} s");
        assert!(seconds < 10.0, "{seconds} s");
    }
}
