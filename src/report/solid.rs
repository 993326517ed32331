//! Pictures of fields on solids: the surface from two sides, bodies moved apart in the second picture, so that it shows where they touch.
//!
//! The projection is parallel and from a fixed direction, y upwards, so that pictures of different scenes and meshes compare. Hidden
//! parts are found pixel by pixel.

use super::canvas::{self, Anchor, Canvas, Colour, TextStyle};
use super::colormap::viridis;
use super::field::{Field, Values};
use super::paint::{colour_bar, colour_range, BAR};
use super::raster::Raster;
use super::space::{Buffer, Camera};
use super::surface::{unit_cross, Surface};
use crate::{Error, Result};
use std::path::Path;

pub use super::surface::{FaceMark, Solid};

const TEXT: f64 = 13.0;
const TITLE_TEXT: f64 = 15.0;
const SMALL_TEXT: f64 = 11.5;
/// Largest size of one picture.
const PANEL: (f64, f64) = (470.0, 440.0);
const MARGIN: f64 = 16.0;
const LABELS: f64 = 74.0;
/// Room for the axes below a picture.
const AXES: f64 = 62.0;
/// So far two or three bodies are moved apart, and more, relative to the distances of their centres from the middle.
const APART: [f64; 2] = [0.75, 0.5];

const CLOSED: Colour = Colour(0xe8, 0x10, 0x3c);
/// How much of the white ground shines through faces that may touch and do not.
const PALE: f64 = 0.45;
/// So much more of the marked area another place has to show before it is taken.
const BETTER: f64 = 1.6;

/// Writes two fields as PNG: the first on the bodies as they are, the second on bodies moved apart, or on the other side of a single
/// one, seen from where most of the faces in `marks` are seen.
///
/// # Errors
/// [`Error::Input`] when an array does not fit the mesh; [`Error::Environment`] with the path.
pub fn write_solution(
    solid: &Solid,
    fields: &[Field; 2],
    marks: &[FaceMark],
    title: &str,
    path: &Path,
) -> Result<()> {
    draw(solid, fields, marks, title)?.write_png(path)
}

fn draw(solid: &Solid, fields: &[Field; 2], marks: &[FaceMark], title: &str) -> Result<Raster> {
    solid.check()?;
    for field in fields {
        let (expected, what) = match field.values {
            Values::Nodal(_) => (solid.points.len(), "points"),
            Values::Cell(_) => (solid.hexahedra.len(), "cells"),
        };
        let found = field.values.numbers().len();
        if found != expected {
            return Err(Error::input(format!(
                "the field '{}' has {found} numbers, expected one for each of {expected} {what}",
                field.title
            )));
        }
    }
    let surface = solid.surface(marks);
    let shifts = shifts(solid);
    let several = shifts.len() > 1;
    let none = vec![[0.0; 3]; shifts.len()];
    let second = second_camera(solid, &surface, several);
    let scenes = [
        Scene::new(solid, &surface, Camera::new(false, false), &none),
        Scene::new(solid, &surface, second, &shifts),
    ];
    let notes = [
        String::new(),
        match (several, second.towards[1] < 0.0) {
            (true, false) => "bodies moved apart".into(),
            (true, true) => "bodies moved apart, from below".into(),
            (false, _) if second.towards[2] < 0.0 => "from behind, below".into(),
            (false, true) => "from below".into(),
            (false, false) => String::new(),
        },
    ];
    let panel_height = scenes.iter().map(|s| s.size().1).fold(90.0, f64::max);
    let width = |s: &Scene| MARGIN + s.size().0.max(150.0) + MARGIN + BAR + LABELS;
    let total: f64 = scenes.iter().map(width).sum();
    let total = total.max(canvas::text_width(title, TITLE_TEXT, true) + 24.0);
    let top = if title.is_empty() {
        6.0
    } else {
        2.3 * TITLE_TEXT
    };
    let legend = if marks.is_empty() { 0.0 } else { 26.0 };
    let height = top + 2.4 * TEXT + panel_height + AXES + legend;
    let mut raster = Raster::new(total, height, 2.0);
    let bold = |size: f64| TextStyle {
        bold: true,
        ..TextStyle::new(size, Anchor::Middle)
    };
    if !title.is_empty() {
        raster.text((0.5 * total, 1.25 * TITLE_TEXT), title, &bold(TITLE_TEXT));
    }
    let mut left = 0.0;
    for ((scene, field), note) in scenes.iter().zip(fields).zip(notes) {
        let (w, h) = scene.size();
        let at = (left + MARGIN, top + 2.4 * TEXT + 0.5 * (panel_height - h));
        let heading = match &note[..] {
            "" => field.title.to_string(),
            note => format!("{} ({note})", field.title),
        };
        let middle = at.0 + 0.5 * w.max(150.0);
        raster.text((middle, top + 1.0 * TEXT), &heading, &bold(TEXT));
        let range = colour_range(field);
        scene.paint(&mut raster, field, range, at);
        let bar = panel_height.min(300.0);
        colour_bar(
            &mut raster,
            (
                at.0 + w.max(150.0) + MARGIN,
                top + 2.4 * TEXT + 0.5 * (panel_height + bar),
            ),
            bar,
            range,
            field.scale,
        );
        let below = top + 2.4 * TEXT + panel_height + 0.62 * AXES;
        triad(&mut raster, (left + MARGIN + 26.0, below), &scene.camera);
        left += width(scene);
    }
    extent(&mut raster, solid, (MARGIN + 78.0, height - legend - 14.0));
    if !marks.is_empty() {
        key(&mut raster, marks, (0.5 * total, height - 14.0));
    }
    Ok(raster)
}

/// How far each body is moved away from the middle of all.
fn shifts(solid: &Solid) -> Vec<[f64; 3]> {
    let n = solid.body.iter().max().map_or(0, |&b| b as usize + 1);
    let mut bounds = vec![[[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]]; n];
    for (cell, &body) in solid.hexahedra.iter().zip(solid.body) {
        let [low, high] = &mut bounds[body as usize];
        for p in cell.map(|p| solid.points[p as usize]) {
            for d in 0..3 {
                low[d] = low[d].min(p[d]);
                high[d] = high[d].max(p[d]);
            }
        }
    }
    let [low, high] = Solid::bounds(solid.points);
    let apart = APART[usize::from(n > 3)];
    let shift = |[a, b]: [[f64; 3]; 2]| {
        [0, 1, 2].map(|d| {
            let away = 0.5 * (a[d] + b[d]) - 0.5 * (low[d] + high[d]);
            // A body number without cells.
            if away.is_finite() {
                apart * away
            } else {
                0.0
            }
        })
    };
    bounds.into_iter().map(shift).collect()
}

/// From where most of the marked area is seen; from the first picture's place if that does as well.
fn second_camera(solid: &Solid, surface: &Surface, several: bool) -> Camera {
    let seen = |camera: &Camera| -> f64 {
        let marked = surface.faces.iter().filter(|f| f.mark.is_some());
        marked
            .map(|f| {
                let ([u, v], _) = diagonals(f.corners.map(|p| solid.points[p as usize]));
                let n = [0, 1, 2].map(|d| {
                    let (e, g) = ((d + 1) % 3, (d + 2) % 3);
                    u[e] * v[g] - u[g] * v[e]
                });
                let facing: f64 = (0..3).map(|d| n[d] * camera.towards[d]).sum();
                facing.max(0.0) * if f.mark == Some(true) { 1.0 } else { 0.5 }
            })
            .sum()
    };
    let places = [(false, false), (false, true), (true, false), (true, true)];
    let cameras = places.map(|(behind, below)| Camera::new(behind, below));
    let mut best = cameras[0];
    if !several && surface.faces.iter().all(|f| f.mark.is_none()) {
        return cameras[3];
    }
    for camera in &cameras[1..] {
        if seen(camera) > BETTER * seen(&best) {
            best = *camera;
        }
    }
    best
}

/// The diagonals of a quadrilateral, and its middle.
fn diagonals([a, b, c, d]: [[f64; 3]; 4]) -> ([[f64; 3]; 2], [f64; 3]) {
    let across = [
        [0, 1, 2].map(|i| c[i] - a[i]),
        [0, 1, 2].map(|i| d[i] - b[i]),
    ];
    let middle = [0, 1, 2].map(|i| 0.25 * (a[i] + b[i] + c[i] + d[i]));
    (across, middle)
}

/// A solid seen from one place, its bodies shifted.
struct Scene<'a> {
    solid: &'a Solid<'a>,
    surface: &'a Surface,
    camera: Camera,
    shifts: &'a [[f64; 3]],
    low: [f64; 2],
    high: [f64; 2],
    /// Logical pixels per unit of length.
    scale: f64,
}

impl<'a> Scene<'a> {
    fn new(
        solid: &'a Solid<'a>,
        surface: &'a Surface,
        camera: Camera,
        shifts: &'a [[f64; 3]],
    ) -> Scene<'a> {
        let mut scene = Scene {
            solid,
            surface,
            camera,
            shifts,
            low: [f64::INFINITY; 2],
            high: [f64::NEG_INFINITY; 2],
            scale: 1.0,
        };
        for face in &surface.faces {
            for p in face.corners {
                let at = scene.projected(p, solid.body[face.cell as usize]);
                for d in 0..2 {
                    scene.low[d] = scene.low[d].min(at[d]);
                    scene.high[d] = scene.high[d].max(at[d]);
                }
            }
        }
        if scene.low[0] > scene.high[0] {
            (scene.low, scene.high) = ([0.0; 2], [1.0; 2]);
        }
        let size = [0, 1].map(|d| (scene.high[d] - scene.low[d]).max(1e-300));
        scene.scale = (PANEL.0 / size[0]).min(PANEL.1 / size[1]);
        scene
    }

    fn projected(&self, p: u32, body: u32) -> [f64; 3] {
        let (at, shift) = (self.solid.shown[p as usize], self.shifts[body as usize]);
        self.camera.project([0, 1, 2].map(|d| at[d] + shift[d]))
    }

    /// Logical pixels, with room for the lines around.
    fn size(&self) -> (f64, f64) {
        let [w, h] = [0, 1].map(|d| self.scale * (self.high[d] - self.low[d]) + 6.0);
        (w, h)
    }

    fn paint(&self, raster: &mut Raster, field: &Field, range: (f64, f64), at: (f64, f64)) {
        let (w, h) = self.size();
        let (mut buffer, fine) = Buffer::new(w, h, raster);
        let unit = fine * self.scale;
        let place = |p: u32, body: u32| {
            let [x, y, near] = self.projected(p, body);
            [
                fine * 3.0 + unit * (x - self.low[0]),
                fine * 3.0 + unit * (self.high[1] - y),
                unit * near,
            ]
        };
        let (low, high) = (field.scale.forward(range.0), field.scale.forward(range.1));
        let colour = |v: f64| {
            if field.scale.shows(v) {
                viridis((field.scale.forward(v) - low) / (high - low))
            } else {
                viridis(f64::NAN)
            }
        };
        for face in &self.surface.faces {
            let body = self.solid.body[face.cell as usize];
            let positions = face.corners.map(|p| self.solid.shown[p as usize]);
            let ([u, v], _) = diagonals(positions);
            let normal = unit_cross(u, v);
            let facing: f64 = (0..3).map(|d| normal[d] * self.camera.towards[d]).sum();
            if facing <= 0.0 {
                continue;
            }
            let light = light(normal, &self.camera);
            let values = match field.values {
                Values::Nodal(v) => face.corners.map(|p| v[p as usize]),
                Values::Cell(v) => [v[face.cell as usize]; 4],
            };
            let corners = face.corners.map(|p| place(p, body));
            let (_, centre) = diagonals(corners);
            let mean = values.iter().sum::<f64>() / 4.0;
            let shade = |v: f64| {
                let ink = match face.mark {
                    Some(true) => CLOSED,
                    Some(false) => pale(colour(v)),
                    None => colour(v),
                };
                let dim = |c: u8| (f64::from(c) * light).round() as u8;
                Colour(dim(ink.0), dim(ink.1), dim(ink.2))
            };
            for k in 0..4 {
                let l = (k + 1) % 4;
                let triangle = [corners[k], corners[l], centre];
                buffer.triangle(triangle, [values[k], values[l], mean], &shade);
            }
        }
        // Where bodies or subdomains are only a few pixels wide their lines would hide the field.
        let spacing = |numbers: &[u32]| {
            let n = numbers.iter().max().map_or(1, |&m| m + 1);
            (w * h * (w * h).sqrt() / f64::from(n)).cbrt()
        };
        let subdomains = spacing(self.solid.subdomain);
        let bodies = (0.012 * spacing(self.solid.body)).clamp(0.5, 1.3);
        for edge in &self.surface.edges {
            let ends = edge.ends.map(|p| place(p, edge.body));
            if edge.crease {
                buffer.line(ends, fine * bodies, 2.0 * fine, Colour(0, 0, 0));
            } else if subdomains > 12.0 {
                buffer.line(ends, fine * 0.55, 1.5 * fine, Colour::WHITE);
            }
        }
        buffer.copy(raster, at);
    }
}

/// The colour of a face that may touch and does not.
fn pale(Colour(r, g, b): Colour) -> Colour {
    let mix = |c: u8| (f64::from(c) * (1.0 - PALE) + 255.0 * PALE).round() as u8;
    Colour(mix(r), mix(g), mix(b))
}

/// How light a face is: the light comes from above the viewer's left shoulder and leaves no side dark, because colours have to be read.
fn light(normal: [f64; 3], camera: &Camera) -> f64 {
    let seen = camera.project(normal);
    let from = [-0.35, 0.65, 0.67];
    let facing: f64 = (0..3).map(|d| seen[d] * from[d]).sum();
    0.82 + 0.18 * facing.clamp(0.0, 1.0)
}

/// The directions of the axes.
fn triad(raster: &mut Raster, at: (f64, f64), camera: &Camera) {
    for (axis, name) in ["x", "y", "z"].iter().enumerate() {
        let mut along = [0.0; 3];
        along[axis] = 1.0;
        let [x, y, _] = camera.project(along);
        let end = (at.0 + 24.0 * x, at.1 - 24.0 * y);
        raster.line(&[at, end], 1.2, Colour::INK, &[]);
        let beyond = (at.0 + 33.0 * x, at.1 - 33.0 * y);
        raster.text(beyond, name, &TextStyle::new(SMALL_TEXT, Anchor::Middle));
    }
}

/// The lengths of the undeformed scene.
fn extent(raster: &mut Raster, solid: &Solid, at: (f64, f64)) {
    let [low, high] = Solid::bounds(solid.points);
    let range = |d: usize| {
        let number = super::ticks::number;
        format!(
            "{} {} … {}",
            ["x", "y", "z"][d],
            number(low[d]),
            number(high[d])
        )
    };
    let text = [0, 1, 2].map(range).join("    ");
    raster.text(at, &text, &TextStyle::new(SMALL_TEXT, Anchor::Start));
}

/// What the colours of marked faces mean.
fn key(raster: &mut Raster, marks: &[FaceMark], middle: (f64, f64)) {
    const SAMPLE: f64 = 18.0;
    let open = pale(viridis(0.25));
    let shown: Vec<(Colour, &str)> = [
        (true, CLOSED, "in contact"),
        (false, open, "may touch, open (pale)"),
    ]
    .into_iter()
    .filter(|l| marks.iter().any(|m| m.closed == l.0))
    .map(|l| (l.1, l.2))
    .collect();
    let width = |label: &str| SAMPLE + 8.0 + canvas::text_width(label, TEXT, false);
    let total: f64 = shown.iter().map(|l| width(l.1)).sum();
    let mut x = middle.0 - 0.5 * (total + 26.0 * (shown.len() as f64 - 1.0));
    for (colour, label) in shown {
        let (top, bottom) = (middle.1 - 6.0, middle.1 + 6.0);
        let square = [
            (x, top),
            (x + SAMPLE, top),
            (x + SAMPLE, bottom),
            (x, bottom),
        ];
        raster.polygon(&square, colour);
        let style = TextStyle::new(TEXT, Anchor::Start);
        raster.text((x + SAMPLE + 8.0, middle.1), label, &style);
        x += width(label) + 26.0;
    }
}

#[cfg(test)]
mod tests {
    use super::super::surface::tests::Blocks;
    use super::super::ticks::Scale;
    use super::*;

    fn count(raster: &Raster, is: impl Fn(Colour) -> bool) -> [usize; 2] {
        let (w, h) = raster.size();
        let half = |range: std::ops::Range<usize>| {
            let pixels = range.flat_map(|x| (0..h).map(move |y| (x, y)));
            pixels.filter(|&(x, y)| is(raster.get(x, y))).count()
        };
        [half(0..w / 2), half(w / 2..w)]
    }

    #[test]
    fn a_contact_zone_between_bodies_is_seen_where_they_are_moved_apart() {
        let blocks = Blocks::new(2, 4);
        let u: Vec<f64> = blocks.points.iter().map(|p| p[1]).collect();
        let field = Field {
            title: "u",
            values: Values::Nodal(&u),
            scale: Scale::Linear,
        };
        let marks: Vec<FaceMark> = (0..16)
            .flat_map(|k| {
                let at = |i: usize, j: usize| {
                    [0.25 * (k % 4 + i) as f64, 1.0, 0.25 * (k / 4 + j) as f64]
                };
                let corners = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
                [0, 1].map(|body| FaceMark {
                    body,
                    corners,
                    closed: k < 8,
                })
            })
            .collect();
        let red = |c: Colour| c.0 > 150 && c.1 < 40 && c.2 < 90;
        let plain = draw(&blocks.view(), &[field; 2], &[], "two").unwrap();
        assert_eq!(count(&plain, red), [0, 0]);
        let marked = draw(&blocks.view(), &[field; 2], &marks, "two").unwrap();
        let [left, right] = count(&marked, red);
        // The sample in the legend may lie in the left half.
        assert!(left < 1200 && right > 8000, "{left} {right}");
    }

    #[test]
    fn the_lower_side_is_shown_where_it_touches() {
        let blocks = Blocks::new(1, 2);
        let corners = [[0.0; 3], [0.5, 0.0, 0.0], [0.5, 0.0, 0.5], [0.0, 0.0, 0.5]];
        let mark = FaceMark {
            body: 0,
            corners,
            closed: true,
        };
        let solid = blocks.view();
        let camera = second_camera(&solid, &solid.surface(&[mark]), false);
        assert_eq!(camera, Camera::new(false, true));
        let nothing = second_camera(&solid, &solid.surface(&[]), false);
        assert_eq!(nothing, Camera::new(true, true));
    }

    #[test]
    fn fields_of_the_wrong_length_are_refused() {
        let blocks = Blocks::new(1, 2);
        let field = Field {
            title: "u",
            values: Values::Cell(&[1.0; 5]),
            scale: Scale::Linear,
        };
        let error = draw(&blocks.view(), &[field; 2], &[], "").err().unwrap();
        assert!(error.to_string().contains("'u' has 5 numbers"), "{error}");
    }
}
